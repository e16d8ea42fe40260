//! `kernels/pass/mark_uncertain.cl`

use crate::error::Result;
use crate::gpu::{Args, Buffer, Group};
use crate::render::abi::{KernelEnum, SeenBy};
use crate::scene::Emission;

use super::inputs::CastInputs;
use super::run::Run;

/// Pixels along the edge of the largest blocks that are tested, at most.
const MAX_BLOCK: u32 = 32;

/// Blocks of fewer pixels a side hold nothing but their corners.
const MIN_INTERPOLATED: u32 = 3;

/// Lanes of a work-item that tests blocks: the corners of a block, twice.
pub(super) const LANES: u32 = 8;

/// The blocks of pixels that are tested for what they show.
#[derive(Debug, Clone, Copy)]
pub struct Blocks {
    /// The width of the widest that are interpolated, in pixels.
    pub widest: u32,
    /// The width of the smallest that are tested, in pixels.
    smallest: u32,
    /// How often blocks are halved from the largest that are tested to the smallest.
    levels: u32,
}

impl Blocks {
    /// Single pixels.
    pub const PIXELS: Self = Self {
        widest: 1,
        smallest: 1,
        levels: MAX_BLOCK.ilog2(),
    };

    /// Blocks so wide, and those halved while they have more pixels than their corners.
    pub fn up_to(widest: u32) -> Self {
        let mut smallest = widest;
        while smallest.is_multiple_of(2) && smallest / 2 >= MIN_INTERPOLATED {
            smallest /= 2;
        }
        Self {
            widest,
            smallest,
            levels: (MAX_BLOCK / smallest).ilog2(),
        }
    }

    /// Whether there are pixels to interpolate.
    pub const fn have_insides(self) -> bool {
        self.widest >= MIN_INTERPOLATED
    }

    /// Pixels along the edge of the square that a work-item tests.
    pub(super) const fn square_side(self) -> u32 {
        self.smallest << self.levels
    }
}

impl Group for Blocks {
    fn add_to(self, args: Args) -> Args {
        args.value("spacing", &self.smallest)
            .value("block_levels", &self.levels)
    }
}

/// What is asked of a surface's blocks.
pub struct SurfaceBlocks<'a> {
    /// The blocks.
    pub blocks: Blocks,
    /// The iso value, stored units; +∞: a medium is asked for.
    pub iso: f32,
    /// How far from its centre a pixel's rays pass at most along either axis, in pixels.
    pub margin: f32,
    /// How far from the surface blocks that show nothing else may be interpolated, mm; `None`: none is.
    pub max_error_mm: Option<f32>,
    /// What each pixel's first ray saw, where it has had one.
    pub seen: Option<Seen<'a>>,
}

/// What the first ray of each pixel saw: of single pixels none is tested that met something.
#[derive(Clone, Copy)]
pub enum Seen<'a> {
    /// Of a surface, what was met.
    Kinds(&'a Buffer<u32>),
    /// Of a medium, its light, premultiplied, and opacity.
    Colors(&'a Buffer<[f32; 4]>),
}

impl Group for Seen<'_> {
    fn add_to(self, args: Args) -> Args {
        match self {
            Seen::Kinds(kind) => args.read("kind", kind),
            Seen::Colors(color) => args
                .value("opaque_from", &Emission::LAYERS_FROM)
                .read("color", color),
        }
    }
}

impl SeenBy {
    fn of(seen: Option<Seen>) -> Self {
        match seen {
            None => Self::Nothing,
            Some(Seen::Kinds(_)) => Self::Kinds,
            Some(Seen::Colors(_)) => Self::Opacities,
        }
    }
}

/// Marks in `cast` the pixels to be cast next whose blocks are not proven to show nothing of the surface, or one smooth
/// piece of it alone; as cast those that were seen to meet something.
pub fn mark_uncertain(
    run: &mut Run,
    inputs: CastInputs,
    asked: &SurfaceBlocks,
    cast: &mut Buffer<u32>,
) -> Result<()> {
    let (grid, _) = run.picture()?;
    let args = inputs
        .by_cells(run)
        .with(inputs.clip)
        .value("volume", &inputs.volume.grid)
        .value("rays", grid)
        .with(asked.blocks)
        .value("widest", &asked.blocks.widest)
        .value("margin", &asked.margin)
        .value("max_error_mm", &asked.max_error_mm.unwrap_or_default())
        .value("iso", &asked.iso)
        .with(asked.seen)
        .write("cast", cast);
    let defines = run
        .variant
        .defines()
        .with("LANES", LANES)
        .with("SURFACES", u32::from(asked.max_error_mm.is_some()))
        .with("SEEN", SeenBy::of(asked.seen).number());
    let side = asked.blocks.square_side();
    run.squares("mark_uncertain", defines, args, side)
}

#[cfg(test)]
mod tests {
    use super::Blocks;

    #[test]
    fn blocks_are_halved_while_they_have_insides() {
        let of = |widest| {
            let Blocks {
                smallest, levels, ..
            } = Blocks::up_to(widest);
            (smallest, levels)
        };
        assert_eq!(of(8), (4, 3));
        assert_eq!(of(4), (4, 3));
        assert_eq!(of(3), (3, 3));
        assert_eq!(of(2), (2, 4));
        assert_eq!(Blocks::PIXELS.square_side(), 32);
        assert!(Blocks::up_to(3).have_insides() && !Blocks::up_to(2).have_insides());
    }
}
