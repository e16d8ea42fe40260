//! Sparse casting: a list of pixels to cast, and a rule that says where more are needed, until it is
//! satisfied; what was not cast is filled.

use crate::error::{Error, Result};
use crate::gpu::Buffer;
use crate::render::occupancy::Criterion;
use crate::render::passes::{
    Blocks, Differs, Filling, Run, mark_grid, mark_refill, mark_uncertain,
};
use crate::render::resources::RaySource;
use crate::scene::{Refill, Sparse};

use super::listing::Listing;
use super::planes::Planes;
use super::schedule::Schedule;
use super::view::View;

/// The most rounds in which a flood spreads; what it has not reached then is interpolated.
const MAX_ROUNDS: usize = 256;

/// Casts the pixels that sparse casting asks for and fills the others.
///
/// The device is waited for once a round: what it marked decides how many rays are cast next. Every pass is
/// built before the first of them.
///
/// # Errors
/// As [`Run::cast`]; the device failed or has no room.
pub fn cast_sparsely(
    run: &mut Run,
    view: &View,
    schedule: &dyn Schedule,
    sparse: Sparse,
) -> Result<Planes> {
    let mut planes = schedule.planes(run)?;
    let mut marks = run.plane("plane of cast pixels", 0)?;
    let mut listing = Listing::new(run)?;
    let rule = Rule { view, sparse };
    let (&grid, size) = run.picture()?;
    let pixels = |listed| RaySource::Pixels { grid, size, listed };

    run.announcing = true;
    let mut listed = Buffer::new(run.device, "list of pixels", 1)?;
    listing.announce(run, &mut marks, &mut listed)?;
    rule.refill(run, &planes, &mut marks)?;
    schedule.fill(run, rule.filling(), &marks, &mut planes)?;
    let all = std::mem::replace(&mut run.rays, pixels(listed));
    schedule.cast(run, &mut planes)?;
    run.announcing = false;

    rule.begin(run, &mut marks)?;
    while let Some(listed) = listing.take(run, &mut marks)? {
        planes.rays_per_round.push(listed.count() as u64);
        run.rays = pixels(listed);
        schedule.cast(run, &mut planes)?;
        if planes.rays_per_round.len() <= rule.max_refills() {
            rule.refill(run, &planes, &mut marks)?;
        }
    }
    run.rays = all;
    schedule.fill(run, rule.filling(), &marks, &mut planes)?;
    planes.cast = Some(marks);
    Ok(planes)
}

/// Which pixels are cast, first and then.
struct Rule<'a> {
    view: &'a View<'a>,
    sparse: Sparse,
}

impl Rule<'_> {
    /// Marks the pixels that are cast first, and all others to be filled.
    fn begin(&self, run: &mut Run, marks: &mut Buffer<u32>) -> Result<()> {
        let spacing = self.sparse.spacing;
        match self.sparse.refill {
            Refill::None | Refill::Gradient | Refill::Flood => mark_grid(run, spacing, marks),
            Refill::Certified => match self.view.inputs.occupancy.criterion() {
                Criterion::Iso(iso) => {
                    let blocks = Blocks {
                        spacing,
                        margin: 0.0,
                    };
                    mark_uncertain(run, self.view.inputs, blocks, iso.value, marks)
                }
                _ => Err(Error::usage("only a surface is cast with a certificate")),
            },
        }
    }

    /// Marks the pixels that are cast after those that were.
    fn refill(&self, run: &mut Run, planes: &Planes, marks: &mut Buffer<u32>) -> Result<()> {
        let floods = match self.sparse.refill {
            Refill::None | Refill::Certified => return Ok(()),
            Refill::Gradient => false,
            Refill::Flood => true,
        };
        let differs = Differs {
            threshold: self.sparse.threshold as f32,
            footprint: self.view.footprint(run)?,
        };
        let mut seen = planes.seen();
        if !floods {
            seen.layers = None; // the paper's method compares colours
        }
        mark_refill(run, self.sparse.spacing, floods, differs, seen, marks)
    }

    /// How often pixels are marked again at most.
    fn max_refills(&self) -> usize {
        match self.sparse.refill {
            Refill::None | Refill::Certified => 0,
            Refill::Gradient => 1,
            Refill::Flood => MAX_ROUNDS,
        }
    }

    fn filling(&self) -> Filling {
        match self.sparse.refill {
            Refill::Certified => Filling::Empty,
            _ => Filling::Blocks(self.sparse.spacing),
        }
    }
}
