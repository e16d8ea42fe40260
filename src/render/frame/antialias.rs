//! Anti-aliasing: many rays in every pixel, or in those where they may show something else than one.

use std::sync::Arc;

use crate::error::Result;
use crate::frame::{Layer, Wanted};
use crate::gpu::Buffer;
use crate::render::occupancy::Criterion;
use crate::render::passes::{
    Blocks, Differs, Run, SampledPixels, mark_edges, mark_grid, mark_uncertain, mean_of_samples,
};
use crate::render::resources::RaySource;
use crate::scene::AntiAliasing;

use super::listing::Listing;
use super::picture::schedule;
use super::planes::Planes;
use super::room::RAYS_AT_A_TIME;
use super::schedule::Schedule;
use super::view::View;

/// The greatest difference of channels, sRGB-encoded, by which a pixel's neighbours do not ask for more rays.
const THRESHOLD: f32 = 0.02;

/// Casts the rays of every pixel, or where anti-aliasing is adaptive of those pixels that differ from their
/// neighbours or may show a surface that its first ray misses. Layers are those of the rays through the
/// pixels' centres.
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
    let of_samples = View {
        wanted: Wanted::NONE,
        ..*view
    };
    let samples = schedule(run, &of_samples)?;
    let mut marks = run.plane("plane of marked pixels", 0)?;
    let mut listing = Listing::new(run)?;

    run.announcing = true;
    let mut one = Buffer::new(run.device, "list of pixels", 1)?;
    listing.announce(run, &mut marks, &mut one)?;
    cast_samples(run, samples.as_ref(), one, aa, &mut planes)?;
    run.announcing = false;

    if aa.is_adaptive() || view.wanted.has_layers() {
        centers.cast(run, &mut planes)?;
        planes.rays_per_round.push(run.rays.places() as u64);
    }
    if aa.is_adaptive() {
        mark_adaptively(run, view, &mut planes, &mut marks)?;
    } else {
        mark_grid(run, 1, &mut marks)?;
    }
    if let Some(listed) = listing.take(run, &mut marks)? {
        let rays = listed.count() as u64 * u64::from(aa.rays());
        planes.rays_per_round.push(rays);
        cast_samples(run, samples.as_ref(), listed, aa, &mut planes)?;
    }
    planes.other_bytes += marks.bytes();
    Ok(planes)
}

/// Marks the pixels that may show something else to many rays than to one.
fn mark_adaptively(
    run: &mut Run,
    view: &View,
    planes: &mut Planes,
    marks: &mut Buffer<u32>,
) -> Result<()> {
    let criterion = view.inputs.occupancy.criterion();
    let empty_is_known = matches!(criterion, Criterion::Iso(_));
    match criterion {
        Criterion::Iso(iso) => {
            let blocks = Blocks {
                spacing: 1,
                margin: 0.5,
            };
            mark_uncertain(run, view.inputs, blocks, iso.value, marks)?;
        }
        Criterion::Floor(_) | Criterion::Opacity(_) => mark_grid(run, 1, marks)?,
    }
    let differs = Differs {
        threshold: THRESHOLD,
        footprint: view.footprint(run)?,
    };
    let mut coverage = planes.coverage.take();
    mark_edges(
        run,
        differs,
        empty_is_known,
        planes.seen(),
        marks,
        coverage.as_mut(),
    )?;
    planes.coverage = coverage;
    Ok(())
}

/// Casts the rays of the listed pixels and puts their means in the planes' colour and coverage.
fn cast_samples(
    run: &mut Run,
    schedule: &dyn Schedule,
    listed: Buffer<u32>,
    aa: AntiAliasing,
    planes: &mut Planes,
) -> Result<()> {
    let (&grid, size) = run.picture()?;
    let listed = Arc::new(listed);
    let pixels_at_a_time = RAYS_AT_A_TIME / aa.rays() as usize;
    let part = |first: usize| first..listed.count().min(first + pixels_at_a_time);
    let samples = |part| RaySource::Samples {
        grid,
        size,
        listed: Arc::clone(&listed),
        part,
        per_side: aa.per_side(),
    };
    let all = std::mem::replace(&mut run.rays, samples(part(0)));
    let mut cast = schedule.planes(run)?;
    for first in (0..listed.count()).step_by(pixels_at_a_time) {
        run.rays = samples(part(first));
        schedule.cast(run, &mut cast)?;
        let pixels = SampledPixels {
            listed: &listed,
            part: part(first),
            rays: aa.rays(),
        };
        let Planes {
            color, coverage, ..
        } = &mut *planes;
        let coverage = coverage.as_mut();
        mean_of_samples(run, &pixels, &cast.color, &cast.layers, color, coverage)?;
    }
    run.rays = all;
    if !run.announcing {
        planes.other_bytes += cast.bytes();
    }
    Ok(())
}
