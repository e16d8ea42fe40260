//! Who takes part in a comparison.

use crate::measure::PeerScene;

/// One of the pictures that are compared.
pub enum Contender {
    /// This renderer, in a setting by its place among the mode's.
    Setting(usize),
    /// Another renderer, by its place among the peers, in one of its own settings.
    Peer {
        peer: usize,
        setting: String,
        /// What it has ready, once it was asked for its picture.
        scene: Option<PeerScene>,
    },
}
