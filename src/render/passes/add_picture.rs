//! `kernels/pass/add_picture.cl`

use crate::error::Result;
use crate::gpu::Buffer;

use super::run::Run;

/// Adds a share of a `picture` to the mean of several, linear light, premultiplied; the first one replaces what was there.
pub fn add_picture(
    run: &mut Run,
    share: f32,
    is_first: bool,
    picture: &Buffer<[f32; 4]>,
    mean: &mut Buffer<[f32; 4]>,
) -> Result<()> {
    let args = run
        .screen_args()?
        .value("share", &share)
        .value("is_first", &u32::from(is_first))
        .read("picture", picture)
        .write("mean", mean);
    run.screen("add_picture", run.defines(), args)
}
