//! A candidate in a scene.

use super::Task;
use crate::error::Result;
use crate::options::{Resolved, SceneOptions, Setting};

/// A candidate in the scene, and what is known of it.
pub struct Candidate {
    pub setting: Setting,
    pub resolved: Resolved,
    /// The first of its chain, and the last.
    pub is_coarsest: bool,
    pub is_finest: bool,
    pub ms: Option<f64>,
    /// The error, once it is known.
    pub error: Option<f64>,
    /// Whether the error is that of the real picture against the reference.
    pub evaluated: bool,
}

impl Candidate {
    /// A setting, by its index in its chain, under the user's own options of how rays are followed.
    pub fn new(
        setting: &Setting,
        at: usize,
        finest: usize,
        own: &SceneOptions,
        task: &Task,
    ) -> Result<Self> {
        let how = setting.over(&SceneOptions::default()).over(own.clone());
        let setting = Setting::new(setting.name(), how)?;
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
            evaluated: false,
        })
    }
}
