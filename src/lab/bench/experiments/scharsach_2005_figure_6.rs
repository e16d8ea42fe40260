//! Scharsach 2005, Figures 6 and 7: interleaved sampling against the wood grain of coarse steps.
//!
//! Bands show where the distance from a ray's entry to what it meets changes by less than a step from pixel to pixel, and
//! that over many pixels: from near by. So the pictures are close-ups of the surface nearest to the middle of the
//! view.

use serde::{Deserialize, Serialize};

use super::super::papers::{LazyDataset, plain_steps};
use super::super::{Bench, Conditions, Dataset, Experiment, Illustration, Outcome};
use crate::error::Result;
use crate::frame::{DEPTH, Frame, Layer, Wanted};
use crate::lab::measure::{Banding, Times};
use crate::lab::report::{Shown, Table};
use crate::reference;
use crate::render::Renderer;
use crate::scene::{
    Camera, Emission, Jitter, Lens, Phong, Picture, Quadrature, QuadratureMethod, Refine,
    RefineMethod, Sampling, Scene,
};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "b4",
    about: "the bands of coarse steps without jitter, interleaved and hashed: how alike the errors of neighbouring pixels \
            are, what is left of them in the mean of 8 x 8 pixels, and whether the picture's mean stays (Scharsach \
            2005, Figures 6 and 7)",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

const COLUMNS: [(&str, &str, Shown); 11] = [
    ("volume", "volume", Shown::Short),
    ("case", "case", Shown::Short),
    ("way", "jitter", Shown::Short),
    ("min_ms", "ms, min", Shown::Fixed(2)),
    ("median_ms", "median", Shown::Fixed(2)),
    ("ratio", "to none", Shown::Fixed(2)),
    ("mean", "mean error, %", Shown::Percent(3)),
    ("rmse", "rmse, %", Shown::Percent(3)),
    ("coarse_rmse", "rmse of 8 x 8 means, %", Shown::Percent(3)),
    ("coarse_share", "its share", Shown::Fixed(2)),
    ("correlation", "neighbours' correlation", Shown::Fixed(2)),
];

/// No jitter first: with it the others are compared.
const JITTERS: [&str; 6] = [
    "none",
    "interleaved:2",
    "interleaved:4",
    "interleaved:8",
    "interleaved:16",
    "hash:1",
];

/// The jitter that findings and pictures name.
const SHOWN: usize = 2;

/// What is measured of one jitter.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Measured {
    banding: Banding,
    times: Times,
}

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = Outcome {
        conditions: Conditions::usual(bench),
        ..Outcome::of(Table::new(&COLUMNS))
    };
    for volume in LazyDataset::in_one_size(bench, PhantomKind::Vessels) {
        for (case, scene) in cases(bench, volume.get()?)? {
            let key = format!("{}/{case}", volume.name);
            let measured = bench.unit(&key, || measure(bench, volume.get()?, &scene))?;
            tabulate(&mut outcome, &volume.name, &case, &measured);
            bench.so_far(&outcome)?;
        }
        outcome.pictures.extend(pictures(bench, volume.get()?)?);
    }
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

/// How many times as large as in a view of the whole volume a close-up shows what it shows.
const MAGNIFIED: f64 = 8.0;

/// Width and height of the picture in which the surface's point for a close-up is looked for.
const SOUGHT_PX: u32 = 65;

/// The camera of a scene, toward the hit of its surface nearest to the picture's middle, and near it.
fn close_up(bench: &Bench, dataset: &Dataset) -> Result<Camera> {
    let mut scene = dataset.surface(SOUGHT_PX)?;
    scene.sampling = Sampling::default();
    let wanted = Wanted::NONE.with([Layer::Depth]);
    let frame = reference::render(&dataset.volume, &scene, wanted, bench.progress)?;
    let from_middle = |pixel: usize| {
        let side = SOUGHT_PX as usize;
        let off = |at: usize| (2 * at).abs_diff(side - 1);
        off(pixel % side).pow(2) + off(pixel / side).pow(2)
    };
    let depths = frame.plane(DEPTH).unwrap_or_default().iter().enumerate();
    let hits = depths.filter(|(_, depth_mm)| depth_mm.is_finite());
    let nearest = hits.min_by_key(|(pixel, _)| from_middle(*pixel));
    let camera = scene.camera;
    let target = nearest.map_or(camera.target_world(), |(pixel, depth_mm)| {
        let side = SOUGHT_PX as usize;
        let [x, y] = [pixel % side, pixel / side].map(|at| at as f64 + 0.5);
        let ray = camera.ray(scene.size, x, y);
        ray.origin_world + ray.dir_world * f64::from(*depth_mm)
    });
    let lens = match camera.lens() {
        Lens::Perspective { fov_deg } => Lens::Perspective {
            fov_deg: fov_deg / MAGNIFIED,
        },
        Lens::Orthographic { height_mm } => Lens::Orthographic {
            height_mm: height_mm / MAGNIFIED,
        },
    };
    Camera::look_at(camera.eye_world(), target, camera.up_given(), lens)
}

/// Pictures at steps that leave bands: light summed sample by sample as in the paper, and a shaded surface that lies
/// at the sample behind it.
fn cases(bench: &Bench, dataset: &Dataset) -> Result<Vec<(String, Scene)>> {
    let side_px = bench.preset.side_px();
    let mut cases = Vec::new();
    for (method, step) in [
        (QuadratureMethod::Riemann, 1.0),
        (QuadratureMethod::Riemann, 2.0),
        (QuadratureMethod::Midpoint, 2.0),
    ] {
        let mut scene = plain_steps(&dataset.emission(side_px)?, step, Refine::default())?;
        if let Picture::Emission(medium) = &mut scene.picture {
            medium.quadrature = Quadrature::of(method);
        }
        cases.push((format!("dvr, {method}, step {step}"), scene));
    }
    let unrefined = Refine::new(RefineMethod::None, 0)?;
    let mut surface = plain_steps(&dataset.surface(side_px)?, 1.0, unrefined)?;
    if let Picture::Surface { phong, .. } = &mut surface.picture {
        *phong = Some(Phong::default());
    }
    cases.push(("iso, unrefined, step 1".into(), surface));
    let maximum = plain_steps(&dataset.maximum(side_px)?, 2.0, unrefined)?;
    cases.push(("mip, step 2".into(), maximum));
    let camera = close_up(bench, dataset)?;
    let near = |(name, scene)| (name, Scene { camera, ..scene });
    Ok(cases.into_iter().map(near).collect())
}

/// The same scene by each jitter.
fn jittered(scene: &Scene) -> Result<Vec<Scene>> {
    let by = |text: &&str| {
        let mut scene = scene.clone();
        scene.sampling.jitter = text.parse::<Jitter>()?;
        Ok(scene)
    };
    JITTERS.iter().map(by).collect()
}

fn measure(bench: &Bench, dataset: &Dataset, scene: &Scene) -> Result<Vec<Measured>> {
    let octree = bench.octree(dataset)?;
    let mut renderer = bench.renderer(dataset, &octree)?;
    let reference = truth(bench, dataset, scene)?;
    let scenes = jittered(scene)?;
    let bandings: Vec<Banding> = scenes
        .iter()
        .map(|scene| Banding::of(&reference, &shown(&mut renderer, scene)?))
        .collect::<Result<_>>()?;
    let times = bench.times(&mut renderer, &scenes)?;
    let both = bandings.into_iter().zip(times);
    Ok(both
        .map(|(banding, times)| Measured { banding, times })
        .collect())
}

/// The reference's picture, whose rays take no steps.
fn truth(bench: &Bench, dataset: &Dataset, scene: &Scene) -> Result<Frame> {
    let mut scene = scene.clone();
    scene.sampling = Sampling::default();
    if let Picture::Emission(medium) = &mut scene.picture {
        *medium = Emission::of(medium.transfer.clone());
    }
    reference::render(&dataset.volume, &scene, Wanted::DISPLAY, bench.progress)
}

fn shown(renderer: &mut Renderer, scene: &Scene) -> Result<Frame> {
    Ok(renderer.render(scene, Wanted::DISPLAY)?.frame)
}

fn tabulate(outcome: &mut Outcome, volume: &str, case: &str, measured: &[Measured]) {
    for (way, one) in JITTERS.iter().zip(measured) {
        let Measured { banding, times } = one;
        outcome.table.push(vec![
            volume.into(),
            case.into(),
            (*way).into(),
            times.min_ms().into(),
            times.median_ms().into(),
            times.over(&measured[0].times).into(),
            banding.mean.into(),
            banding.rmse.into(),
            banding.coarse_rmse.into(),
            banding.coarse_share().into(),
            banding.correlation.into(),
        ]);
    }
    let [none, interleaved] = [0, SHOWN].map(|at| measured[at].banding);
    let percent = |share: f64| format!("{:.2}", 100.0 * share);
    let correlation = |of: Banding| of.correlation.map_or("none".into(), |c| format!("{c:.2}"));
    outcome.findings.push(format!(
        "{volume}, {case}: with {} the errors of neighbours correlate by {} instead of {}, the means of 8 x 8 \
         pixels are off by {} % of white instead of {} %, pixels by {} % instead of {} %, and the picture's mean by \
         {} % instead of {} %",
        JITTERS[SHOWN],
        correlation(interleaved),
        correlation(none),
        percent(interleaved.coarse_rmse),
        percent(none.coarse_rmse),
        percent(interleaved.rmse),
        percent(none.rmse),
        percent(interleaved.mean),
        percent(none.mean),
    ));
}

/// The coarsest of the media: the reference, without jitter, interleaved.
fn pictures(bench: &Bench, dataset: &Dataset) -> Result<Vec<Illustration>> {
    let octree = bench.octree(dataset)?;
    let mut renderer = bench.renderer(dataset, &octree)?;
    let (case, scene) = cases(bench, dataset)?.swap_remove(1);
    let scenes = jittered(&scene)?;
    let frames = [
        ("the reference", truth(bench, dataset, &scene)?),
        (JITTERS[0], shown(&mut renderer, &scenes[0])?),
        (JITTERS[SHOWN], shown(&mut renderer, &scenes[SHOWN])?),
    ];
    let illustration = |(label, frame): (&str, Frame)| Illustration {
        section: format!("{}, {case}", dataset.name),
        label: label.into(),
        caption: String::new(),
        frame,
    };
    Ok(frames.into_iter().map(illustration).collect())
}
