//! Lesar et al. 2015, Table I: effects on and off, the camera still and moving.

use super::super::papers::{
    self, Case, LazyDataset, Measurement, SurfaceError, measure, percent_missed, plain_steps,
    sparsely,
};
use super::super::{Bench, Conditions, Dataset, Experiment, Outcome, Protocol};
use crate::error::Result;
use crate::lab::measure::Times;
use crate::lab::report::{Cell, Point, Scatter, Section, Shown, Table};
use crate::scene::{DofMethod, Occlusion, Phong, Picture, Reconstruction, Refine, Scene, Traverse};
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
struct Effect {
    name: &'static str,
    fps: [[f64; 2]; 2],
    /// The paper's picture of a dataset with it.
    on: fn(Scene, &Dataset) -> Result<Scene>,
}

/// The paper's effects, in its order.
const EFFECTS: [Effect; 4] = [
    Effect {
        name: "depth of field",
        fps: [[15.70, 16.15], [14.25, 14.63]],
        on: out_of_focus,
    },
    Effect {
        name: "sparse casting",
        fps: [[14.48, 16.11], [16.84, 14.23]],
        on: |scene, _| sparsely(scene),
    },
    Effect {
        name: "ambient occlusion",
        fps: [[15.64, 16.20], [14.33, 15.02]],
        on: occluded,
    },
    Effect {
        name: "cheaper filter",
        fps: [[16.75, 16.04], [15.93, 14.74]],
        on: |scene, _| nearest_until_hits(scene),
    },
];

/// The widest circles of confusion, pixels.
const WIDEST_PX: f64 = 12.0;

/// Blurred in two phases and mixed, as the paper's, in focus at the median depth.
fn out_of_focus(mut scene: Scene, dataset: &Dataset) -> Result<Scene> {
    scene.depth_of_field = Some(dataset.lens(&scene, WIDEST_PX)?);
    scene.sampling.dof = DofMethod::Mix;
    Ok(scene)
}

/// The share of the volume's radius within which a surface occludes itself.
const OCCLUDED_WITHIN: f64 = 0.05;

/// With ambient occlusion from the picture.
fn occluded(mut scene: Scene, dataset: &Dataset) -> Result<Scene> {
    let (_, radius_mm) = dataset.volume.bounding_sphere();
    let text = format!("radius={}", OCCLUDED_WITHIN * radius_mm);
    scene.ambient_occlusion = Some(Occlusion::Screen(text.parse()?));
    Ok(scene)
}

fn nearest_until_hits(mut scene: Scene) -> Result<Scene> {
    scene.sampling.recon = Reconstruction::Adaptive;
    Ok(scene)
}

const COLUMNS: [(&str, &str, Shown); 16] = [
    ("volume", "volume", Shown::Short),
    ("protocol", "protocol", Shown::Short),
    ("effect", "effect", Shown::Short),
    ("min_ms", "ms, min", Shown::Fixed(2)),
    ("median_ms", "median", Shown::Fixed(2)),
    ("p95_ms", "p95", Shown::Fixed(2)),
    ("fps", "fps", Shown::Fixed(1)),
    ("speedup", "ours ×", Shown::Fixed(3)),
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
                measure(bench, protocol, dataset, &cases(bench, dataset)?)
            })?;
            tabulate(&mut outcome.table, &volume.name, protocol, &measured);
            points.extend(measured.iter().filter_map(|one| point(protocol, one)));
            outcome
                .findings
                .extend(findings(&volume.name, protocol, &measured));
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
    outcome.findings.extend(PAPER_FINDINGS.map(str::to_owned));
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

/// What is to be known of the paper's figures beside ours.
const PAPER_FINDINGS: [&str; 3] = [
    "each effect is measured beside the picture without any, in turn with it; the cheaper filter's hits are the \
     linear filter's, its march compares the nearest voxels with the iso value",
    "depth of field is mixed with a blurred picture, as the paper's, and up to 12 pixels wide; ambient occlusion is that \
     from the picture with 32 pixels around each, within a twentieth of the volume's radius, and with exact thickness",
    "in the paper sparse casting is slower with the camera still (0.90 times as fast) and faster with it moving \
     (1.18 times), the cheaper filter faster in both (1.04 and 1.08 times)",
];

/// The paper's picture without effects (a shaded surface at fixed steps, five iterations of regula falsi,
/// kd-restart), and with each of them.
fn cases(bench: &Bench, dataset: &Dataset) -> Result<Vec<Case>> {
    let surface = dataset.surface(bench.preset.side_px())?;
    let mut scene = plain_steps(&surface, 0.5, "regula-falsi:5".parse::<Refine>()?)?;
    scene.sampling.traverse = Traverse::KdRestart;
    if let Picture::Surface { phong, .. } = &mut scene.picture {
        *phong = Some(Phong::default());
    }
    let mut cases = vec![Case::new("none", scene.clone())];
    for effect in &EFFECTS {
        cases.push(Case::new(effect.name, (effect.on)(scene.clone(), dataset)?));
    }
    Ok(cases)
}

/// The measurement as a point of the page's plot; none if nothing was hit.
fn point(protocol: Protocol, measured: &Measurement) -> Option<Point> {
    Some(Point {
        label: format!("{}, {protocol}", measured.name),
        group: protocol.to_string(),
        x: measured.times.median_ms(),
        y: 100.0 * measured.surface?.missed_share?,
        ..Point::default()
    })
}

/// A sentence on each effect that is measured.
fn findings(volume: &str, protocol: Protocol, measured: &[Measurement]) -> Vec<String> {
    let effects = measured.iter().skip(1);
    let sentence = |one: &Measurement| {
        format!(
            "{volume}, {protocol}: {} is {:.2} times as fast as without; {} of the hits are missed, without it {}",
            one.name,
            measured[0].times.over(&one.times),
            percent_missed(one),
            percent_missed(&measured[0])
        )
    };
    effects.map(sentence).collect()
}

/// Appends the row without effects, and one for each effect: the paper's figures, and ours where there are some.
fn tabulate(table: &mut Table, volume: &str, protocol: Protocol, measured: &[Measurement]) {
    let none = &measured[0];
    table.push(row(volume, protocol, ("none", None), (none, Some(none))));
    for effect in &EFFECTS {
        let fps = match protocol {
            Protocol::Static => effect.fps[0],
            Protocol::Orbit => effect.fps[1],
        };
        let own = measured.iter().find(|one| one.name == effect.name);
        table.push(row(volume, protocol, (effect.name, Some(fps)), (none, own)));
    }
}

fn row(
    volume: &str,
    protocol: Protocol,
    (effect, paper_fps): (&str, Option<[f64; 2]>),
    (none, measured): (&Measurement, Option<&Measurement>),
) -> Vec<Cell> {
    let times = measured.map(|one| &one.times);
    let surface = measured.and_then(|one| one.surface);
    let error = |of: fn(&SurfaceError) -> Option<f64>| surface.as_ref().and_then(of).into();
    vec![
        volume.into(),
        protocol.name().into(),
        effect.into(),
        times.map(Times::min_ms).into(),
        times.map(Times::median_ms).into(),
        times.map(Times::p95_ms).into(),
        times.map(|times| 1e3 / times.median_ms()).into(),
        times.map(|times| none.times.over(times)).into(),
        paper_fps.map(|[on, _]| on).into(),
        paper_fps.map(|[_, off]| off).into(),
        paper_fps.map(|[on, off]| on / off).into(),
        error(|surface| surface.missed_share),
        error(|surface| surface.extra_share),
        error(|surface| surface.depth_mean),
        error(|surface| surface.depth_p99),
        times.map(|times| times.repeats() as u64).into(),
    ]
}
