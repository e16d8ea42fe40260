//! Anti-aliasing: many rays in every pixel, or in those where they may show something else than one.

use std::sync::Arc;

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::{CHECKED_OF, MARK_NEXT};
use crate::render::occupancy::Criterion;
use crate::render::passes::{
    FirstRays, Hits, Run, SampledPixels, compare_samples, mark_checked, mark_edges, mark_grid,
    mean_of_samples,
};
use crate::render::resources::RaySource;
use crate::scene::AntiAliasing;

use super::cues::{draw_edges, tint};
use super::listing::{Listed, Listing};
use super::picture::schedule;
use super::planes::{Centers, Planes};
use super::room::RAYS_AT_A_TIME;
use super::sample_check::SampleCheck;
use super::schedule::Schedule;
use super::view::View;

/// The greatest estimate of how much a pixel's mean differs from its centre, of sRGB-encoded channels, that does not
/// ask for more rays.
const THRESHOLD: f32 = 0.004;

/// Casts the rays of every pixel, or where anti-aliasing is adaptive of those pixels that look unlike their
/// neighbours or may show a surface that its first ray misses, and of a few of the others to tell how much those differ.
/// Layers are those of the rays through the pixels' centres.
///
/// # Errors
/// As [`Run::cast`]; the device failed or has no room.
pub fn cast_antialiased(
    run: &mut Run,
    view: &View,
    centers: &dyn Schedule,
    aa: AntiAliasing,
) -> Result<Planes> {
    let mut planes = centers.planes(run)?;
    if view.wanted.has(Layer::Coverage) {
        planes.coverage = Some(run.plane("coverage plane", 0.0)?);
    }
    let of_samples = view.of_other_rays();
    let schedule = schedule(run, &of_samples)?;
    let samples = Samples {
        view: &of_samples,
        schedule: schedule.as_ref(),
        aa,
    };
    let mut marks = run.plane("plane of marked pixels", 0)?;
    let mut listing = Listing::new(run)?;

    run.announcing = true;
    listing.announce(run, &mut marks)?;
    let one = Listed::placeholder(run)?;
    samples.show(run, &one, &mut planes)?;
    if aa.is_adaptive() {
        mark_unsampled(run, view, &planes, &mut marks)?;
        samples.compare(run, &one, &mut planes)?;
    }
    draw_edges(run, view, &mut planes)?;
    run.announcing = false;

    if aa.is_adaptive() || view.wanted.has_layers() || centers.needs_centers() {
        centers.cast(run, &mut planes)?;
        centers.finish(run, &mut planes)?;
        tint(run, view, &mut planes)?;
        planes.rays_per_round.push(run.rays.places() as u64);
    }
    if aa.is_adaptive() {
        mark_adaptively(run, view, centers, &mut planes, &mut marks)?;
    } else {
        mark_grid(run, 1, MARK_NEXT, &mut marks)?;
    }
    if let Some(listed) = listing.take(run, &mut marks)? {
        samples.show(run, &listed, &mut planes)?;
    }
    if aa.is_adaptive() {
        mark_unsampled(run, view, &planes, &mut marks)?;
        planes.check = Some(match listing.take(run, &mut marks)? {
            Some(listed) => samples.check(run, &listed, &mut planes)?,
            None => SampleCheck::default(),
        });
    }
    draw_edges(run, view, &mut planes)?;
    planes.other_bytes += marks.bytes();
    Ok(planes)
}

/// Marks the pixels that may show something else to many rays than to one.
fn mark_adaptively(
    run: &mut Run,
    view: &View,
    centers: &dyn Schedule,
    planes: &mut Planes,
    marks: &mut Buffer<u32>,
) -> Result<()> {
    centers.mark_hidden(run, planes, marks)?;
    let footprint = view.footprint(run)?;
    let seen = FirstRays {
        color: &planes.color,
        layers: &planes.layers,
        hits: planes
            .hit_mm
            .as_ref()
            .map(|hit_mm| Hits { footprint, hit_mm }),
    };
    mark_edges(run, THRESHOLD, seen, marks, planes.coverage.as_mut())
}

/// Marks a few of the pixels that have one ray alone, and of which it is not proven that many show the same.
fn mark_unsampled(
    run: &mut Run,
    view: &View,
    planes: &Planes,
    marks: &mut Buffer<u32>,
) -> Result<()> {
    let is_surface = matches!(view.inputs.occupancy.criterion(), Criterion::Iso(_));
    let kinds = planes.layers.layer_counts(Layer::Kind);
    mark_checked(run, kinds.filter(|_| is_surface), marks)
}

/// The rays of pixels with many.
struct Samples<'a> {
    view: &'a View<'a>,
    schedule: &'a dyn Schedule,
    aa: AntiAliasing,
}

impl Samples<'_> {
    /// Casts the rays of the listed pixels and puts their means in the planes' colour and coverage.
    fn show(&self, run: &mut Run, listed: &Listed, planes: &mut Planes) -> Result<()> {
        let Planes {
            color,
            coverage,
            layers,
            screen,
            ..
        } = &mut *planes;
        let centers = Centers {
            layers,
            screen: screen.as_ref(),
        };
        let bytes = self.cast(run, listed, centers, |run, pixels, cast| {
            let coverage = coverage.as_mut();
            mean_of_samples(run, pixels, &cast.color, &cast.layers, color, coverage)
        })?;
        self.count(run, listed, planes);
        if !run.announcing {
            planes.other_bytes += bytes;
        }
        Ok(())
    }

    /// Casts the rays of the listed pixels; what is returned is, for each, how much their mean differs from the planes'
    /// colour.
    fn compare(
        &self,
        run: &mut Run,
        listed: &Listed,
        planes: &mut Planes,
    ) -> Result<Buffer<[f32; 2]>> {
        let count = listed.next().len();
        let mut apart = Buffer::new(run.device, "differences of pixels", count)?;
        self.cast(run, listed, planes.centers(), |run, pixels, cast| {
            compare_samples(run, pixels, &cast.color, &planes.color, &mut apart)
        })?;
        self.count(run, listed, planes);
        Ok(apart)
    }

    /// Casts the rays of the listed pixels and waits for how much their means differ from the planes' colour.
    fn check(&self, run: &mut Run, listed: &Listed, planes: &mut Planes) -> Result<SampleCheck> {
        let apart = self.compare(run, listed, planes)?;
        run.timings.start(run.device)?;
        let apart = apart.download(run.device)?;
        let squares: f64 = apart.iter().map(|&[squares, _]| f64::from(squares)).sum();
        let max = apart.iter().fold(0.0, |max: f32, &[_, most]| max.max(most));
        let (_, size) = run.picture()?;
        let channels = 3.0 * size.pixels() as f64;
        Ok(SampleCheck {
            pixels: apart.len() as u64,
            rmse: (squares * f64::from(CHECKED_OF) / channels).sqrt(),
            max: f64::from(max),
        })
    }

    /// Counts the rays of a round, unless it is only announced.
    fn count(&self, run: &Run, listed: &Listed, planes: &mut Planes) {
        if !run.announcing {
            let rays = listed.next().len() as u64 * u64::from(self.aa.rays());
            planes.rays_per_round.push(rays);
        }
    }

    /// Casts the rays of the listed pixels, so many at a time, and hands each part on. Returns the bytes of the planes that
    /// took them.
    fn cast(
        &self,
        run: &mut Run,
        listed: &Listed,
        centers: Centers,
        mut each: impl FnMut(&mut Run, &SampledPixels, &Planes) -> Result<()>,
    ) -> Result<u64> {
        let (&grid, size) = run.picture()?;
        let rays = self.aa.rays();
        let count = listed.next().len();
        let pixels_at_a_time = RAYS_AT_A_TIME / rays as usize;
        let part = |first: usize| first..count.min(first + pixels_at_a_time);
        let samples = |part| RaySource::Samples {
            grid,
            size,
            listed: Arc::clone(&listed.pixels),
            part,
            per_side: self.aa.per_side(),
        };
        let all = std::mem::replace(&mut run.rays, samples(part(0)));
        let mut cast = self.schedule.planes(run)?;
        for first in (0..count).step_by(pixels_at_a_time) {
            run.rays = samples(part(first));
            self.schedule.cast_between(run, centers, &mut cast)?;
            tint(run, self.view, &mut cast)?;
            let pixels = SampledPixels {
                listed: &listed.pixels,
                part: part(first),
                rays,
            };
            each(run, &pixels, &cast)?;
        }
        run.rays = all;
        Ok(cast.bytes())
    }
}
