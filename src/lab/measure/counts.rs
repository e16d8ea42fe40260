//! Counters of a picture: rays, samples, nodes, hits.

use serde::Serialize;

use crate::frame::{Frame, KIND, Key, NODES, STEPS};
use crate::scene::Picture;

/// Counters summed over a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Rays cast.
    pub rays: u64,
    /// Samples taken, or cells visited.
    pub samples: u64,
    /// Hierarchy nodes visited.
    pub nodes: u64,
    /// Pixels that hit something.
    pub hits: u64,
    /// Pixels of which neither a hit nor a miss is proven; where the certificate was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub undecided: Option<u64>,
}

impl Counts {
    /// The counters of a frame that has counters and kinds, for which so many `rays` were cast. In emission a hit is a
    /// pixel with any opacity.
    pub fn of(frame: &Frame, picture: &Picture, rays: u64) -> Self {
        let sum = |key: Key<u32>| {
            let counts = frame.plane(key).into_iter().flatten();
            counts.map(|&n| u64::from(n)).sum()
        };
        let hits = match picture {
            Picture::Emission(_) => frame.color.iter().filter(|c| c[3] > 0.0).count(),
            _ => frame
                .plane(KIND)
                .into_iter()
                .flatten()
                .filter(|&&kind| kind > 0)
                .count(),
        };
        Self {
            rays,
            samples: sum(STEPS),
            nodes: sum(NODES),
            hits: hits as u64,
            undecided: frame.undecided(),
        }
    }

    /// The mean number of samples, or of cells visited, per ray.
    pub fn samples_per_ray(&self) -> f64 {
        self.samples as f64 / self.rays as f64
    }

    /// The mean number of hierarchy nodes visited per ray.
    pub fn nodes_per_ray(&self) -> f64 {
        self.nodes as f64 / self.rays as f64
    }
}

impl std::iter::Sum for Counts {
    /// The sum; of no pictures zero, the certificate not requested.
    fn sum<I: Iterator<Item = Self>>(pictures: I) -> Self {
        let nothing = Self {
            rays: 0,
            samples: 0,
            nodes: 0,
            hits: 0,
            undecided: None,
        };
        pictures.fold(nothing, |sum, one| Self {
            rays: sum.rays + one.rays,
            samples: sum.samples + one.samples,
            nodes: sum.nodes + one.nodes,
            hits: sum.hits + one.hits,
            undecided: match (sum.undecided, one.undecided) {
                (Some(sum), Some(one)) => Some(sum + one),
                (sum, one) => sum.or(one),
            },
        })
    }
}
