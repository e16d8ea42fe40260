//! Yuan 2009, table of §5: frames by the number of clip planes and by the picture's size.

use glam::DVec3;

use super::super::papers::{self, Case, Errors, LazyDataset, Measurement, run_group};
use super::super::{Bench, Dataset, Experiment, Outcome};
use crate::error::Result;
use crate::scene::{ClipPlane, Scene};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b13",
    about: "frames by the number of clip planes, none of which cuts anything off, and by the size \
            of the picture (Yuan 2009, table in section 5)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

/// The numbers of clip planes, beside the six faces of the volume, which are planes in the paper.
const PLANES: [usize; 9] = [0, 1, 2, 4, 6, 8, 16, 32, 64];
/// The paper's frames per second with 6 planes and with 12.
const PAPER: [(usize, f64); 2] = [(0, 59.4), (6, 57.9)];

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = papers::outcome(bench, "series", Errors::Light);
    // Every row of the series of sizes says its own.
    outcome.conditions.side_px = None;
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        let planes = run_group(bench, &mut outcome, &volume, "planes", |dataset| {
            by_planes(bench, dataset)
        })?;
        let sizes = run_group(bench, &mut outcome, &volume, "viewport", |dataset| {
            by_size(bench, dataset)
        })?;
        outcome
            .findings
            .extend(findings(&volume.name, &planes, &sizes));
    }
    outcome.findings.push(
        "the paper's other figures, 58.6 fps with planes between 6 and 12, 39.7 and 22.3 fps in \
         larger viewports, are of settings that have no counterpart here"
            .into(),
    );
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

fn by_planes(bench: &Bench, dataset: &Dataset) -> Result<Vec<Case>> {
    let scene = dataset.emission(bench.preset.side_px())?;
    let cases = PLANES.iter().map(|&count| {
        let of_paper = PAPER.iter().find(|(planes, _)| *planes == count);
        let scene = Scene {
            clip_planes: around(dataset, count)?,
            ..scene.clone()
        };
        let case = Case::new(format!("planes: {count}"), scene);
        Ok(Case {
            same_as: (count > 0).then_some(0),
            ..case.paper_fps(of_paper.map(|(_, fps)| *fps))
        })
    });
    cases.collect()
}

/// Planes about the volume's bounding sphere, evenly spread, that keep all of it: every ray is cut
/// by all of them, and none sees less.
fn around(dataset: &Dataset, count: usize) -> Result<Vec<ClipPlane>> {
    let (center_world, radius_mm) = dataset.volume.bounding_sphere();
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let planes = (0..count).map(|place| {
        // A spiral of equal areas (Vogel 1979, on the sphere).
        let height = 1.0 - 2.0 * (place as f64 + 0.5) / count as f64;
        let (sin, cos) = (golden * place as f64).sin_cos();
        let flat = (1.0 - height * height).sqrt();
        let outward = DVec3::new(flat * cos, flat * sin, height);
        ClipPlane::new(-outward, outward.dot(center_world) + 1.01 * radius_mm)
    });
    planes.collect()
}

fn by_size(bench: &Bench, dataset: &Dataset) -> Result<Vec<Case>> {
    let side_px = bench.preset.side_px();
    let cases = [side_px / 2, side_px, side_px * 2].map(|side_px| {
        let scene = dataset.emission(side_px)?;
        Ok(Case::new(format!("{side_px}x{side_px}"), scene))
    });
    cases.into_iter().collect()
}

fn findings(volume: &str, planes: &[Measurement], sizes: &[Measurement]) -> Vec<String> {
    let slower = |count: usize| {
        let place = PLANES.iter().position(|planes| *planes == count);
        place.map_or(f64::NAN, |at| planes[at].times.over(&planes[0].times))
    };
    let four = |place: usize| sizes[place].times.over(&sizes[place - 1].times);
    vec![
        format!(
            "{volume}: six more planes take {:.3} times as long (paper {:.3}), 64 more {:.3} times; \
             the picture is the same",
            slower(6),
            PAPER[0].1 / PAPER[1].1,
            slower(64)
        ),
        format!(
            "{volume}: four times the pixels take {:.2} and {:.2} times as long",
            four(1),
            four(2)
        ),
    ]
}
