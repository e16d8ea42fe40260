//! A candidate in a scene.

use super::Task;
use crate::error::Result;
use crate::options::{Resolved, SceneOptions, Setting};

/// A candidate in the scene, and what is known of it.
pub struct Contender {
    pub setting: Setting,
    pub resolved: Resolved,
    /// The first of its chain, and the last.
    pub is_coarsest: bool,
    pub is_finest: bool,
    pub ms: Option<f64>,
    /// Once it was looked at.
    pub error: Option<f64>,
    pub judged: bool,
}

impl Contender {
    /// A candidate, by its place in its chain, beside what the user says of how rays are followed.
    pub fn new(
        candidate: &Setting,
        at: usize,
        finest: usize,
        own: &SceneOptions,
        task: &Task,
    ) -> Result<Self> {
        let how = candidate.over(&SceneOptions::default()).over(own.clone());
        let setting = Setting::new(candidate.name(), how)?;
        let resolved = setting
            .over(task.options)
            .checked()?
            .resolve(task.subject)?;
        Ok(Self {
            setting,
            resolved,
            is_coarsest: at == 0,
            is_finest: at == finest,
            ms: None,
            error: None,
            judged: false,
        })
    }
}
