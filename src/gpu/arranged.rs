//! What the process arranged for its drivers when it began.

use std::path::Path;
use std::sync::OnceLock;

use super::scratch::Scratch;

/// Names the folder where PoCL caches what it builds. What the user names is not used: PoCL loads what lies
/// there without a check.
pub(super) const POCL_FOLDER: &str = "POCL_CACHE_DIR";

static ARRANGED: OnceLock<Arranged> = OnceLock::new();

/// The environment that [`super::process::begin`] has set up.
pub(super) struct Arranged {
    /// A folder for what drivers write; nothing where there is no place for it.
    pub scratch: Option<Scratch>,
}

/// Sets what was arranged; only the first time counts.
pub(super) fn arrange(arranged: Arranged) {
    let _ = ARRANGED.set(arranged);
}

/// The environment that the process has set up; `None` in a library.
pub(super) fn arranged() -> Option<&'static Arranged> {
    ARRANGED.get()
}

impl Arranged {
    /// The folder that drivers are given, made if need be.
    ///
    /// # Errors
    /// The reason why there is none, as a clause.
    pub fn folder(&self) -> Result<&Path, String> {
        let Some(scratch) = &self.scratch else {
            return Err("no place takes files that may be loaded as programs".to_owned());
        };
        match scratch.make() {
            Ok(()) => Ok(scratch.path()),
            Err(cause) => Err(format!("{}: {cause}", scratch.path().display())),
        }
    }
}
