//! `kernels/pass/mark_checked.cl`

use crate::error::Result;
use crate::gpu::Buffer;

use super::run::Run;

/// Marks in `cast` a few of the pixels to be cast next that have one ray alone; where there are `kinds`, of those that met
/// something.
pub fn mark_checked(
    run: &mut Run,
    kinds: Option<&Buffer<u32>>,
    cast: &mut Buffer<u32>,
) -> Result<()> {
    let args = run
        .screen_args()?
        .read_some("kind", kinds)
        .write("cast", cast);
    let defines = run
        .scalar_defines()
        .with("WITH_KIND", u32::from(kinds.is_some()));
    run.squares("mark_checked", defines, args, 1)
}
