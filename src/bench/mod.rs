//! Measuring the renderer against the reference: named experiments, each of which ends in a table.
//!
//! A new experiment is a file in `experiments/` with a `pub const EXPERIMENT`, and its line in
//! `experiments/mod.rs`.

pub mod aimed;
mod borderline;
mod conduct;
pub mod convergence;
mod draws;
mod effort;
mod experiments;
mod illustration;
mod journal;
mod page;
mod protocol;
mod random;
mod results;
mod specimen;
mod store;
mod verdict;
mod ways;

pub use conduct::Conduct;
pub use effort::Effort;
pub use experiments::EXPERIMENTS;
pub use illustration::Illustration;
pub use journal::Run;
pub use protocol::Protocol;
pub use specimen::Specimen;
pub use store::Store;
pub use verdict::{Judge, Met, Verdict};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::VERSION;
use crate::error::{Error, Result};
use crate::frame::Wanted;
use crate::gpu::Device;
use crate::measure::{Times, hash_kernels, hash_program, interleaved};
use crate::octree::{Leaf, Octree};
use crate::progress::{Progress, Stage, UNKNOWN_TOTAL};
use crate::render::{Options, Renderer};
use crate::report::{Section, Table};
use crate::scene::Scene;

/// What an experiment is given to work with.
pub struct Bench<'a> {
    /// What is measured.
    pub experiment: &'static Experiment,
    /// The line that runs it again.
    pub command: String,
    /// What is measured on.
    pub device: &'a Device,
    /// How the device is used.
    pub options: Options,
    /// How thoroughly.
    pub effort: Effort,
    /// The user's choice.
    pub protocol: Option<Protocol>,
    /// The user's volumes.
    pub specimens: Vec<Specimen>,
    /// How many rays, where the experiment counts rays and the user said so.
    pub rays: Option<u64>,
    /// What decides them, where the experiment counts rays and the user said so.
    pub seed: Option<u64>,
    /// How often each setting is timed, where the experiment leaves it to the user and the user said
    /// so.
    pub frames: Option<u32>,
    /// The command line of a program to race, where the experiment does.
    pub peer: Option<String>,
    /// Who is told how far the work is.
    pub progress: &'a dyn Progress,
    /// Where the user wants the results kept.
    pub store: Option<Store>,
}

impl Bench<'_> {
    /// What this run is of: only a run of the same can go on with it.
    ///
    /// # Errors
    /// The program cannot read its own file.
    pub fn run(&self) -> Result<Run> {
        let (mut program, mut kernels) = (blake3::Hasher::new(), blake3::Hasher::new());
        hash_program(&mut program)?;
        hash_kernels(&mut kernels);
        let hash = |hasher: blake3::Hasher| hasher.finalize().to_hex()[..16].to_owned();
        let device = self.device.info();
        let volumes = self.specimens.iter().map(Specimen::identity);
        let told = |choice: Option<String>| choice.unwrap_or_else(|| "the default".into());
        Ok(Run(vec![
            ("version", VERSION.into()),
            ("program", hash(program)),
            ("kernels", hash(kernels)),
            ("experiment", self.experiment.name.into()),
            ("effort", self.effort.name().into()),
            ("protocol", told(self.protocol.map(|one| one.to_string()))),
            ("rays", told(self.rays.map(|rays| rays.to_string()))),
            ("seed", told(self.seed.map(|seed| seed.to_string()))),
            ("frames", told(self.frames.map(|frames| frames.to_string()))),
            ("peer", self.peer.clone().unwrap_or_else(|| "none".into())),
            ("volumes", volumes.collect::<Vec<_>>().join("; ")),
            (
                "device",
                format!("{}, {}, {}", device.name, device.platform, device.driver),
            ),
            ("work group", format!("{:?}", self.options.work_group)),
            ("lanes", format!("{:?}", self.options.lanes)),
        ]))
    }

    /// A piece of work that is done once: computed, and kept where the user wants results kept; or
    /// taken from there, where a run that was stopped had finished it. `key` names it among all of
    /// the experiment.
    ///
    /// # Errors
    /// Those of `compute`; the disk; stopped, where the user asked for it.
    fn unit<T: Serialize + DeserializeOwned>(
        &self,
        key: &str,
        compute: impl FnOnce() -> Result<T>,
    ) -> Result<T> {
        let compute = || {
            let _stage = Stage::begin(self.progress, key, UNKNOWN_TOTAL);
            compute()
        };
        match &self.store {
            Some(store) => store.unit(key, compute),
            None => compute(),
        }
    }

    /// Leaves the rows so far where the user wants results kept: what fails or is stopped later
    /// does not take them along.
    ///
    /// # Errors
    /// The disk.
    fn so_far(&self, outcome: &Outcome) -> Result<()> {
        match &self.store {
            Some(store) => store.so_far(self, outcome),
            None => Ok(()),
        }
    }

    /// Between two steps of a unit: whether the user asked for the end. Without a store a signal
    /// ends the process by itself.
    ///
    /// # Errors
    /// Stopped.
    fn check_stop(&self) -> Result<()> {
        match &self.store {
            Some(store) => store.check_stop(),
            None => Ok(()),
        }
    }

    /// How frames are timed.
    fn protocol(&self) -> Protocol {
        self.protocol.unwrap_or_default()
    }

    fn octree(&self, specimen: &Specimen) -> Result<Octree> {
        Octree::build(&specimen.volume, Leaf::default(), self.progress)
    }

    fn renderer<'a>(&'a self, specimen: &'a Specimen, octree: &'a Octree) -> Result<Renderer<'a>> {
        Renderer::new(self.device, &specimen.volume, octree, self.options)
    }

    /// What times stand for, for the findings.
    fn timed(&self) -> String {
        let side_px = self.effort.side_px();
        let mut told = format!(
            "times are {}: pictures of {side_px}x{side_px} pixels unless told otherwise, on {}; \
             ratios are the medians of each round's own",
            self.protocol().told(self.effort),
            self.device.info().name
        );
        if self.protocol() == Protocol::Orbit {
            told += "; errors and counters are of the orbit's first place alone";
        }
        told
    }

    /// How long the device takes for each of `scenes`: pictures for display, of which nothing else
    /// is asked.
    fn times(&self, renderer: &mut Renderer, scenes: &[Scene]) -> Result<Vec<Times>> {
        self.times_under(self.protocol(), scenes, |scene, azimuth_deg| {
            display_ms(renderer, scene, azimuth_deg)
        })
    }

    /// How long each of `settings` takes, in turn: `once` gives the ms of a frame whose camera has
    /// turned by so many degrees ([`display_ms`]).
    fn times_under<S>(
        &self,
        protocol: Protocol,
        settings: &[S],
        mut once: impl FnMut(&S, f64) -> Result<f64>,
    ) -> Result<Vec<Times>> {
        let frames = protocol.frames(self.effort);
        self.times_of(settings, frames, |setting, round| {
            once(setting, protocol.azimuth_deg(self.effort, round))
        })
    }

    /// How long each of `settings` takes in so many rounds: `once` gives the ms in a round, the first
    /// of which is for warming up.
    fn times_of<S>(
        &self,
        settings: &[S],
        rounds: usize,
        mut once: impl FnMut(&S, usize) -> Result<f64>,
    ) -> Result<Vec<Times>> {
        let frames = settings.len() * (rounds + 1);
        let stage = Stage::begin(self.progress, "timing", frames as u64);
        let mut measured = 0;
        interleaved(settings, rounds, |setting| {
            self.check_stop()?;
            stage.advance(1);
            let round = measured / settings.len();
            measured += 1;
            once(setting, round)
        })
    }
}

/// The device time of a picture for display, of which nothing else is asked, its camera turned.
fn display_ms(renderer: &mut Renderer, scene: &Scene, azimuth_deg: f64) -> Result<f64> {
    let wanted = Wanted::DISPLAY;
    let rendering = if azimuth_deg == 0.0 {
        renderer.render(scene, wanted)?
    } else {
        let (center_world, _) = renderer.volume().bounding_sphere();
        renderer.render(&protocol::turned(scene, center_world, azimuth_deg), wanted)?
    };
    Ok(rendering.render_ms)
}

/// What an experiment found.
pub struct Outcome {
    /// The figures, a row each.
    pub table: Table,
    /// How they were measured.
    pub conduct: Conduct,
    /// What the table shows, a sentence each.
    pub findings: Vec<String>,
    /// Of the page, before its table: a volume or a picture each.
    pub sections: Vec<Section>,
    pub pictures: Vec<Illustration>,
    /// Why the experiment failed: what must hold does not.
    pub failure: Option<String>,
}

impl Outcome {
    /// With an empty table.
    pub fn of(table: Table) -> Self {
        Self {
            table,
            conduct: Conduct::default(),
            findings: Vec::new(),
            sections: Vec::new(),
            pictures: Vec::new(),
            failure: None,
        }
    }
}

/// A measurement that anyone can repeat by its name.
pub struct Experiment {
    pub name: &'static str,
    /// One line for the list of experiments.
    pub about: &'static str,
    /// Whether [`Bench::specimens`] are looked at.
    pub takes_volumes: bool,
    /// Whether [`Bench::rays`] and [`Bench::seed`] are.
    pub counts_rays: bool,
    /// Whether the protocol under which frames are timed is.
    pub times_frames: bool,
    /// Whether [`Bench::frames`] and [`Bench::peer`] are: it times whole frames beside another
    /// program's.
    pub races: bool,
    pub run: fn(&Bench) -> Result<Outcome>,
}

impl Experiment {
    /// # Errors
    /// Usage: there is no such experiment; the error lists all.
    pub fn named(name: &str) -> Result<&'static Self> {
        let is_it = |one: &&Self| one.name.eq_ignore_ascii_case(name);
        let found = EXPERIMENTS.iter().find(is_it);
        found.ok_or_else(|| {
            let names: Vec<&str> = EXPERIMENTS.iter().map(|one| one.name).collect();
            Error::usage(format!("there is no experiment '{name}'"))
                .hint(format!("the experiments are {}", names.join(", ")))
        })
    }
}
