//! The cheapest setting that keeps an error bound (`--max-error`).
//!
//! A device renders a whole picture in the time in which the reference casts a few hundred rays. So
//! every candidate is rendered whole, a small picture of the same view first; the reference's rays
//! are spent on what the device cannot know (`evidence` says how the two are put together):
//!
//! 1. *Screened* in a small picture, of each chain of ever finer candidates from the coarsest on: the
//!    error against the device's surest picture, until one is within the bound; then the times of
//!    these, in turn. What is finer takes longer and is not tried before the coarser one fails.
//! 2. *Evaluated* in the real picture, the fastest first, with an upper confidence limit from random
//!    tiles of reference rays, until one is within the bound; with it those about as fast, which
//!    are timed in turn.
//! 3. *Verified*: the fastest of them (of equals the one of the least error) on fresh tiles, and by
//!    the reference at the pixels where its error is largest; where the camera moves, elsewhere on its
//!    path too. What fails is out, and the next is tried.
//!
//! Where nothing keeps the bound, the surest setting is taken, and reported as beyond the bound.

mod candidate;
mod candidates;
mod deviation;
mod evidence;
mod search;
mod stats;
mod student;
mod summary;
mod tiles;

use std::time::Instant;

pub use candidates::candidates;
pub use stats::ToleranceStats;
pub use student::CONFIDENCE;

use crate::error::Result;
use crate::frame::Wanted;
use crate::options::{ErrorBound, Resolved, SceneOptions, Setting};
use crate::progress::{Progress, UNKNOWN_TOTAL};
use crate::render::Renderer;
use crate::scene::Camera;
use crate::subject::Subject;
use crate::volume::Volume;

use search::Search;

/// The seed of the random tiles unless another is given: the same in every run.
pub const SEED: u64 = 1;

/// The task for which a setting is chosen.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The volume that is rendered.
    pub volume: &'a Volume,
    /// The properties of the volume from which defaults are made.
    pub subject: &'a Subject,
    /// The options of the picture; of those that say how rays are followed, only what the bound does not
    /// decide ([`SceneOptions::undecided`]).
    pub options: &'a SceneOptions,
    /// The error bound that is to be kept.
    pub bound: ErrorBound,
    /// The planes that are rendered afterwards: what the time is taken of.
    pub wanted: Wanted,
    /// The seed of the random tiles.
    pub seed: u64,
    /// Other places of the camera where the same setting has to keep the bound: a choice is verified
    /// at each.
    pub elsewhere: &'a [Camera],
}

/// A setting that keeps the bound, or the surest one.
#[derive(Debug)]
pub struct Choice {
    /// The error bound that was asked for.
    pub bound: ErrorBound,
    /// The chosen setting.
    pub setting: Setting,
    /// The scene under it, and the options that make it.
    pub resolved: Resolved,
    /// Whether the upper limit is within the bound, on the tiles of the verification too.
    pub met: bool,
    /// The error as verified, in the metric's unit.
    pub estimate: f64,
    /// The upper confidence limit: the error is at most this (psnr: at least) with [`CONFIDENCE`].
    pub upper: f64,
    /// How much was rendered to verify the choice.
    pub verified: Verified,
    /// Every candidate that was tried, in the grid's order.
    pub tried: Vec<Tried>,
    /// What it cost to choose.
    pub cost: Cost,
}

/// What a choice was verified on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Verified {
    /// The number of places of the camera.
    pub views: usize,
    /// The number of fresh random tiles; none where the tiles before were the whole picture.
    pub tiles: usize,
    /// The number of the reference's rays in these tiles.
    pub rays: usize,
}

/// How a candidate did.
#[derive(Debug, Clone, PartialEq)]
pub struct Tried {
    /// The setting that was tried.
    pub setting: Setting,
    /// The time in the size it was last timed in, ms; of candidates within the bound.
    pub ms: Option<f64>,
    /// The error as last measured, in the metric's unit; infinite for a missed hit's depth.
    pub error: f64,
    /// Whether the error was measured in the real picture, against the reference.
    pub evaluated: bool,
}

/// The cost of the choice itself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cost {
    /// The elapsed time, ms.
    pub ms: f64,
    /// The number of rays that the reference cast.
    pub rays: u64,
    /// The number of whole pictures that the device rendered.
    pub renderings: usize,
    /// The part of `ms` that went into building kernels.
    pub build_ms: f64,
    /// The part of `ms` that went into uploading.
    pub upload_ms: f64,
    /// The bytes uploaded from host to device.
    pub uploaded_bytes: u64,
}

/// Chooses the cheapest setting of the candidates that keeps the bound.
///
/// The choice depends on how long candidates take, and so on the machine and its load; the
/// pictures of each setting do not.
///
/// # Errors
/// Usage: the mode has no such metric, the options contradict each other. The device fails.
pub fn choose(task: &Task, renderer: &mut Renderer, progress: &dyn Progress) -> Result<Choice> {
    let began = Instant::now();
    let search = Search::new(task, renderer)?;
    progress.begin("choosing how", UNKNOWN_TOTAL);
    let mut choice = search.run()?;
    progress.end();
    choice.cost.ms = began.elapsed().as_secs_f64() * 1e3;
    Ok(choice)
}
