//! Flags over a scene file: which of the file's options stay.

use super::SceneOptions;
use super::group::Keys;
use super::rules::{Group, Need, REPLACED, has_needs, is_other_mode};

impl SceneOptions {
    /// Lays these flags over a scene file's options. What a flag rules out in the file, such as the eye
    /// when the flag is a view, or the iso value when it is another mode, goes with it.
    #[must_use]
    pub fn over(self, file: Self) -> Self {
        let kept = self.kept_of(&file);
        self.or(kept)
    }

    /// The options of a scene file that still apply when these are the flags.
    fn kept_of(&self, file: &Self) -> Self {
        let replaced = REPLACED.iter().filter(|row| (row.by)(self, file));
        let replaced: Vec<&str> = replaced.flat_map(|row| row.options).copied().collect();
        let kept = file.clone().keeping(|option| !replaced.contains(&option));
        let together = self.clone().or(kept.clone());
        kept.keeping(|option| {
            has_needs(Group::Scene, option, |need| {
                !self.rules_out(need, file, &together)
            })
        })
    }

    /// Whether these flags take away from a file what one of its options needs: what the file never had is
    /// refused, unless a flag has to do with it.
    fn rules_out(&self, need: Need, file: &Self, together: &Self) -> bool {
        let is_other_mode = is_other_mode(self, file);
        let is_decided = match need {
            Need::Modes(..) => is_other_mode,
            Need::Shading => is_other_mode || self.picture.shading.is_some(),
            Need::Precomputed(_) => self.picture.gradient.is_some(),
            _ => false,
        };
        !together.allows(need) && (is_decided || file.meets(need))
    }
}
