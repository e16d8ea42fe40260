//! Measuring the renderer against the reference: named experiments, each of which ends in a table.
//!
//! A new experiment is a file in `experiments/` with a `pub const EXPERIMENT`, and its line in
//! `experiments/mod.rs`.

pub mod aimed;
mod conditions;
pub mod convergence;
mod dataset;
mod experiments;
mod illustration;
mod journal;
mod page;
mod papers;
mod preset;
mod protocol;
mod random_scenes;
mod results;
mod rng;
mod store;

pub use conditions::Conditions;
pub use dataset::Dataset;
pub use experiments::EXPERIMENTS;
pub use illustration::Illustration;
pub use journal::Run;
pub use preset::Preset;
pub use protocol::Protocol;
pub use store::Store;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::VERSION;
use crate::error::{Error, Result};
use crate::frame::Wanted;
use crate::gpu::Device;
use crate::lab::measure::{Times, hash_kernels, hash_program, interleaved};
use crate::lab::report::{Section, Table};
use crate::octree::{Leaf, Octree};
use crate::progress::{Progress, Stage, UNKNOWN_TOTAL};
use crate::render::{Options, Renderer};
use crate::scene::Scene;

/// The inputs of an experiment: what the user chose, and what it is measured on.
pub struct Bench<'a> {
    /// The experiment that is run.
    pub experiment: &'static Experiment,
    /// The command line that runs it again.
    pub command: String,
    /// The device that is measured.
    pub device: &'a Device,
    /// How the device is used.
    pub options: Options,
    /// How large the pictures are, and how often they are timed.
    pub preset: Preset,
    /// How frames are timed, where the user said so.
    pub protocol: Option<Protocol>,
    /// The user's volumes.
    pub datasets: Vec<Dataset>,
    /// How many rays, where the experiment counts rays and the user said so.
    pub rays: Option<u64>,
    /// The seed of the rays, where the experiment counts rays and the user said so.
    pub seed: Option<u64>,
    /// How often each setting is timed, where the experiment leaves it to the user and the user said
    /// so.
    pub frames: Option<u32>,
    /// The command line of a program to time beside this one, where the experiment does.
    pub peer: Option<String>,
    /// Receives the progress of the work.
    pub progress: &'a dyn Progress,
    /// Where the results go, where the user wants them saved.
    pub store: Option<Store>,
}

impl Bench<'_> {
    /// The identity of this run: only a run of the same identity can resume it.
    ///
    /// # Errors
    /// The program cannot read its own file.
    pub fn run(&self) -> Result<Run> {
        let (mut program, mut kernels) = (blake3::Hasher::new(), blake3::Hasher::new());
        hash_program(&mut program)?;
        hash_kernels(&mut kernels);
        let hash = |hasher: blake3::Hasher| hasher.finalize().to_hex()[..16].to_owned();
        let device = self.device.info();
        let volumes = self.datasets.iter().map(Dataset::identity);
        let chosen = |choice: Option<String>| choice.unwrap_or_else(|| "the default".into());
        Ok(Run(vec![
            ("version", VERSION.into()),
            ("program", hash(program)),
            ("kernels", hash(kernels)),
            ("experiment", self.experiment.name.into()),
            ("effort", self.preset.name().into()),
            ("protocol", chosen(self.protocol.map(|one| one.to_string()))),
            ("rays", chosen(self.rays.map(|rays| rays.to_string()))),
            ("seed", chosen(self.seed.map(|seed| seed.to_string()))),
            (
                "frames",
                chosen(self.frames.map(|frames| frames.to_string())),
            ),
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

    /// Does a unit of work once: computes it, and records it in the journal where the user wants
    /// results saved; or takes it from there, where a run that was stopped had finished it. `key` names
    /// it among all units of the experiment.
    ///
    /// # Errors
    /// Those of `compute`; the disk failed; stopped at the user's request.
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

    /// Writes the rows so far where the user wants results saved, so that a later failure or stop does
    /// not lose them.
    ///
    /// # Errors
    /// The disk.
    fn so_far(&self, outcome: &Outcome) -> Result<()> {
        match &self.store {
            Some(store) => store.so_far(self, outcome),
            None => Ok(()),
        }
    }

    /// Checks, between two steps of a unit, whether a stop is requested. Without a store a signal ends
    /// the process by itself.
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

    fn octree(&self, dataset: &Dataset) -> Result<Octree> {
        Octree::build(&dataset.volume, Leaf::default(), self.progress)
    }

    fn renderer<'a>(&'a self, dataset: &'a Dataset, octree: &'a Octree) -> Result<Renderer<'a>> {
        Renderer::new(self.device, &dataset.volume, octree, self.options)
    }

    /// How times were taken, for the findings.
    fn timed(&self) -> String {
        let side_px = self.preset.side_px();
        let mut sentence = format!(
            "times are {}: pictures of {side_px}x{side_px} pixels unless stated otherwise, on {}; \
             ratios are the medians of each round's own",
            self.protocol().description(self.preset),
            self.device.info().name
        );
        if self.protocol() == Protocol::Orbit {
            sentence += "; errors and counters are of the orbit's first place alone";
        }
        sentence
    }

    /// The device times of `scenes`, as pictures for display without other planes.
    fn times(&self, renderer: &mut Renderer, scenes: &[Scene]) -> Result<Vec<Times>> {
        self.times_under(self.protocol(), scenes, |scene, azimuth_deg| {
            display_ms(renderer, scene, azimuth_deg)
        })
    }

    /// The times of `settings`, in turn: `once` returns the ms of a frame whose camera has turned by so
    /// many degrees ([`display_ms`]).
    fn times_under<S>(
        &self,
        protocol: Protocol,
        settings: &[S],
        mut once: impl FnMut(&S, f64) -> Result<f64>,
    ) -> Result<Vec<Times>> {
        let frames = protocol.frames(self.preset);
        self.times_of(settings, frames, |setting, round| {
            once(setting, protocol.azimuth_deg(self.preset, round))
        })
    }

    /// The times of `settings` in so many rounds: `once` returns the ms in a round, the first of which
    /// is for warming up.
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

/// The device time of a picture for display without other planes, its camera turned.
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

/// The results of an experiment.
pub struct Outcome {
    /// The figures, a row each.
    pub table: Table,
    /// The conditions under which they were measured.
    pub conditions: Conditions,
    /// The findings of the table, a sentence each.
    pub findings: Vec<String>,
    /// The sections of the page before its table: a volume or a picture each.
    pub sections: Vec<Section>,
    /// The pictures that the page shows.
    pub pictures: Vec<Illustration>,
    /// Why the experiment failed: what must hold does not.
    pub failure: Option<String>,
}

impl Outcome {
    /// An outcome of which nothing but its table is known.
    pub fn of(table: Table) -> Self {
        Self {
            table,
            conditions: Conditions::default(),
            findings: Vec::new(),
            sections: Vec::new(),
            pictures: Vec::new(),
            failure: None,
        }
    }
}

/// A measurement that anyone can repeat by its name.
pub struct Experiment {
    /// The experiment's name, as users write it.
    pub name: &'static str,
    /// One line for the list of experiments.
    pub about: &'static str,
    /// Whether the experiment uses [`Bench::datasets`].
    pub takes_volumes: bool,
    /// Whether the experiment uses [`Bench::rays`] and [`Bench::seed`].
    pub counts_rays: bool,
    /// Whether the experiment uses the protocol under which frames are timed.
    pub times_frames: bool,
    /// Whether the experiment uses [`Bench::frames`] and [`Bench::peer`]: it times whole frames beside
    /// another program's.
    pub takes_peer: bool,
    /// The measurement itself.
    pub run: fn(&Bench) -> Result<Outcome>,
}

impl Experiment {
    /// Finds an experiment by its name.
    ///
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
