//! How long-running work says where it is, without knowing who listens.

/// The total of a stage that cannot say how far it is.
pub const UNKNOWN_TOTAL: u64 = 0;

/// Listens to stages of work, each from 0 to its total in units of its own; one that begins before
/// another has ended is a part of it.
pub trait Progress: Sync {
    /// A stage starts: `name` is what the user reads ("reading", "octree"); `total` in units of
    /// the stage's own, or [`UNKNOWN_TOTAL`].
    fn begin(&self, name: &str, total: u64);
    /// `units` more are done of the innermost stage.
    fn advance(&self, units: u64);
    /// The innermost stage is over.
    fn end(&self);
}

/// A listener that ignores everything.
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _name: &str, _total: u64) {}
    fn advance(&self, _units: u64) {}
    fn end(&self) {}
}

/// A stage that ends when this is dropped, also when an error is returned.
pub struct Stage<'a>(&'a dyn Progress);

impl<'a> Stage<'a> {
    /// Begins a stage, as [`Progress::begin`] does. Stages may lie in one another.
    pub fn begin(progress: &'a dyn Progress, name: &str, total: u64) -> Self {
        progress.begin(name, total);
        Self(progress)
    }

    /// Reports that `units` more are done.
    pub fn advance(&self, units: u64) {
        self.0.advance(units);
    }
}

impl Drop for Stage<'_> {
    fn drop(&mut self) {
        self.0.end();
    }
}
