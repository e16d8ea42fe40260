//! The times of the candidates of a mode.

use crate::error::{Error, Result};
use crate::lab::measure::{FrameTime, Peer, PeerScene, rounds, time};
use crate::progress::Stage;
use crate::render::Renderer;

use super::Comparison;
use super::candidate::Candidate;
use super::mode::ModeSettings;
use super::row::Row;

impl Comparison<'_> {
    /// Times all that have a picture, in turn.
    pub(super) fn time(
        &self,
        of_mode: &ModeSettings,
        candidates: &[Candidate],
        rows: &mut [Row],
        renderer: &mut Renderer,
        peers: &mut [Peer],
    ) -> Result<()> {
        let sound: Vec<usize> = (0..rows.len())
            .filter(|&at| rows[at].failure.is_none())
            .collect();
        let frames = sound.len() * (self.repeats + 1);
        let name = format!("{}: timing", of_mode.name());
        let stage = Stage::begin(self.progress, &name, frames as u64);
        // One that fails now keeps its picture and says so.
        let times = rounds(&sound, self.repeats, |&at| {
            stage.advance(1);
            Ok(match &candidates[at] {
                Candidate::Setting(at) => time(renderer, &of_mode.settings[*at].1.scene),
                Candidate::Peer { peer, scene, .. } => match scene {
                    Some(scene) => peer_time(&mut peers[*peer], scene),
                    None => Err(Error::failed("it has no scene ready")),
                },
            })
        });
        drop(stage);
        for (&at, times) in sound.iter().zip(times?) {
            match times.into_iter().collect::<Result<Vec<FrameTime>>>() {
                Ok(times) => rows[at].timed(&times),
                Err(error) => rows[at].fail(&error),
            }
        }
        Ok(())
    }
}

fn peer_time(peer: &mut Peer, scene: &PeerScene) -> Result<FrameTime> {
    let time = peer.time(scene)?;
    Ok(FrameTime {
        frame_ms: time.ms,
        processor_ms: time.cpu_ms,
        render_ms: time.ms,
        passes: Vec::new(),
    })
}
