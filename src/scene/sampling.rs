//! How a ray is followed on the device. The reference has no use for it but for the filter.

use std::str::FromStr;

use super::{DofMethod, Jitter, StepVoxels};
use crate::error::{Error, Result};

/// Reconstruction of Φ between voxel centres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Filter {
    /// The value of the nearest voxel centre; half-way goes to the higher index.
    Nearest,
    /// Trilinear between the 8 voxel centres of a cell.
    #[default]
    Linear,
}

/// Where on a ray that looks for a surface at fixed steps the filter's value is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Reconstruction {
    /// At every sample.
    #[default]
    Full,
    /// At the hit alone: samples are the nearest voxels' values, and where two of them lie on two sides of the iso
    /// value the crossing near them is found by the filter (a cheaper filter where accuracy is not needed:
    /// Lesar et al. 2015, §IV).
    Adaptive,
}

/// How nodes that cannot contribute are skipped. All give the same picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Traverse {
    /// One finest node after the other, without a hierarchy.
    Uniform,
    /// A descent from the root after every node (stackless; Lesar et al. 2015).
    KdRestart,
    /// A walk up and down from the present node.
    Hierarchical,
    /// Top down, each node on the way once, its children in the order of the ray (Revelles et al.
    /// 2000, in integers, so that rounding cannot change the order).
    Revelles,
    /// A distance map without a hierarchy: every finest node knows how far around it is nothing else
    /// (Chebyshev distances; Deakin and Knackstedt 2019).
    Distance,
}

impl Traverse {
    /// All traversals.
    pub const ALL: [Self; 5] = [
        Self::Uniform,
        Self::KdRestart,
        Self::Hierarchical,
        Self::Revelles,
        Self::Distance,
    ];
}

/// How a device holds the voxels and reads them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Storage {
    /// The voxels are in a buffer.
    #[default]
    Buffer,
    /// The voxels are in an image and read one by one; the same picture as from a buffer.
    Image,
    /// The voxels are in an image whose own linear filter gives the field's samples. GPUs filter with
    /// weights of eight bits (CUDA C++ Programming Guide, Texture Fetching, Linear Filtering).
    Filtered,
}

impl Storage {
    /// All storages.
    pub const ALL: [Self; 3] = [Self::Buffer, Self::Image, Self::Filtered];

    /// Checks that rays can be followed by this traversal.
    ///
    /// # Errors
    /// Usage: the device is to filter where cells are solved from their voxels, or where nothing is
    /// filtered.
    pub fn check(self, method: SamplingMethod, filter: Filter) -> Result<()> {
        if self != Self::Filtered {
            return Ok(());
        }
        if method == SamplingMethod::Exact {
            return Err(Error::usage(
                "'voxels' = filtered cannot be combined with exact sampling, which solves the field from the voxels themselves",
            )
            .hint("use --sampling fixed, or in dvr a --quad of fixed steps; or --voxels image"));
        }
        if filter == Filter::Nearest {
            return Err(Error::usage(
                "'voxels' = filtered cannot be combined with 'filter' = nearest, which takes voxels as they are",
            )
            .hint("leave one of the two out, or use --voxels image"));
        }
        Ok(())
    }
}

/// Where on a ray the field is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SamplingMethod {
    /// The field is sampled at fixed steps.
    Fixed,
    /// Everywhere: in every cell that matters, the field's cubic along the ray is solved.
    #[default]
    Exact,
}

/// How the root between two samples is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RefineMethod {
    /// The sample behind the crossing.
    None,
    /// Bisection: the bracket is halved in every iteration.
    Bisection,
    /// Guarded: an iteration that does not halve the bracket is followed by a bisection.
    RegulaFalsi,
    /// The Illinois method (Dowell and Jarratt 1971).
    Illinois,
    /// Newton's method.
    Newton,
}

/// A refiner and its number of iterations: `METHOD[:N]`, N from 1 to 32.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refine {
    method: RefineMethod,
    iterations: u32,
}

impl Refine {
    /// The most iterations.
    pub const MAX_ITERATIONS: u32 = 32;

    /// Constructs a refiner of so many iterations, from 1 to [`Self::MAX_ITERATIONS`]; `RefineMethod::None`
    /// has 0.
    ///
    /// # Errors
    /// Usage: another number of iterations.
    pub fn new(method: RefineMethod, iterations: u32) -> Result<Self> {
        let allowed = match method {
            RefineMethod::None => 0..=0,
            _ => 1..=Self::MAX_ITERATIONS,
        };
        if allowed.contains(&iterations) {
            return Ok(Self { method, iterations });
        }
        Err(Error::usage(format!(
            "{iterations} iterations of the refiner {method}: there must be {} to {}",
            allowed.start(),
            allowed.end()
        )))
    }

    /// Returns how the root between two samples is found.
    pub const fn method(self) -> RefineMethod {
        self.method
    }

    /// Returns the number of iterations, 0 where nothing is refined.
    pub const fn iterations(self) -> u32 {
        self.iterations
    }
}

impl Default for Refine {
    fn default() -> Self {
        Self {
            method: RefineMethod::RegulaFalsi,
            iterations: 5,
        }
    }
}

impl FromStr for Refine {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "'{text}' is not a refiner: :N gives 1 to {} iterations; 'none' takes no :N",
                Self::MAX_ITERATIONS
            ))
        };
        let (name, count) = match text.split_once(':') {
            Some((name, count)) => (name, Some(count)),
            None => (text, None),
        };
        let method = name.parse()?;
        let iterations = match (method, count) {
            (RefineMethod::None, Some(_)) => return Err(wrong()),
            (RefineMethod::None, None) => 0,
            // Scharsach 2005, §4: six half-steps.
            (RefineMethod::Bisection, None) => 6,
            (_, None) => Self::default().iterations,
            (_, Some(count)) => count.parse().map_err(|_| wrong())?,
        };
        Self::new(method, iterations).map_err(|_| wrong())
    }
}

impl std::fmt::Display for Refine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.method {
            RefineMethod::None => self.method.fmt(f),
            method => write!(f, "{method}:{}", self.iterations),
        }
    }
}

/// How a ray is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// How surfaces and projections are sampled.
    pub method: SamplingMethod,
    /// Distance of samples where they are at fixed steps.
    pub step: StepVoxels,
    /// How the samples of each ray are shifted where they are at fixed steps.
    pub jitter: Jitter,
    /// The reconstruction filter.
    pub filter: Filter,
    /// Where it is applied; surfaces at fixed steps alone make use of it, and without a probe.
    pub recon: Reconstruction,
    /// How nodes that cannot contribute are skipped.
    pub traverse: Traverse,
    /// Whether nodes that cannot contribute are skipped; never changes the picture.
    pub skip: bool,
    /// Whether surfaces and extrema are also looked for between two samples where the field's
    /// slopes along the ray point at a peak; without it a fixed step is all there is.
    pub probe: bool,
    /// How the device holds and reads the voxels.
    pub voxels: Storage,
    /// How depth of field is made.
    pub dof: DofMethod,
}

impl Default for Sampling {
    fn default() -> Self {
        Self {
            method: SamplingMethod::default(),
            step: StepVoxels::default(),
            jitter: Jitter::default(),
            filter: Filter::Linear,
            recon: Reconstruction::default(),
            traverse: Traverse::Distance,
            skip: true,
            probe: true,
            voxels: Storage::default(),
            dof: DofMethod::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_linear_samples_at_fixed_steps_are_filtered_by_the_device() {
        for method in [SamplingMethod::Fixed, SamplingMethod::Exact] {
            for filter in [Filter::Linear, Filter::Nearest] {
                let filtered = method == SamplingMethod::Fixed && filter == Filter::Linear;
                for storage in Storage::ALL {
                    let allowed = filtered || storage != Storage::Filtered;
                    assert_eq!(storage.check(method, filter).is_ok(), allowed);
                }
            }
        }
    }

    #[test]
    fn refiners_parse_and_print() {
        for (text, printed) in [
            ("none", "none"),
            ("bisection", "bisection:6"),
            ("regula-falsi", "regula-falsi:5"),
            ("newton:3", "newton:3"),
        ] {
            assert_eq!(text.parse::<Refine>().unwrap().to_string(), printed);
        }
        for bad in ["", "none:2", "newton:0", "newton:33", "newton:x", "secant"] {
            assert!(bad.parse::<Refine>().is_err(), "{bad}");
        }
    }
}
