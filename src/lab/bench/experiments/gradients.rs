//! The methods of computing gradients: the errors of their normals, what they cost.

use glam::DVec3;

use super::super::{Bench, Conditions, Dataset, Experiment, Outcome, Protocol};
use crate::error::Result;
use crate::frame::error::normal_error;
use crate::frame::{DEPTH, Frame, Layer, NORMAL, Wanted};
use crate::lab::report::{Cell, Shown, Table};
use crate::number_text::concise;
use crate::reference;
use crate::render::Rendering;
use crate::scene::{Gradient, Precomputed, Scene};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "gradients",
    about: "angle errors, memory and times of the methods of computing gradients: on the sphere phantom \
            against its radii, on the volumes named against central differences in double precision",
    takes_volumes: true,
    counts_rays: false,
    times_frames: false,
    takes_peer: false,
    run,
};

const COLUMNS: [(&str, &str, Shown); 10] = [
    ("volume", "volume", Shown::Short),
    ("gradient", "gradient", Shown::Short),
    ("against", "against", Shown::Short),
    ("angle_mean_deg", "angle mean, degrees", Shown::Short),
    ("angle_p99_deg", "p99", Shown::Short),
    ("bytes", "bytes", Shown::Fixed(0)),
    ("made_ms", "made in ms", Shown::Fixed(1)),
    ("normals_min_ms", "normals ms, min", Shown::Fixed(3)),
    ("normals_median_ms", "median", Shown::Fixed(3)),
    ("ratio", "to central", Shown::Fixed(2)),
];

/// Names and gradients, first the one that others are compared with.
fn methods() -> Result<[(&'static str, Gradient); 7]> {
    let precomputed =
        |scale, sigma_voxels| Precomputed::new(scale, sigma_voxels).map(Gradient::Precomputed);
    Ok([
        ("central", Gradient::Central),
        ("forward", Gradient::Forward),
        ("fourth-order", Gradient::FourthOrder),
        ("precomputed", precomputed(1, 0.0)?),
        ("precomputed, scale 2", precomputed(2, 0.0)?),
        ("precomputed, scale 2, smooth 1", precomputed(2, 1.0)?),
        ("precomputed, scale 4", precomputed(4, 0.0)?),
    ])
}

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = Outcome::of(Table::new(&COLUMNS));
    outcome.conditions = Conditions::usual(bench);
    let sphere = Dataset::phantom(PhantomKind::Sphere)?;
    let named = bench.datasets.iter().map(|dataset| (dataset, None));
    let sphere = (&sphere, Some(radial as fn(DVec3) -> DVec3));
    for (dataset, normal) in std::iter::once(sphere).chain(named) {
        let (rows, finding) = bench.unit(&dataset.name, || measure(bench, dataset, normal))?;
        rows.into_iter().for_each(|row| outcome.table.push(row));
        outcome.findings.push(finding);
        bench.so_far(&outcome)?;
    }
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

/// The normal of a sphere about the world's origin.
fn radial(p_world: DVec3) -> DVec3 {
    p_world.normalize_or_zero()
}

/// A volume's rows and what they are of; `normal` is the closed form, where there is one.
fn measure(
    bench: &Bench,
    dataset: &Dataset,
    normal: Option<fn(DVec3) -> DVec3>,
) -> Result<(Vec<Vec<Cell>>, String)> {
    let wanted = Wanted::NONE.with([Layer::Depth, Layer::Normal]);
    let surface = dataset.surface(bench.preset.side_px())?;
    let mut reference = reference::render(&dataset.volume, &surface, wanted, bench.progress)?;
    if let Some(normal) = normal {
        put_normals(&mut reference, &surface, normal);
    }
    let octree = bench.octree(dataset)?;
    let mut renderer = bench.renderer(dataset, &octree)?;
    let methods = methods()?;
    let scenes = methods.map(|(_, gradient)| Scene {
        gradient,
        ..surface.clone()
    });
    let renderings: Vec<Rendering> = scenes
        .iter()
        .map(|scene| renderer.render(scene, wanted))
        .collect::<Result<_>>()?;
    let times = bench.times_under(Protocol::Static, &scenes, |scene, _| {
        let rendering = renderer.render(scene, wanted)?;
        let passes = rendering.passes.iter();
        let normals = passes.filter(|pass| pass.name == "surface_normal");
        Ok(normals.map(|pass| pass.ms).sum())
    })?;
    let against = match normal {
        Some(_) => "radii",
        None => "central, f64",
    };
    let mut rows = Vec::new();
    for (((name, _), rendering), times_of) in methods.iter().zip(&renderings).zip(&times) {
        let error = normal_error(&reference, &rendering.frame)?;
        rows.push(vec![
            dataset.name.as_str().into(),
            (*name).into(),
            against.into(),
            error.mean_deg.into(),
            error.p99_deg.into(),
            rendering.gradients.map_or(0, |g| g.bytes).into(),
            rendering.gradients.map_or(0.0, |g| g.ms).into(),
            times_of.min_ms().into(),
            times_of.median_ms().into(),
            times_of.over(&times[0]).into(),
        ]);
    }
    let finding = format!(
        "{}: at {}, {} normals compared",
        dataset.name,
        concise(dataset.iso),
        normal_error(&reference, &renderings[0].frame)?.compared
    );
    Ok((rows, finding))
}

/// Replaces the normals of a frame by those of a closed form where its rays hit.
fn put_normals(frame: &mut Frame, scene: &Scene, normal: fn(DVec3) -> DVec3) {
    let Some(mut normals) = frame.layers.take(NORMAL) else {
        return;
    };
    let depths = frame.plane(DEPTH).unwrap_or_default();
    let width = scene.size.width() as usize;
    for (pixel, (depth_mm, place)) in depths.iter().zip(&mut normals).enumerate() {
        if depth_mm.is_finite() {
            let [x, y] = [pixel % width, pixel / width].map(|at| at as f64 + 0.5);
            let ray = scene.camera.ray(scene.size, x, y);
            let p_world = ray.origin_world + ray.dir_world * f64::from(*depth_mm);
            *place = normal(p_world).to_array().map(|c| c as f32);
        }
    }
    frame.layers.insert(NORMAL, normals);
}
