//! `--max-error`: choosing, and reporting the choice.

use crate::error::Result;
use crate::frame::Wanted;
use crate::lab::tolerance::{self, Choice, SEED, Task};
use crate::options::{ErrorBound, SceneOptions};
use crate::scene::Camera;

use super::backend::Caster;
use super::progress::Bars;
use super::source::Loaded;
use super::terminal::note;

/// Chooses the cheapest setting that meets a bound, and prints the choice. The reference has only
/// one, against which all errors are measured: it needs no choice, whatever the bound.
pub fn choose(
    bound: ErrorBound,
    options: &SceneOptions,
    loaded: &Loaded,
    wanted: Wanted,
    elsewhere: &[Camera],
    caster: &mut Caster,
    bars: &Bars,
) -> Result<Option<Choice>> {
    let Caster::Device { renderer, .. } = caster else {
        note(format_args!(
            "max-error {bound}: errors are measured against the reference, so nothing is chosen"
        ));
        return Ok(None);
    };
    let task = Task {
        volume: &loaded.volume,
        subject: &loaded.subject,
        options,
        bound,
        wanted,
        seed: SEED,
        elsewhere,
    };
    let choice = tolerance::choose(&task, renderer, bars)?;
    note(&choice);
    Ok(Some(choice))
}
