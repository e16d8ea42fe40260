//! A mode of a comparison: what is seen, and the settings in which it is drawn.

use crate::error::Result;
use crate::lab::measure::{accurate, built_in};
use crate::options::{ErrorBound, Resolved, SceneOptions, Setting};
use crate::scene::Mode;
use crate::subject::Subject;

use super::look::Look;

/// A mode, what is seen in it, and the settings in which it is rendered.
#[derive(Debug, Clone)]
pub struct ModeSettings {
    /// What kind of picture is rendered.
    pub mode: Mode,
    /// What of its light is shown; `None`: what the options say.
    pub look: Option<Look>,
    /// The scene that the reference renders.
    pub resolved: Resolved,
    pub(super) settings: Vec<(Setting, Resolved)>,
    /// The cheapest setting that keeps it takes part.
    pub(super) bound: Option<ErrorBound>,
}

impl ModeSettings {
    /// The name of the setting that the options give beside those that are compared.
    const AS_GIVEN: &str = "as given";

    /// The names of the settings that take part, in their order.
    pub(super) fn names(&self) -> Vec<String> {
        let names = self.settings.iter().map(|(setting, _)| setting.name());
        let mut names: Vec<String> = names.map(str::to_owned).collect();
        names.extend(self.bound.map(Self::name_of_bound));
        names
    }

    /// The name of the setting that a bound chooses.
    pub(super) fn name_of_bound(bound: ErrorBound) -> String {
        format!("max-error {bound}")
    }

    /// The scenes of a mode, in a look: what is seen by `base`, as far as it means something in this mode,
    /// and how by each of `settings`. Where none are given they are the built-in ones; of a look, whose light is what is compared,
    /// an accurate one.
    ///
    /// # Errors
    /// Usage: the options contradict each other, or a setting cannot be combined with the mode.
    pub fn new(
        (mode, look): (Mode, Option<Look>),
        base: &SceneOptions,
        settings: Option<Vec<Setting>>,
        subject: &Subject,
    ) -> Result<Self> {
        let resolved = Self::seen(mode, look, base)?.resolve(subject)?;
        let settings = match (settings, look) {
            (Some(settings), _) => settings,
            (None, None) => built_in(mode)?,
            (None, Some(_)) => vec![accurate(mode)?],
        };
        let mut this = Self {
            mode,
            look,
            resolved,
            settings: Vec::new(),
            bound: None,
        };
        for setting in settings {
            this.add(setting, subject)?;
        }
        Ok(this)
    }

    /// What is seen by `base` in a mode and a look, however rays are followed.
    ///
    /// # Errors
    /// Usage: the options contradict each other.
    pub fn seen(mode: Mode, look: Option<Look>, base: &SceneOptions) -> Result<SceneOptions> {
        let base = base.of_mode(mode).what();
        let base = look.map_or(Ok(base.clone()), |look| look.of(&base));
        base?.checked()
    }

    /// The mode, and the look.
    pub(super) fn seen_as(&self) -> (Mode, Option<Look>) {
        (self.mode, self.look)
    }

    /// Its name in results and names of files: the mode's, and the look's.
    pub fn name(&self) -> String {
        name_of(self.mode, self.look)
    }

    /// Adds one setting: what `options` says, as far as it means something in the mode, of how rays
    /// are followed. Nothing where it says nothing.
    ///
    /// # Errors
    /// As [`Self::add`].
    pub fn add_given(&mut self, options: &SceneOptions, subject: &Subject) -> Result<()> {
        let how = options.of_mode(self.mode).how();
        if how == SceneOptions::default() {
            return Ok(());
        }
        self.add(Setting::new(Self::AS_GIVEN, how)?, subject)
    }

    /// Adds the setting that a bound chooses.
    ///
    /// # Errors
    /// Usage: the mode has no such metric.
    pub fn add_bound(&mut self, bound: ErrorBound) -> Result<()> {
        bound.check(self.mode)?;
        self.bound = Some(bound);
        Ok(())
    }

    /// Adds one setting.
    ///
    /// # Errors
    /// Usage: it cannot be combined with the mode.
    pub fn add(&mut self, setting: Setting, subject: &Subject) -> Result<()> {
        let options = setting.over(&self.resolved.options).checked();
        let resolved = options.and_then(|options| options.resolve(subject));
        let resolved = resolved
            .map_err(|error| error.at(format!("{}: setting '{}'", self.name(), setting.name())))?;
        self.settings.push((setting, resolved));
        Ok(())
    }
}

/// The name of a mode in a look.
pub(super) fn name_of(mode: Mode, look: Option<Look>) -> String {
    match look {
        Some(look) => format!("{mode}-{look}"),
        None => mode.to_string(),
    }
}
