//! One value per ray: maximum, minimum, mean, first local maximum, exact for the trilinear field.

use crate::scene::Projection;
use crate::volume::Voxel;

use super::cells::Walk;
use super::field::{Field, bounds};
use super::interval::Interval;

/// A projected value.
#[derive(Debug, Clone, Copy)]
pub struct Projected {
    /// The projected value, without the calibration's intercept.
    pub value: f64,
    /// Where it is first reached, from the interval's start; +∞ for the mean.
    pub at_mm: f64,
    /// The number of boxes walked.
    pub walked: u32,
}

/// The value of the interval under `projection`. `noise` is the rounding error of Φ: differences
/// up to it do not count as rising or falling, so that a plateau is reached where it begins.
pub fn project<T: Voxel>(
    field: &Field<T>,
    interval: &Interval,
    projection: Projection,
    noise: f64,
) -> Projected {
    match projection {
        Projection::Maximum => extremum(field, interval, 1.0, noise),
        Projection::Minimum => extremum(field, interval, -1.0, noise),
        Projection::Mean => mean(field, interval),
        Projection::LocalMaximum { threshold } => local_maximum(field, interval, threshold, noise),
    }
}

/// The maximum of `sign`·Φ.
fn extremum<T: Voxel>(field: &Field<T>, interval: &Interval, sign: f64, noise: f64) -> Projected {
    let (mut best, mut walked) = (f64::NEG_INFINITY, 0);
    // The value where `at_mm` is: within the noise of the best.
    let (mut reached, mut at_mm) = (f64::NEG_INFINITY, 0.0);
    for segment in Walk::new(field.lattice, interval) {
        walked += 1;
        let corners = field.corners(segment.cell);
        let (low, high) = bounds(&corners);
        if (sign * low).max(sign * high) <= best {
            continue;
        }
        let phi = Field::<T>::along(&corners, &segment);
        for s in phi.monotone_ends() {
            let value = sign * phi.at(s);
            best = best.max(value);
            if value > reached + noise {
                (reached, at_mm) = (value, segment.at_mm(s));
            }
        }
    }
    Projected {
        value: sign * best,
        at_mm,
        walked,
    }
}

fn mean<T: Voxel>(field: &Field<T>, interval: &Interval) -> Projected {
    let (mut integral, mut first, mut walked) = (0.0, 0.0, 0);
    for segment in Walk::new(field.lattice, interval) {
        let phi = Field::<T>::along(&field.corners(segment.cell), &segment);
        if walked == 0 {
            first = phi.at(0.0);
        }
        walked += 1;
        integral += phi.mean() * segment.length_mm();
    }
    let value = if interval.length_mm > 0.0 {
        integral / interval.length_mm
    } else {
        first
    };
    Projected {
        value,
        at_mm: f64::INFINITY,
        walked,
    }
}

/// The first local maximum ≥ `threshold`, else the maximum (Sato et al. 1998). The interval's ends
/// are local maxima where Φ falls away from them; a plateau counts from its start.
fn local_maximum<T: Voxel>(
    field: &Field<T>,
    interval: &Interval,
    threshold: f64,
    noise: f64,
) -> Projected {
    let mut walked = 0;
    let (mut best, mut best_mm) = (f64::NEG_INFINITY, 0.0);
    // While Φ rises: the highest point of the rise. While it falls: the lowest of the fall.
    let (mut rising, mut turn, mut turn_mm) = (true, f64::NEG_INFINITY, 0.0);
    for segment in Walk::new(field.lattice, interval) {
        walked += 1;
        let phi = Field::<T>::along(&field.corners(segment.cell), &segment);
        for s in phi.monotone_ends() {
            let (value, at_mm) = (phi.at(s), segment.at_mm(s));
            if value > best + noise {
                (best, best_mm) = (value, at_mm);
            }
            if rising && value < turn - noise {
                if turn >= threshold {
                    return Projected {
                        value: turn,
                        at_mm: turn_mm,
                        walked,
                    };
                }
                (rising, turn) = (false, value);
            } else if value > turn + noise {
                (rising, turn, turn_mm) = (true, value, at_mm);
            } else if !rising {
                turn = turn.min(value);
            }
        }
    }
    let (value, at_mm) = if rising && turn >= threshold {
        (turn, turn_mm)
    } else {
        (best, best_mm)
    };
    Projected {
        value,
        at_mm,
        walked,
    }
}
