//! `kernels/pass/mean_of_samples.cl`

use std::ops::Range;

use crate::error::Result;
use crate::extent::ImageSize;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer, Group};
use crate::render::resources::DeviceLayers;
use crate::scene::Emission;

use super::run::Run;

/// Work-items in a row of the launch.
const ROW: usize = 1024;

/// Pixels that have several rays each.
pub struct SampledPixels<'a> {
    /// Pixels, counted row by row.
    pub listed: &'a Buffer<[u32; 2]>,
    /// The part of the list that has rays.
    pub part: Range<usize>,
    /// The number of rays of each.
    pub rays: u32,
}

impl SampledPixels<'_> {
    /// The work-items of a launch, one a pixel.
    pub(super) fn items(&self) -> Result<ImageSize> {
        let count = self.part.len();
        ImageSize::new(ROW.min(count) as u32, count.div_ceil(ROW) as u32)
    }
}

impl Group for &SampledPixels<'_> {
    fn add_to(self, args: Args) -> Args {
        args.read("listed", self.listed)
            .value("first", &(self.part.start as u32))
            .value("count", &(self.part.len() as u32))
            .value("per_pixel", &self.rays)
    }
}

/// The means of the rays of pixels: of their colours, and where `coverage` is wanted the share that met
/// something.
pub fn mean_of_samples(
    run: &mut Run,
    pixels: &SampledPixels,
    sample_color: &Buffer<[f32; 4]>,
    sample_layers: &DeviceLayers,
    color: &mut Buffer<[f32; 4]>,
    coverage: Option<&mut Buffer<f32>>,
) -> Result<()> {
    let kind = sample_layers.layer_counts(Layer::Kind);
    let defines = run
        .scalar_defines()
        .with("WITH_KIND", u32::from(kind.is_some()))
        .with("COVERAGE", u32::from(coverage.is_some()));
    let args = Args::new()
        .with(pixels)
        .value("opaque_from", &Emission::LAYERS_FROM)
        .read("sample_color", sample_color)
        .read_some("sample_kind", kind)
        .write("color", color)
        .read_some("coverage", coverage.as_deref());
    run.items("mean_of_samples", defines, args, pixels.items()?)
}
