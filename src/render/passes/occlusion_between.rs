//! `kernels/pass/occlusion_between.cl`

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer};
use crate::render::resources::{DeviceLayers, RaySource, Spans};

use super::run::Run;

/// What a surface keeps from the hits of the run's rays, several in each of listed pixels, by what it keeps from those of
/// the pixels' `centers`. Reads the kinds.
///
/// # Errors
/// As [`Run::items`]; the run's rays are others.
pub fn occlusion_between(
    run: &mut Run,
    centers: (&Spans, &DeviceLayers),
    hit_mm: &Buffer<f32>,
    layers: &mut DeviceLayers,
) -> Result<()> {
    let (spans, of_centers) = centers;
    let RaySource::Samples {
        grid,
        listed,
        part,
        per_side,
        ..
    } = &run.rays
    else {
        return Err(Error::failed(
            "only a pixel with several rays has some between",
        ));
    };
    let args = Args::new()
        .value("rays", grid)
        .read("listed", listed)
        .value("first", &(part.start as u32))
        .value("count", &(part.len() as u32))
        .value("per_side", per_side)
        .with(&spans.screen)
        .read("spans", &spans.depths)
        .with(of_centers.reading(&[Layer::Occlusion]))
        .read("sample_hit_mm", hit_mm)
        .read_some("sample_kind", layers.layer_counts(Layer::Kind))
        .read_some("sample_occlusion", layers.layer_scalars(Layer::Occlusion));
    let items = rows(run.rays.places())?;
    run.items("occlusion_between", run.scalar_defines(), args, items)
}

/// A launch of so many work-items.
fn rows(count: usize) -> Result<ImageSize> {
    /// Work-items in a row.
    const ROW: usize = 1024;
    ImageSize::new(ROW.min(count) as u32, count.div_ceil(ROW) as u32)
}
