//! How near to the truth bounded occlusion is.

use serde::Serialize;

use crate::frame::{Frame, KIND, Kind, OCCLUSION_BOUND};
use crate::scene::OcclusionError;

/// How far from the truth the occlusion of a picture's hits may be, where that is bounded.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BoundReached {
    /// What was asked for.
    pub asked: f64,
    /// The mean over the hits; 0 where there is none.
    pub mean: f64,
    /// The most.
    pub max: f64,
    /// The hits.
    pub hits: u64,
    /// The hits whose occlusion may be farther from the truth than was asked for.
    pub beyond: u64,
}

impl BoundReached {
    /// What was reached in a frame; `None`: it has no kinds or no such layer.
    pub fn of(frame: &Frame, asked: OcclusionError) -> Option<Self> {
        /// What single precision makes of a bound that was reached.
        const ROUNDING: f64 = 1e-5;
        let pairs = frame.plane(KIND)?.iter().zip(frame.plane(OCCLUSION_BOUND)?);
        let bounds: Vec<f64> = pairs
            .filter(|&(&kind, _)| kind == Kind::Surface as u32)
            .map(|(_, &bound)| f64::from(bound))
            .collect();
        let sum: f64 = bounds.iter().sum();
        let beyond = |bound: &&f64| **bound > asked.get() + ROUNDING;
        Some(Self {
            asked: asked.get(),
            mean: sum / bounds.len().max(1) as f64,
            max: bounds.iter().copied().fold(0.0, f64::max),
            hits: bounds.len() as u64,
            beyond: bounds.iter().filter(beyond).count() as u64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::ImageSize;
    use crate::frame::Wanted;

    #[test]
    fn what_is_hit_counts_and_what_is_farther() {
        let size = ImageSize::new(4, 1).unwrap();
        let mut frame = Frame::blank(size, Wanted::ALL).unwrap();
        let (surface, cap) = (Kind::Surface as u32, Kind::Cap as u32);
        let kinds = [surface, cap, Kind::Nothing as u32, surface];
        frame.plane_mut(KIND).unwrap().copy_from_slice(&kinds);
        let bounds = [0.05, 0.5, 0.5, 0.15];
        let plane = frame.plane_mut(OCCLUSION_BOUND).unwrap();
        plane.copy_from_slice(&bounds);
        let of = |asked| BoundReached::of(&frame, OcclusionError::new(asked).unwrap()).unwrap();
        let found = of(0.05);
        assert!((found.mean - 0.1).abs() < 1e-6 && (found.max - 0.15).abs() < 1e-6);
        assert_eq!((found.hits, found.beyond), (2, 1));
        assert_eq!(of(0.2).beyond, 0);
        frame.layers.take(OCCLUSION_BOUND);
        assert_eq!(
            BoundReached::of(&frame, OcclusionError::new(0.1).unwrap()),
            None
        );
    }
}
