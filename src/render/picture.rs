//! The passes of each kind of picture: straight-line code, the order of lines is the schedule.

use std::time::Instant;

use crate::error::Result;
use crate::frame::Wanted;
use crate::gpu::Buffer;
use crate::octree::Octree;
use crate::scene::{Phong, Projection, Refine, Rgb, SamplingMethod, Scene, Traverse, Window};
use crate::volume::Volume;

use super::abi::{ProjectionCast, RayGrid, SurfaceCast};
use super::cells;
use super::classify;
use super::clip::DeviceClip;
use super::gradient::DeviceGradient;
use super::passes::{
    DeviceVolume, Run, cast_maximum, cast_surface, exact_projection, exact_surface, shade_surface,
    surface_normal, window_value,
};
use super::planes::Planes;
use super::reach::add_reach;
use super::twins::{self, stored};
use super::variant::{ProjectionLoop, refine_number, traverse_number};

/// What is looked at, and what is wanted of it.
pub struct View<'a> {
    pub scene: &'a Scene,
    pub wanted: Wanted,
    pub volume: &'a Volume,
    pub octree: &'a Octree,
    pub uploaded: &'a DeviceVolume,
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

    /// The classes on the device, with their reach where that is how space is skipped.
    pub fn upload_classes(
        &self,
        run: &mut Run,
        classify: impl FnOnce() -> Vec<u8>,
    ) -> Result<Buffer<u8>> {
        let start = Instant::now();
        let mut classes = classify();
        if self.scene.sampling.traverse == Traverse::Distance {
            add_reach(self.octree, &mut classes);
        }
        run.classify_ms += start.elapsed().as_secs_f64() * 1e3;
        Buffer::upload(run.device, "octree's classes", &classes)
    }

    /// What of sign · Φ a projection need not find, in stored units: what is not above the volume's
    /// own end, unless it may be a local maximum that counts; or, where only the picture is wanted,
    /// what the window shows as it shows its own end.
    fn floor(&self, of: Projection, window: Window) -> f32 {
        let rescale = self.volume.rescale();
        let [min, max] = self.octree.ranges()[self.octree.ranges().len() - 1];
        let picture_alone = !(self.wanted.value || self.wanted.depth);
        match of {
            Projection::Maximum if picture_alone => min.max(stored(rescale, window.low())),
            Projection::Minimum if picture_alone => -max.min(stored(rescale, window.high())),
            Projection::Maximum => min,
            Projection::Minimum => -max,
            Projection::LocalMaximum { threshold } if stored(rescale, threshold) > min => min,
            Projection::LocalMaximum { .. } | Projection::Mean => f32::NEG_INFINITY,
        }
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
    let asked = view.volume.rescale().stored(iso);
    let iso = stored(view.volume.rescale(), iso);
    let iso_error = (asked - f64::from(iso)).abs() as f32;
    let node_class = view.upload_classes(run, || classify::by_iso(view.octree, iso, iso_error))?;
    let start = Instant::now();
    let classes = classify::by_iso(view.octree, iso, iso_error);
    let cells = cells::crossed(view.volume, view.octree, &classes, iso, iso_error);
    let cells = Buffer::upload(run.device, "crossed cells", &cells)?;
    run.classify_ms += start.elapsed().as_secs_f64() * 1e3;
    let cast = SurfaceCast {
        iso,
        step_mm: view.step_mm(),
        caps: u32::from(caps),
        refine: refine_number(refine),
        iterations: refine.iterations,
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
            &node_class,
            &cells,
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
            &node_class,
            &cells,
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
        other_bytes: hit_mm.bytes() + node_class.bytes(),
    })
}

/// `mip`, `minip`, `mean`, `lmip`: cast, then the window.
pub fn projection(run: &mut Run, view: &View, of: Projection, window: Window) -> Result<Planes> {
    let wanted = view.wanted;
    let (which, sign, threshold) = match of {
        Projection::Maximum => (ProjectionLoop::Extremum, 1.0, 0.0),
        Projection::Minimum => (ProjectionLoop::Extremum, -1.0, 0.0),
        Projection::Mean => (ProjectionLoop::Mean, 1.0, 0.0),
        Projection::LocalMaximum { threshold } => (
            ProjectionLoop::Local,
            1.0,
            stored(view.volume.rescale(), threshold),
        ),
    };
    let floor = view.floor(of, window);
    let cast = ProjectionCast {
        step_mm: view.step_mm(),
        sign,
        threshold,
        traverse: view.traverse(),
        probe: u32::from(view.scene.sampling.probe),
        floor,
        pad_0: 0,
        pad_1: 0,
    };
    let node_class = view.upload_classes(run, || classify::by_floor(view.octree, sign, floor))?;
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
        &node_class,
        &view.rays,
        &cast,
        &mut kind,
        &mut value,
        depth.as_mut(),
        counters.as_mut(),
    )?;

    let mut color = run.plane("colour plane")?;
    let rescale = view.volume.rescale();
    let window = [
        stored(rescale, window.low()),
        stored(rescale, window.high()),
    ];
    window_value(run, &view.rays, window, &kind, &value, &mut color)?;
    Ok(Planes {
        color,
        display: None,
        depth,
        normal: None,
        value: Some(value),
        kind: Some(kind),
        certificate: None,
        counters,
        other_bytes: node_class.bytes(),
    })
}
