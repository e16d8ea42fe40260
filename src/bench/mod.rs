//! Measuring the renderer against the reference: named experiments, each of which ends in a table.
//!
//! A new experiment is a file in `experiments/` with a `pub const EXPERIMENT`, and its line in
//! `experiments/mod.rs`.

pub mod aimed;
mod borderline;
mod compare;
pub mod convergence;
mod draws;
mod effort;
mod experiments;
mod random;
mod results;
mod specimen;
mod verdict;

pub use effort::Effort;
pub use experiments::EXPERIMENTS;
pub use results::Results;
pub use specimen::Specimen;
pub use verdict::{Judge, Met, Verdict};

use crate::error::{Error, Result};
use crate::frame::Wanted;
use crate::gpu::Device;
use crate::measure::{Times, interleaved};
use crate::octree::{Leaf, Octree};
use crate::progress::Progress;
use crate::render::{Options, Renderer};
use crate::report::Table;
use crate::scene::Scene;

/// What an experiment is given to work with.
pub struct Bench<'a> {
    pub device: &'a Device,
    pub options: Options,
    pub effort: Effort,
    /// The user's volumes.
    pub specimens: Vec<Specimen>,
    /// How many rays, where the experiment counts rays and the user said so.
    pub rays: Option<u64>,
    pub progress: &'a dyn Progress,
}

impl Bench<'_> {
    fn octree(&self, specimen: &Specimen) -> Result<Octree> {
        Octree::build(&specimen.volume, Leaf::default(), self.progress)
    }

    fn renderer<'a>(&'a self, specimen: &'a Specimen, octree: &'a Octree) -> Result<Renderer<'a>> {
        Renderer::new(self.device, &specimen.volume, octree, self.options)
    }

    /// What times stand for, for the findings.
    fn timed(&self) -> String {
        let (side_px, repeats) = (self.effort.side_px(), self.effort.repeats());
        format!(
            "times are the least and the median of {repeats} repeats in turn of pictures of \
             {side_px}x{side_px} pixels, on {}; ratios are the medians of each repeat's own",
            self.device.info().name
        )
    }

    /// How long the device takes for each of `scenes`: pictures for display, of which nothing else
    /// is asked.
    fn times(&self, renderer: &mut Renderer, scenes: &[Scene]) -> Result<Vec<Times>> {
        let wanted = Wanted {
            display: true,
            ..Wanted::default()
        };
        let repeats = self.effort.repeats();
        let renderings = scenes.len() * (repeats + 1);
        self.progress.begin("timing", renderings as u64);
        let times = interleaved(scenes, repeats, |scene| {
            self.progress.advance(1);
            Ok(renderer.render(scene, wanted)?.render_ms)
        });
        self.progress.end();
        times
    }
}

/// What an experiment found.
pub struct Outcome {
    pub table: Table,
    /// What the table shows, a sentence each.
    pub findings: Vec<String>,
    /// Why the experiment failed: what must hold does not.
    pub failure: Option<String>,
}

/// A measurement that anyone can repeat by its name.
pub struct Experiment {
    pub name: &'static str,
    /// One line for the list of experiments.
    pub about: &'static str,
    /// Whether [`Bench::specimens`] are looked at.
    pub takes_volumes: bool,
    /// Whether [`Bench::rays`] is.
    pub counts_rays: bool,
    pub run: fn(&Bench) -> Result<Outcome>,
}

impl Experiment {
    /// # Errors
    /// Usage: there is no such experiment; the error lists all.
    pub fn named(name: &str) -> Result<&'static Self> {
        let found = EXPERIMENTS.iter().find(|one| one.name == name);
        found.ok_or_else(|| {
            let names: Vec<&str> = EXPERIMENTS.iter().map(|one| one.name).collect();
            Error::usage(format!("there is no experiment '{name}'"))
                .hint(format!("the experiments are {}", names.join(", ")))
        })
    }
}
