//! What there is to say of one pixel of two pictures.

use super::spread::Spread;

/// One pixel, as to one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Entry {
    /// Neither picture has anything here.
    Nothing,
    /// Only the reference has something here.
    Missed,
    /// Only the other picture has something here.
    Extra,
    /// The picture minus the reference; finite.
    Difference(f64),
}

impl Entry {
    /// The picture minus the reference, where both have something.
    pub fn difference(self) -> Option<f64> {
        match self {
            Self::Difference(difference) => Some(difference),
            _ => None,
        }
    }

    /// `difference` where both pictures have something.
    ///
    /// # Errors
    /// That of `difference`.
    pub(super) fn of<E>(
        in_reference: bool,
        in_frame: bool,
        difference: impl FnOnce() -> Result<f64, E>,
    ) -> Result<Self, E> {
        Ok(match (in_reference, in_frame) {
            (true, true) => Self::Difference(difference()?),
            (true, false) => Self::Missed,
            (false, true) => Self::Extra,
            (false, false) => Self::Nothing,
        })
    }
}

/// Entries counted, and their absolute differences.
pub(super) struct Tally {
    /// Pixels where only the reference has something.
    pub missed: u64,
    /// Pixels where only the other picture has something.
    pub extra: u64,
    /// Pixels where both have something.
    pub compared: u64,
    /// Statistics of the absolute differences; `None` if there are none.
    pub spread: Option<Spread>,
}

impl Tally {
    /// Counts entries and gathers their differences.
    pub fn of(entries: &[Entry]) -> Self {
        let count = |which| entries.iter().filter(|&&entry| entry == which).count() as u64;
        let mut differences: Vec<f64> = entries
            .iter()
            .filter_map(|entry| entry.difference().map(f64::abs))
            .collect();
        Self {
            missed: count(Entry::Missed),
            extra: count(Entry::Extra),
            compared: differences.len() as u64,
            spread: Spread::of(&mut differences),
        }
    }
}
