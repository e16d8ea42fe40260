//! Who takes part in a comparison.

use std::collections::HashSet;

use crate::error::{Error, Result};
use crate::lab::measure::{Peer, PeerScene};
use crate::options::Resolved;

use super::mode::ModeSettings;
use super::row::Row;

/// The title of the picture that the others are compared with.
pub const REFERENCE: &str = "reference";

/// One of the pictures that are compared.
pub enum Candidate {
    /// This renderer, in a setting by its index among the mode's.
    Setting(usize),
    /// Another renderer, by its index among the peers, in one of its own settings.
    Peer {
        peer: usize,
        setting: String,
        /// The peer's prepared scene, once its picture was requested.
        scene: Option<PeerScene>,
    },
}

impl Candidate {
    /// The scene as this candidate renders it: a peer follows rays by methods of its own.
    pub fn scene<'a>(&self, of_mode: &'a ModeSettings) -> &'a Resolved {
        match self {
            Self::Setting(at) => &of_mode.settings[*at].1,
            Self::Peer { .. } => &of_mode.resolved,
        }
    }
}

/// The settings of a mode, then those that the peers have for it.
pub fn candidates(of_mode: &ModeSettings, peers: &[Peer]) -> Vec<Candidate> {
    let settings = (0..of_mode.settings.len()).map(Candidate::Setting);
    let others = peers.iter().enumerate().flat_map(|(peer, one)| {
        let settings = one.settings(&of_mode.mode.to_string()).into_iter();
        settings.map(move |setting| Candidate::Peer {
            peer,
            setting,
            scene: None,
        })
    });
    settings.chain(others).collect()
}

/// The name of a peer in rows.
pub fn renderer_name(peer: &Peer) -> String {
    format!("{} {}", peer.name(), peer.version())
}

/// Checks that a mode has candidates, each with a name of its own.
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
            Error::usage(format!("there is no setting for mode '{}'", of_mode.name()))
                .hint("give it one, or leave it out of '--modes'"),
        );
    }
    let mut seen = HashSet::from([REFERENCE]);
    match titles.iter().find(|title| !seen.insert(title)) {
        None => Ok(()),
        Some(twice) => Err(Error::usage(format!(
            "{}: two of what is compared are called '{twice}'",
            of_mode.name()
        ))
        .hint("give each setting a name of its own, and each peer once")),
    }
}
