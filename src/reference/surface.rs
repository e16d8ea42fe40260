//! The isosurface: where Φ ≥ iso first changes along a ray.

use crate::frame::Kind;
use crate::scene::Gradient;
use crate::volume::Voxel;

use super::cells::Walk;
use super::field::{Field, bounds};
use super::interval::{Entry, Interval};

/// A point of the isosurface, or of a cap.
#[derive(Debug, Clone, Copy)]
pub struct Crossing {
    /// Distance from the interval's start, mm.
    pub at_mm: f64,
    /// Φ there; with the nearest filter, of the box behind the face.
    pub value: f64,
    /// ∇Φ in index space; 0 on a cap.
    pub gradient: [f64; 3],
    /// The box in which it lies.
    pub cell: [usize; 3],
    /// The face or plane that a cap closes, whose normal it has.
    pub cap: Option<Entry>,
    /// Whether Φ ≥ iso behind it.
    pub inside: bool,
}

impl Crossing {
    /// The kind of the hit: a surface or a cap.
    pub fn kind(&self) -> Kind {
        if self.cap.is_some() {
            Kind::Cap
        } else {
            Kind::Surface
        }
    }
}

/// The first change of "Φ ≥ iso" on the interval, and the number of boxes walked. With `caps`, a
/// ray that enters through a face or a clip plane where Φ ≥ iso hits there.
///
/// A field that touches the iso value from below in one point is hit where the polynomial's
/// turning point, as computed, reaches iso.
pub fn first_crossing<T: Voxel>(
    field: &Field<T>,
    interval: &Interval,
    iso: f64,
    caps: bool,
    gradient: Gradient,
) -> (Option<Crossing>, u32) {
    let mut walked = 0;
    let mut inside = None;
    for segment in Walk::new(field.lattice, interval) {
        walked += 1;
        // Less the iso value: on which side a corner lies is exact, and where all lie on one side no
        // rounding makes a crossing.
        let corners = field.corners(segment.cell).map(|value| value - iso);
        let (low, high) = bounds(&corners);
        if inside == Some(false) && high < 0.0 || inside == Some(true) && low >= 0.0 {
            continue;
        }
        let above = Field::<T>::along(&corners, &segment);
        let start_in = above.at(0.0) >= 0.0;
        let inside = *inside.get_or_insert(start_in);
        let value = |s: f64| Field::<T>::along(&field.corners(segment.cell), &segment).at(s);
        let crossing = |s: f64| Crossing {
            at_mm: segment.at_mm(s),
            value: value(s),
            gradient: field
                .gradient(&segment, gradient)
                .map(|component| component.at(s)),
            cell: segment.cell,
            cap: None,
            inside: !inside,
        };
        if walked == 1 && inside && caps && interval.entry.is_some() {
            let cap = Crossing {
                at_mm: 0.0,
                value: value(0.0),
                gradient: [0.0; 3],
                cell: segment.cell,
                cap: interval.entry,
                inside,
            };
            return (Some(cap), walked);
        }
        // A face of the nearest filter; or a level within the last bit of Φ at a cell face.
        if start_in != inside {
            return (Some(crossing(0.0)), walked);
        }
        let ends = above.monotone_ends();
        for ends in ends.windows(2) {
            if (above.at(ends[1]) >= 0.0) != inside {
                let s = above.crossing(0.0, ends[0], ends[1]);
                return (Some(crossing(s)), walked);
            }
        }
    }
    (None, walked)
}

/// Where "Φ ≥ iso" changes first on an interval that begins where it is `inside`: mm from its start.
pub fn next_change<T: Voxel>(
    field: &Field<T>,
    interval: &Interval,
    iso: f64,
    inside: bool,
) -> Option<f64> {
    Walk::new(field.lattice, interval).find_map(|segment| {
        let corners = field.corners(segment.cell).map(|value| value - iso);
        let (low, high) = bounds(&corners);
        if inside && low >= 0.0 || !inside && high < 0.0 {
            return None;
        }
        let above = Field::<T>::along(&corners, &segment);
        let ends = above.monotone_ends();
        let changed = ends.iter().position(|&s| (above.at(s) >= 0.0) != inside)?;
        let s = match changed {
            0 => 0.0,
            n => above.crossing(0.0, ends[n - 1], ends[n]),
        };
        Some(segment.at_mm(s))
    })
}
