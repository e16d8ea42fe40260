//! Sparse casting: a list of pixels to cast, and a rule that says where more are needed, until it is
//! satisfied; what was not cast is filled.

use std::sync::Arc;

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::{Filling, MARK_NEXT};
use crate::render::passes::{Blocks, Differs, Fill, Run, mark_grid, mark_refill};
use crate::render::resources::RaySource;
use crate::scene::{Refill, Sparse};

use super::cues::{draw_edges, tint};
use super::listing::{Listed, Listing};
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
    let rule = Rule {
        view,
        schedule,
        sparse,
    };
    let (&grid, size) = run.picture()?;
    let pixels = |list: &Listed, part| RaySource::Pixels {
        grid,
        size,
        listed: Arc::clone(&list.pixels),
        part,
    };

    run.announcing = true;
    let mut list = Listed::placeholder(run)?;
    listing.announce(run, &mut marks)?;
    rule.refill(run, &planes, &mut marks)?;
    rule.fill(run, &marks, &mut planes)?;
    schedule.finish(run, &mut planes)?;
    let all = std::mem::replace(&mut run.rays, pixels(&list, list.next()));
    schedule.cast(run, &mut planes)?;
    if rule.interpolates_hits() {
        schedule.interpolate(run, &marks, &mut planes)?;
    }
    let listed = std::mem::replace(&mut run.rays, all);
    tint(run, view, &mut planes)?;
    draw_edges(run, view, &mut planes)?;
    let all = std::mem::replace(&mut run.rays, listed);
    run.announcing = false;

    rule.begin(run, &mut marks)?;
    while let Some(next) = listing.take(run, &mut marks)? {
        list = next;
        planes.rays_per_round.push(list.next().len() as u64);
        run.rays = pixels(&list, list.next());
        schedule.cast(run, &mut planes)?;
        if planes.rays_per_round.len() > rule.max_refills() {
            break;
        }
        rule.refill(run, &planes, &mut marks)?;
    }
    if rule.interpolates_hits() && !list.in_blocks().is_empty() {
        run.rays = pixels(&list, list.in_blocks());
        schedule.interpolate(run, &marks, &mut planes)?;
    }
    run.rays = all;
    rule.fill(run, &marks, &mut planes)?;
    if schedule.finish(run, &mut planes)? {
        rule.fill(run, &marks, &mut planes)?;
    }
    tint(run, view, &mut planes)?;
    draw_edges(run, view, &mut planes)?;
    planes.cast = Some(marks);
    Ok(planes)
}

/// Which pixels are cast, first and then.
struct Rule<'a> {
    view: &'a View<'a>,
    schedule: &'a dyn Schedule,
    sparse: Sparse,
}

impl Rule<'_> {
    /// Marks the pixels that are cast first, and all others to be filled.
    fn begin(&self, run: &mut Run, marks: &mut Buffer<u32>) -> Result<()> {
        let Sparse {
            spacing,
            screen_error,
            ..
        } = self.sparse;
        match self.sparse.refill {
            Refill::None | Refill::Gradient | Refill::Flood => {
                mark_grid(run, spacing, MARK_NEXT, marks)
            }
            Refill::Certified => {
                let blocks = Blocks::up_to(spacing);
                self.schedule
                    .mark_unproven(run, blocks, screen_error, marks)
            }
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
        let mut compared = planes.compared();
        if !floods {
            compared.layers = None; // the paper's method compares colours
        }
        mark_refill(run, self.sparse.spacing, floods, differs, compared, marks)
    }

    /// How often pixels are marked again at most.
    fn max_refills(&self) -> usize {
        match self.sparse.refill {
            Refill::None | Refill::Certified => 0,
            Refill::Gradient => 1,
            Refill::Flood => MAX_ROUNDS,
        }
    }

    /// Fills the pixels that were not cast.
    fn fill(&self, run: &mut Run, marks: &Buffer<u32>, planes: &mut Planes) -> Result<()> {
        let fill = Fill {
            filling: self.filling(),
            spacing: self.sparse.spacing,
            with_normals: self.view.wanted.has(Layer::Normal),
        };
        self.schedule.fill(run, fill, marks, planes)
    }

    fn filling(&self) -> Filling {
        match self.sparse.refill {
            Refill::Certified => self.schedule.proven_filling(),
            _ => Filling::Grid,
        }
    }

    /// Whether blocks may be left that are interpolated by the hits at their corners.
    fn interpolates_hits(&self) -> bool {
        self.filling() == Filling::Empty && Blocks::up_to(self.sparse.spacing).have_insides()
    }
}
