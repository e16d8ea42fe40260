//! The ways of finding gradients: how far off their normals are, what they cost.

use glam::DVec3;

use super::super::{Bench, Conduct, Experiment, Outcome, Protocol, Specimen};
use crate::error::Result;
use crate::frame::error::normal_error;
use crate::frame::{Frame, Wanted};
use crate::number_text::concise;
use crate::reference;
use crate::render::Rendering;
use crate::report::{Cell, Shown, Table};
use crate::scene::{Gradient, Precomputed, Scene};
use crate::volume::PhantomKind;

pub const EXPERIMENT: Experiment = Experiment {
    name: "gradients",
    about: "angle errors, memory and times of the ways of finding gradients: on the sphere phantom \
            against its radii, on the volumes named against central differences in double precision",
    takes_volumes: true,
    counts_rays: false,
    times_frames: false,
    races: false,
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
    ("normals_min_ms", "normals ms, least", Shown::Fixed(3)),
    ("normals_median_ms", "median", Shown::Fixed(3)),
    ("ratio", "to central", Shown::Fixed(2)),
];

/// Names and ways, the one that others are held against first.
fn ways() -> Result<[(&'static str, Gradient); 7]> {
    let kept =
        |scale, sigma_voxels| Precomputed::new(scale, sigma_voxels).map(Gradient::Precomputed);
    Ok([
        ("central", Gradient::Central),
        ("forward", Gradient::Forward),
        ("fourth-order", Gradient::FourthOrder),
        ("precomputed", kept(1, 0.0)?),
        ("precomputed, scale 2", kept(2, 0.0)?),
        ("precomputed, scale 2, smooth 1", kept(2, 1.0)?),
        ("precomputed, scale 4", kept(4, 0.0)?),
    ])
}

fn run(bench: &Bench) -> Result<Outcome> {
    let mut outcome = Outcome::of(Table::new(&COLUMNS));
    outcome.conduct = Conduct::usual(bench);
    let sphere = Specimen::phantom(PhantomKind::Sphere)?;
    let named = bench.specimens.iter().map(|specimen| (specimen, None));
    let sphere = (&sphere, Some(radial as fn(DVec3) -> DVec3));
    for (specimen, normal) in std::iter::once(sphere).chain(named) {
        let (rows, finding) = bench.unit(&specimen.name, || measure(bench, specimen, normal))?;
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
    specimen: &Specimen,
    normal: Option<fn(DVec3) -> DVec3>,
) -> Result<(Vec<Vec<Cell>>, String)> {
    let wanted = Wanted {
        depth: true,
        normal: true,
        ..Wanted::default()
    };
    let surface = specimen.surface(bench.effort.side_px())?;
    let mut truth = reference::render(&specimen.volume, &surface, wanted, bench.progress)?;
    if let Some(normal) = normal {
        put_normals(&mut truth, &surface, normal);
    }
    let octree = bench.octree(specimen)?;
    let mut renderer = bench.renderer(specimen, &octree)?;
    let ways = ways()?;
    let scenes = ways.map(|(_, gradient)| Scene {
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
    for (((name, _), rendering), times_of) in ways.iter().zip(&renderings).zip(&times) {
        let error = normal_error(&truth, &rendering.frame)?;
        rows.push(vec![
            specimen.name.as_str().into(),
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
        specimen.name,
        concise(specimen.iso),
        normal_error(&truth, &renderings[0].frame)?.compared
    );
    Ok((rows, finding))
}

/// Replaces the normals of a frame by those of a closed form where its rays hit.
fn put_normals(frame: &mut Frame, scene: &Scene, normal: fn(DVec3) -> DVec3) {
    let (Some(depths), Some(normals)) = (&frame.depth, &mut frame.normal) else {
        return;
    };
    let width = scene.size.width() as usize;
    for (pixel, (depth_mm, place)) in depths.iter().zip(normals).enumerate() {
        if depth_mm.is_finite() {
            let [x, y] = [pixel % width, pixel / width].map(|at| at as f64 + 0.5);
            let ray = scene.camera.ray(scene.size, x, y);
            let p_world = ray.origin_world + ray.dir_world * f64::from(*depth_mm);
            *place = normal(p_world).to_array().map(|c| c as f32);
        }
    }
}
