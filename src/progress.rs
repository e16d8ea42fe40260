//! How long-running work says where it is, without knowing who listens.

/// The total of a stage that cannot say how far it is.
pub const UNKNOWN_TOTAL: u64 = 0;

/// Listens to stages of work, each from 0 to its total in units of its own.
pub trait Progress: Sync {
    /// A stage starts: `name` is what the user reads ("reading", "octree"); `total` in units of
    /// the stage's own, or [`UNKNOWN_TOTAL`].
    fn begin(&self, name: &str, total: u64);
    /// `units` more are done.
    fn advance(&self, units: u64);
    /// The stage is over.
    fn end(&self);
}

/// Listens to nothing.
pub struct Silent;

impl Progress for Silent {
    fn begin(&self, _name: &str, _total: u64) {}
    fn advance(&self, _units: u64) {}
    fn end(&self) {}
}
