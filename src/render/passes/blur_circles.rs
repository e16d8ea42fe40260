//! `kernels/pass/blur_circles.cl`

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::{Args, Buffer, Group};
use crate::render::resources::DeviceLayers;

use super::run::Run;

/// What the pixels of one layer of what is seen give to those that their discs reach.
pub struct Discs {
    /// The diameters of their circles of confusion, pixels; 0 where nothing is seen.
    pub circle: Buffer<f32>,
    /// What each covers of the lens as seen from a pixel that its disc reaches; 0 where nothing is seen.
    pub cover: Buffer<f32>,
}

impl Discs {
    /// Room for those of all pixels.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(run: &Run) -> Result<Self> {
        Ok(Self {
            circle: run.plane("plane of circles of confusion", 0.0)?,
            cover: run.plane("plane of covers", 0.0)?,
        })
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.circle.bytes() + self.cover.bytes()
    }

    /// The discs of what first surfaces hide, as arguments.
    pub(super) fn behind(&self) -> impl Group + '_ {
        Behind(self)
    }
}

impl Group for &Discs {
    fn add_to(self, args: Args) -> Args {
        args.read("circle", &self.circle).read("cover", &self.cover)
    }
}

struct Behind<'a>(&'a Discs);

impl Group for Behind<'_> {
    fn add_to(self, args: Args) -> Args {
        args.read("circle_behind", &self.0.circle)
            .read("cover_behind", &self.0.cover)
    }
}

/// The discs of all pixels of a `color` that have a depth; with `by_alpha`, as pixels have several rays, of all that are not
/// clear, and each covers as much as it is opaque. Reads the depth and the circles of confusion.
pub fn blur_circles(
    run: &mut Run,
    by_alpha: bool,
    layers: &DeviceLayers,
    color: &Buffer<[f32; 4]>,
    discs: &mut Discs,
) -> Result<()> {
    let args = run
        .screen_args()?
        .value("by_alpha", &u32::from(by_alpha))
        .with(layers.reading(&[Layer::Depth, Layer::Coc]))
        .read("color", color)
        .write("circle", &mut discs.circle)
        .write("cover", &mut discs.cover);
    run.screen("blur_circles", run.defines(), args)
}
