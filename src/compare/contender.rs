//! Who takes part in a comparison.

use std::collections::HashSet;

use crate::error::{Error, Result};
use crate::measure::{Peer, PeerScene};

use super::mode::ModeSettings;
use super::row::Row;

/// What the picture is called that the others are held against.
pub const REFERENCE: &str = "reference";

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

/// The settings, then what the peers have for the mode.
pub fn contenders(of_mode: &ModeSettings, peers: &[Peer]) -> Vec<Contender> {
    let settings = (0..of_mode.settings.len()).map(Contender::Setting);
    let others = peers.iter().enumerate().flat_map(|(peer, one)| {
        let settings = one.settings(&of_mode.mode.to_string()).into_iter();
        settings.map(move |setting| Contender::Peer {
            peer,
            setting,
            scene: None,
        })
    });
    settings.chain(others).collect()
}

/// What rows call a peer.
pub fn renderer_name(peer: &Peer) -> String {
    format!("{} {}", peer.name(), peer.version())
}

/// That a mode has contenders, each with a name of its own.
///
/// # Errors
/// Usage: it has none, or two of one name.
pub fn check(of_mode: &ModeSettings, peers: &[Peer]) -> Result<()> {
    let of_peers = peers.iter().flat_map(|peer| {
        let settings = peer.settings(&of_mode.mode.to_string()).into_iter();
        settings.map(|setting| Row::title_of_peer(&renderer_name(peer), &setting))
    });
    let titles: Vec<String> = of_mode.names().into_iter().chain(of_peers).collect();
    if titles.is_empty() {
        return Err(
            Error::usage(format!("there is no setting for mode '{}'", of_mode.mode))
                .hint("give it one, or leave it out of '--modes'"),
        );
    }
    let mut seen = HashSet::from([REFERENCE]);
    match titles.iter().find(|title| !seen.insert(title)) {
        None => Ok(()),
        Some(twice) => Err(Error::usage(format!(
            "{}: two of what is compared are called '{twice}'",
            of_mode.mode
        ))
        .hint("give each setting a name of its own, and each peer once")),
    }
}
