//! How far one pixel is off, in the sense of a metric.

use crate::error::{Error, Result};
use crate::frame::{DEPTH, Frame, Layer, VALUE, Wanted, percentile};
use crate::options::{ErrorBound, ErrorMetric};
use crate::reference::{RayResult, display};
use crate::scene::Tone;
use crate::volume::Volume;

/// The contents of a pixel, as far as a metric uses them; narrowed to the planes' single precision, as
/// pictures are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// The displayed colour, 0..1.
    rgb: [f32; 3],
    /// The depth, mm; +∞: no hit.
    depth: f32,
    /// The value, physical.
    value: f32,
    /// Whether the pixel shows anything.
    covered: bool,
}

impl Seen {
    pub fn by_reference(result: &RayResult, tone: &Tone) -> Self {
        let [r, g, b, _] = display(result.color, tone).map(|c| c as f32);
        Self {
            rgb: [r, g, b],
            depth: result.depth_mm as f32,
            value: result.value as f32,
            covered: result.color[3] as f32 > 0.0,
        }
    }

    /// A pixel of a frame; a plane that was not wanted shows nothing.
    pub fn in_frame(frame: &Frame, pixel: usize) -> Self {
        let [r, g, b, _] = frame
            .display
            .as_ref()
            .map_or([0.0; 4], |plane| plane[pixel]);
        Self {
            rgb: [r, g, b],
            depth: (frame.plane(DEPTH)).map_or(f32::INFINITY, |plane| plane[pixel]),
            value: frame.plane(VALUE).map_or(0.0, |plane| plane[pixel]),
            covered: frame.color[pixel][3] > 0.0,
        }
    }

    pub fn is_hit(&self) -> bool {
        self.depth.is_finite()
    }
}

/// The figure that a metric computes from all pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    /// The root of the mean.
    RootMean,
    /// The greatest.
    Greatest,
    /// The 99th percentile.
    Percentile99,
    /// The number of pixels that are off over the number of hits.
    ShareOfHits,
}

/// A metric in the units of one volume, its bound as what an error must not exceed.
#[derive(Debug, Clone, Copy)]
pub struct Deviation {
    metric: ErrorMetric,
    /// The limit on the figure; for psnr, the limit on the rmse.
    limit: f64,
    /// The unit of the metric: for depth the smallest spacing, mm; for value the value range; else 1.
    unit: f64,
}

impl Deviation {
    /// Prepares the metric of a bound for a volume.
    ///
    /// # Errors
    /// All voxels are equal, so that no value can be a share of their range.
    pub fn new(bound: ErrorBound, volume: &Volume) -> Result<Self> {
        let metric = bound.metric();
        let unit = match metric {
            ErrorMetric::Depth => volume.geometry().smallest_spacing_mm(),
            ErrorMetric::Value => volume.range().width(),
            _ => 1.0,
        };
        if !(unit > 0.0 && unit.is_finite()) {
            return Err(Error::failed(
                "all voxels are equal: no error can be given as a share of their range",
            )
            .hint("bound an error other than value"));
        }
        let limit = match metric {
            ErrorMetric::Psnr => 10_f64.powf(-bound.bound() / 20.0),
            _ => bound.bound(),
        };
        Ok(Self {
            metric,
            limit,
            unit,
        })
    }

    /// The limit of the figure.
    pub fn limit(&self) -> f64 {
        self.limit
    }

    pub fn figure(&self) -> Figure {
        match self.metric {
            ErrorMetric::Rmse | ErrorMetric::Psnr => Figure::RootMean,
            ErrorMetric::P99 => Figure::Percentile99,
            ErrorMetric::Missed => Figure::ShareOfHits,
            ErrorMetric::Max | ErrorMetric::Depth | ErrorMetric::Value => Figure::Greatest,
        }
    }

    /// A figure as the user reads it: of psnr in dB.
    pub fn shown(&self, figure: f64) -> f64 {
        match self.metric {
            ErrorMetric::Psnr => -20.0 * figure.log10(),
            _ => figure,
        }
    }

    /// The planes that the metric uses.
    pub fn wanted(&self) -> Wanted {
        match self.metric {
            ErrorMetric::Rmse | ErrorMetric::Max | ErrorMetric::P99 | ErrorMetric::Psnr => {
                Wanted::DISPLAY
            }
            ErrorMetric::Depth | ErrorMetric::Missed => Wanted::NONE.with([Layer::Depth]),
            ErrorMetric::Value => Wanted::NONE.with([Layer::Value]),
        }
    }

    /// The differences of a pixel's channels; of all metrics but colours' one and twice nothing.
    pub fn channels(&self, reference: &Seen, other: &Seen) -> [f64; 3] {
        let difference = |a: f32, b: f32| (f64::from(a) - f64::from(b)).abs();
        let one = |off: f64| [off, 0.0, 0.0];
        match self.metric {
            ErrorMetric::Rmse | ErrorMetric::Max | ErrorMetric::P99 | ErrorMetric::Psnr => {
                [0, 1, 2].map(|c| difference(reference.rgb[c], other.rgb[c]))
            }
            ErrorMetric::Depth => one(match (reference.is_hit(), other.is_hit()) {
                (true, true) => difference(reference.depth, other.depth) / self.unit,
                (false, false) => 0.0,
                _ => f64::INFINITY,
            }),
            ErrorMetric::Missed => one(f64::from(reference.is_hit() != other.is_hit())),
            ErrorMetric::Value => one(match (reference.covered, other.covered) {
                (true, true) => difference(reference.value, other.value) / self.unit,
                (false, false) => 0.0,
                _ => f64::INFINITY,
            }),
        }
    }

    /// A pixel's part of the figure: of a root mean the mean square, of a percentile the share of
    /// channels beyond the limit, else the greatest difference.
    pub fn part(&self, reference: &Seen, other: &Seen) -> f64 {
        let channels = self.channels(reference, other);
        match self.figure() {
            Figure::RootMean => channels.iter().map(|c| c * c).sum::<f64>() / 3.0,
            Figure::Percentile99 => {
                channels.iter().filter(|&&c| c > self.limit).count() as f64 / 3.0
            }
            Figure::Greatest | Figure::ShareOfHits => channels.iter().copied().fold(0.0, f64::max),
        }
    }

    /// The figure of a picture against another of the same size.
    pub fn between(&self, reference: &Frame, other: &Frame) -> f64 {
        let pixels = reference.size.pixels();
        let seen = (0..pixels).map(|at| (Seen::in_frame(reference, at), Seen::in_frame(other, at)));
        match self.figure() {
            Figure::RootMean => {
                let sum: f64 = seen.map(|(a, b)| self.part(&a, &b)).sum();
                (sum / pixels as f64).sqrt()
            }
            Figure::Greatest => seen.map(|(a, b)| self.part(&a, &b)).fold(0.0, f64::max),
            Figure::Percentile99 => {
                let mut all: Vec<f64> = seen.flat_map(|(a, b)| self.channels(&a, &b)).collect();
                percentile(&mut all, 99).unwrap_or(0.0)
            }
            Figure::ShareOfHits => {
                let (mut off, mut hits) = (0.0, 0.0);
                for (a, b) in seen {
                    off += self.part(&a, &b);
                    hits += f64::from(a.is_hit());
                }
                if off == 0.0 { 0.0 } else { off / hits }
            }
        }
    }
}
