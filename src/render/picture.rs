//! The passes of each kind of picture: straight-line code, the order of lines is the schedule.

use crate::error::Result;
use crate::frame::Wanted;
use crate::octree::Octree;
use crate::scene::{Phong, Projection, Refine, Rgb, SamplingMethod, Scene, Window};
use crate::volume::Volume;

use super::abi::{ProjectionCast, RayGrid, SurfaceCast};
use super::classified::{Classified, floor, sign};
use super::clip::DeviceClip;
use super::gradient::DeviceGradient;
use super::passes::{
    DeviceVolume, Run, cast_maximum, cast_surface, exact_projection, exact_surface, shade_surface,
    surface_normal, window_value,
};
use super::planes::Planes;
use super::twins::{self, stored, stored_window, stored_with_error};
use super::variant::{ProjectionLoop, refine_number, traverse_number};

/// What is looked at, and what is wanted of it.
pub struct View<'a> {
    pub scene: &'a Scene,
    pub wanted: Wanted,
    pub volume: &'a Volume,
    pub octree: &'a Octree,
    pub uploaded: &'a DeviceVolume,
    pub classified: &'a Classified,
    pub clip: &'a DeviceClip,
    pub gradient: DeviceGradient<'a>,
    pub rays: RayGrid,
}

impl View<'_> {
    pub fn step_mm(&self) -> f32 {
        twins::step_mm(&self.scene.sampling, self.volume) as f32
    }

    pub fn traverse(&self) -> u32 {
        traverse_number(&self.scene.sampling)
    }
}

/// `iso`: cast, normals where they are needed, shade.
pub fn surface(
    run: &mut Run,
    view: &View,
    iso: f64,
    caps: bool,
    refine: Refine,
    color: Rgb,
    phong: Option<Phong>,
) -> Result<Planes> {
    let wanted = view.wanted;
    let (iso, iso_error) = stored_with_error(view.volume.rescale(), iso);
    let cast = SurfaceCast {
        iso,
        step_mm: view.step_mm(),
        caps: u32::from(caps),
        refine: refine_number(refine),
        iterations: refine.iterations(),
        traverse: view.traverse(),
        probe: u32::from(view.scene.sampling.probe),
        iso_error,
    };
    let mut hit_mm = run.plane("hit plane")?;
    let mut kind = run.plane("kind plane")?;
    let mut layers = if wanted.depth || wanted.value {
        Some((run.plane("depth plane")?, run.plane("value plane")?))
    } else {
        None
    };
    let mut counters = run.counters(wanted.counters)?;
    let proven = wanted.certificate && view.scene.sampling.method == SamplingMethod::Exact;
    let mut certificate = proven.then(|| run.plane("certificate plane")).transpose()?;
    match view.scene.sampling.method {
        SamplingMethod::Fixed => cast_surface(
            run,
            view.uploaded,
            view.clip,
            view.classified,
            &view.rays,
            &cast,
            &mut hit_mm,
            &mut kind,
            layers.as_mut().map(|(depth, value)| (depth, value)),
            counters.as_mut(),
        )?,
        SamplingMethod::Exact => exact_surface(
            run,
            view.uploaded,
            view.clip,
            view.classified,
            &view.rays,
            &cast,
            &mut hit_mm,
            &mut kind,
            layers.as_mut().map(|(depth, value)| (depth, value)),
            certificate.as_mut(),
            counters.as_mut(),
        )?,
    }

    let normal = if wanted.normal || phong.is_some() {
        let mut normal = run.plane("normal plane")?;
        surface_normal(
            run,
            view.uploaded,
            view.gradient,
            view.clip,
            &view.rays,
            &hit_mm,
            &kind,
            &mut normal,
        )?;
        Some(normal)
    } else {
        None
    };

    let shading = twins::shading(color, phong, view.scene.light);
    let mut color = run.plane("colour plane")?;
    let shaded_by = normal.as_ref().filter(|_| phong.is_some());
    shade_surface(run, &view.rays, &shading, &kind, shaded_by, &mut color)?;

    let (depth, value) = layers.unzip();
    Ok(Planes {
        color,
        display: None,
        depth,
        normal,
        value,
        kind: Some(kind),
        certificate,
        counters,
        other_bytes: hit_mm.bytes(),
    })
}

/// `mip`, `minip`, `mean`, `lmip`: cast, then the window.
pub fn projection(run: &mut Run, view: &View, of: Projection, window: Window) -> Result<Planes> {
    let wanted = view.wanted;
    let (which, threshold) = match of {
        Projection::Maximum | Projection::Minimum => (ProjectionLoop::Extremum, 0.0),
        Projection::Mean => (ProjectionLoop::Mean, 0.0),
        Projection::LocalMaximum { threshold } => (
            ProjectionLoop::Local,
            stored(view.volume.rescale(), threshold),
        ),
    };
    let cast = ProjectionCast {
        step_mm: view.step_mm(),
        sign: sign(of),
        threshold,
        traverse: view.traverse(),
        probe: u32::from(view.scene.sampling.probe),
        floor: floor(of, window, wanted, view.volume, view.octree),
        pad_0: 0,
        pad_1: 0,
    };
    let mut kind = run.plane("kind plane")?;
    let mut value = run.plane("value plane")?;
    let mut depth = wanted.depth.then(|| run.plane("depth plane")).transpose()?;
    let mut counters = run.counters(wanted.counters)?;
    let project = match view.scene.sampling.method {
        SamplingMethod::Fixed => cast_maximum,
        SamplingMethod::Exact => exact_projection,
    };
    project(
        run,
        which,
        view.uploaded,
        view.clip,
        view.classified,
        &view.rays,
        &cast,
        &mut kind,
        &mut value,
        depth.as_mut(),
        counters.as_mut(),
    )?;

    let mut color = run.plane("colour plane")?;
    let ends = stored_window(view.volume.rescale(), window);
    window_value(run, &view.rays, ends, &kind, &value, &mut color)?;
    Ok(Planes {
        color,
        display: None,
        depth,
        normal: None,
        value: Some(value),
        kind: Some(kind),
        certificate: None,
        counters,
        other_bytes: 0,
    })
}
