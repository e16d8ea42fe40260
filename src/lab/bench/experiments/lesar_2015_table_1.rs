//! Lesar et al. 2015, Table I: effects on and off, the camera still and moving.

use super::super::papers::{
    self, Case, LazyDataset, Measurement, SurfaceError, measure, plain_steps,
};
use super::super::{Bench, Conditions, Dataset, Experiment, Outcome, Protocol};
use crate::error::Result;
use crate::lab::report::{Point, Scatter, Section, Shown, Table};
use crate::scene::{Phong, Picture, Refine, Traverse};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b15",
    about: "what each effect costs with the camera still and moving, beside the paper's (Lesar et \
            al. 2015, Table I)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

/// An effect of the paper, and its fps on and off: the camera still, and moving.
const PAPER: [(&str, [[f64; 2]; 2]); 4] = [
    ("depth of field", [[15.70, 16.15], [14.25, 14.63]]),
    ("sparse casting", [[14.48, 16.11], [16.84, 14.23]]),
    ("ambient occlusion", [[15.64, 16.20], [14.33, 15.02]]),
    ("cheaper filter", [[16.75, 16.04], [15.93, 14.74]]),
];

const COLUMNS: [(&str, &str, Shown); 15] = [
    ("volume", "volume", Shown::Short),
    ("protocol", "protocol", Shown::Short),
    ("effect", "effect", Shown::Short),
    ("min_ms", "ms, min", Shown::Fixed(2)),
    ("median_ms", "median", Shown::Fixed(2)),
    ("p95_ms", "p95", Shown::Fixed(2)),
    ("fps", "fps", Shown::Fixed(1)),
    ("paper_fps_on", "paper fps, on", Shown::Fixed(2)),
    ("paper_fps_off", "paper fps, off", Shown::Fixed(2)),
    ("paper_speedup", "paper ×", Shown::Fixed(3)),
    ("missed_share", "missed hits, %", Shown::Percent(3)),
    ("extra_share", "extra hits, %", Shown::Percent(3)),
    ("depth_mean_voxels", "depth mean, voxels", Shown::Short),
    ("depth_p99_voxels", "depth p99", Shown::Short),
    ("repeats", "repeats", Shown::Fixed(0)),
];

fn run(bench: &Bench) -> Result<Outcome> {
    let protocols = match bench.protocol {
        Some(protocol) => vec![protocol],
        None => Protocol::ALL.to_vec(),
    };
    let mut outcome = Outcome::of(Table::new(&COLUMNS));
    outcome.conditions = match bench.protocol {
        Some(_) => Conditions::usual(bench),
        // The rows say how they were timed.
        None => Conditions {
            protocol: None,
            repeats: None,
            ..Conditions::usual(bench)
        },
    };
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        let mut points = Vec::new();
        for &protocol in &protocols {
            let key = format!("{}/{protocol}", volume.name);
            let measured = bench.unit(&key, || {
                let dataset = volume.get()?;
                measure(bench, protocol, dataset, &[base(bench, dataset)?])
            })?;
            tabulate(&mut outcome, &volume.name, protocol, &measured[0]);
            points.extend(point(protocol, &measured[0]));
            bench.so_far(&outcome)?;
        }
        outcome.sections.push(Section {
            title: volume.name.clone(),
            scatters: vec![Scatter {
                title: "Time against missed hits".into(),
                x: papers::axis("time", "ms"),
                y: papers::axis("missed hits", "%"),
                points,
            }],
            ..Section::default()
        });
    }
    let names = PAPER.map(|(name, _)| name).join(", ");
    outcome.findings.push(format!(
        "measured is the picture without effects, of which the paper's 'off' figures are; {names} are \
         not part of this program, so that only the paper's figures stand in their rows"
    ));
    outcome.findings.push(
        "in the paper sparse casting is slower with the camera still (0.90 times as fast) and \
         faster with it moving (1.18 times)"
            .into(),
    );
    outcome.findings.push(
        "errors are against the reference where the camera is first: under 'orbit' the times are of \
         the whole turn, the errors of its first place alone"
            .into(),
    );
    let protocols = protocols.iter();
    let protocols = protocols.map(|protocol| protocol.description(bench.preset));
    outcome.findings.push(format!(
        "times are {}: pictures of {1}x{1} pixels",
        protocols.collect::<Vec<_>>().join(", or "),
        bench.preset.side_px()
    ));
    Ok(outcome)
}

/// The paper's picture without effects: a shaded surface at fixed steps, five iterations of regula
/// falsi, kd-restart.
fn base(bench: &Bench, dataset: &Dataset) -> Result<Case> {
    let surface = dataset.surface(bench.preset.side_px())?;
    let mut scene = plain_steps(&surface, 0.5, "regula-falsi:5".parse::<Refine>()?)?;
    scene.sampling.traverse = Traverse::KdRestart;
    if let Picture::Surface { phong, .. } = &mut scene.picture {
        *phong = Some(Phong::default());
    }
    Ok(Case::new("none", scene))
}

/// The measurement as a point of the page's plot; none if nothing was hit.
fn point(protocol: Protocol, measured: &Measurement) -> Option<Point> {
    Some(Point {
        label: format!("no effects, {protocol}"),
        group: protocol.to_string(),
        x: measured.times.median_ms(),
        y: 100.0 * measured.surface?.missed_share?,
        ..Point::default()
    })
}

fn tabulate(outcome: &mut Outcome, volume: &str, protocol: Protocol, measured: &Measurement) {
    let times = &measured.times;
    let surface = measured.surface;
    let error = |of: fn(&SurfaceError) -> Option<f64>| surface.as_ref().and_then(of).into();
    let nothing = || None::<f64>.into();
    outcome.table.push(vec![
        volume.into(),
        protocol.name().into(),
        "none".into(),
        times.min_ms().into(),
        times.median_ms().into(),
        times.p95_ms().into(),
        (1e3 / times.median_ms()).into(),
        nothing(),
        nothing(),
        nothing(),
        error(|surface| surface.missed_share),
        error(|surface| surface.extra_share),
        error(|surface| surface.depth_mean),
        error(|surface| surface.depth_p99),
        (times.repeats() as u64).into(),
    ]);
    for (effect, fps) in PAPER {
        let [on, off] = match protocol {
            Protocol::Static => fps[0],
            Protocol::Orbit => fps[1],
        };
        outcome.table.push(vec![
            volume.into(),
            protocol.name().into(),
            effect.into(),
            nothing(),
            nothing(),
            nothing(),
            nothing(),
            on.into(),
            off.into(),
            (on / off).into(),
        ]);
    }
}
