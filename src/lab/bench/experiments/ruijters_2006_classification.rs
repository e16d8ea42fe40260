//! Ruijters and Vilanova 2006, §8: what a change of the transfer function costs before the next
//! frame.

use serde::{Deserialize, Serialize};

use super::super::papers::LazyDataset;
use super::super::{Bench, Dataset, Experiment, Outcome};
use crate::error::Result;
use crate::frame::Wanted;
use crate::lab::measure::Times;
use crate::lab::report::{Cell, Shown, Table};
use crate::scene::{Picture, Scene, Traverse};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b10",
    about: "what a new iso value or transfer function costs: classifying the octree, and the bytes \
            that go to the device (Ruijters and Vilanova 2006, section 8)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: false,
    takes_peer: false,
    run,
};

/// The paper's octree of 512³ voxels, on its two devices, ms.
const PAPER_MS: [f64; 2] = [6.5, 3.5];
const PAPER_VOXELS: f64 = 512.0 * 512.0 * 512.0;

/// The side of the pictures, px; small, because what is timed happens before the first ray.
const SIDE_PX: u32 = 32;

/// Shares of the value range at which the surface or the medium begins, one after the other.
const CHANGES: [f64; 5] = [0.5, 0.4, 0.6, 0.3, 0.7];

const COLUMNS: [(&str, &str, Shown); 10] = [
    ("volume", "volume", Shown::Short),
    ("change", "what changes", Shown::Short),
    ("traverse", "traversal", Shown::Short),
    ("classify_min_ms", "classified in ms, min", Shown::Short),
    ("classify_median_ms", "median", Shown::Short),
    (
        "classify_ns_per_kvoxel",
        "ns a 1000 voxels",
        Shown::Fixed(1),
    ),
    ("paper_ns_per_kvoxel", "paper", Shown::Fixed(1)),
    ("first_bytes", "bytes with the first frame", Shown::Fixed(0)),
    ("uploaded_bytes", "with a change", Shown::Fixed(0)),
    ("volume_bytes", "bytes of the volume", Shown::Fixed(0)),
];

/// One kind of change.
#[derive(Serialize, Deserialize)]
struct Changed {
    what: String,
    traverse: String,
    times: Times,
    /// The bytes uploaded with the volume's first frame, the volume included.
    first_bytes: u64,
    /// The most of any change.
    uploaded_bytes: u64,
    volume_bytes: u64,
    voxels: f64,
}

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = Outcome::of(Table::new(&COLUMNS));
    outcome.conditions.side_px = Some(SIDE_PX);
    outcome.conditions.repeats = Some(repeats(bench));
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        let changes = bench.unit(&volume.name, || measure(bench, volume.get()?))?;
        for changed in &changes {
            let per_kvoxel = 1e9 / changed.voxels;
            outcome.table.push(vec![
                volume.name.as_str().into(),
                changed.what.as_str().into(),
                changed.traverse.as_str().into(),
                changed.times.min_ms().into(),
                changed.times.median_ms().into(),
                (changed.times.median_ms() * per_kvoxel).into(),
                (PAPER_MS[0] * 1e9 / PAPER_VOXELS).into(),
                changed.first_bytes.into(),
                changed.uploaded_bytes.into(),
                Cell::from(changed.volume_bytes),
            ]);
            if changed.uploaded_bytes >= changed.volume_bytes {
                outcome.failure = Some(format!(
                    "{}: a change of the {} uploads {} bytes, as much as the volume's {}",
                    volume.name, changed.what, changed.uploaded_bytes, changed.volume_bytes
                ));
            }
        }
        bench.so_far(&outcome)?;
        let share = |changed: &Changed| changed.uploaded_bytes as f64 / changed.volume_bytes as f64;
        let max_share = changes.iter().map(share).fold(0.0, f64::max);
        outcome.findings.push(format!(
            "{}: no voxel is uploaded again; what is, is {:.2} % of the volume's bytes at most",
            volume.name,
            100.0 * max_share
        ));
    }
    outcome.findings.push(format!(
        "the paper needs {} and {} ms for 512x512x512 voxels on its two devices; its figure here is \
         the slower one a voxel",
        PAPER_MS[0], PAPER_MS[1]
    ));
    outcome.findings.push(
        "the distance map is made anew with the classes and is part of its time; the other \
         traversals need the classes alone"
            .into(),
    );
    Ok(outcome)
}

/// How often a change is made: each of [`CHANGES`] so many times as the effort says.
fn repeats(bench: &Bench) -> usize {
    CHANGES.len() * bench.preset.repeats()
}

fn measure(bench: &Bench, dataset: &Dataset) -> Result<Vec<Changed>> {
    let octree = bench.octree(dataset)?;
    let mut renderer = bench.renderer(dataset, &octree)?;
    // The volume goes to the device with the first frame.
    let mut first_bytes = None;
    let mut all = Vec::new();
    for what in ["iso value", "transfer function"] {
        for traverse in [Traverse::Hierarchical, Traverse::Distance] {
            let scenes: Vec<Scene> = CHANGES
                .iter()
                .map(|&share| changed(dataset, SIDE_PX, what, share, traverse))
                .collect::<Result<_>>()?;
            let first = renderer.render(&scenes[0], Wanted::NONE)?;
            let first_bytes = *first_bytes.get_or_insert(first.uploaded_bytes);
            let mut uploaded_bytes = 0;
            let rounds = bench.times_of(&[()], repeats(bench), |(), round| {
                let scene = &scenes[round % scenes.len()];
                renderer.forget_classes();
                let rendering = renderer.render(scene, Wanted::NONE)?;
                uploaded_bytes = rendering.uploaded_bytes.max(uploaded_bytes);
                Ok(rendering.classify_ms)
            })?;
            for times in rounds {
                all.push(Changed {
                    what: what.into(),
                    traverse: traverse.to_string(),
                    times,
                    first_bytes,
                    uploaded_bytes,
                    volume_bytes: dataset.volume.voxels().bytes().len() as u64,
                    voxels: dataset.volume.voxels().len() as f64,
                });
            }
        }
    }
    Ok(all)
}

fn changed(
    dataset: &Dataset,
    side_px: u32,
    what: &str,
    share: f64,
    traverse: Traverse,
) -> Result<Scene> {
    let range = dataset.volume.range();
    let mut scene = if what == "iso value" {
        let mut scene = dataset.surface(side_px)?;
        if let Picture::Surface { iso, .. } = &mut scene.picture {
            *iso = range.at(share);
        }
        scene
    } else {
        dataset.medium(side_px, &[(range.at(share), 0.0), (range.max, 0.5)])?
    };
    scene.sampling.traverse = traverse;
    Ok(scene)
}
