//! `kernels/pass/gather_blur.cl`

use crate::error::Result;
use crate::gpu::Buffer;
use crate::render::resources::BlurTaps;

use super::blur_circles::Discs;
use super::run::Run;

/// One layer of what is seen, with the discs of its pixels.
#[derive(Clone, Copy)]
pub struct BlurredLayer<'a> {
    /// What of it reaches each square of pixels.
    pub reaches: &'a Buffer<[f32; 4]>,
    /// The discs.
    pub discs: &'a Discs,
    /// Linear light, premultiplied.
    pub color: &'a Buffer<[f32; 4]>,
}

/// What a lens sees of what is `seen` first and of what that hides, gathered from the taps, in the squares that are blurred.
pub fn gather_blur(
    run: &mut Run,
    taps: &BlurTaps,
    seen: BlurredLayer,
    hidden: Option<BlurredLayer>,
    blurred: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let defines = run.defines().with("HIDDEN", u32::from(hidden.is_some()));
    let args = run
        .screen_args()?
        .with(taps)
        .read("reaches", seen.reaches)
        .with(seen.discs)
        .read("color", seen.color)
        .read_some("reaches_behind", hidden.map(|layer| layer.reaches))
        .with(hidden.map(|layer| layer.discs.behind()))
        .read_some("color_behind", hidden.map(|layer| layer.color))
        .write("blurred", blurred);
    run.screen("gather_blur", defines, args)
}
