//! Walking every cell along a ray, in order, after Amanatides and Woo 1987; each face's crossing is
//! computed from the start, so that no error accumulates.

use crate::extent::Dims;
use crate::scene::Filter;

use super::interval::Interval;

/// The boxes in which Φ is one polynomial: cells between 8 voxel centres for the linear filter,
/// the voxels' own boxes for the nearest one.
#[derive(Debug, Clone, Copy)]
pub struct Lattice {
    /// Boxes along each axis.
    pub count: [usize; 3],
    /// The coordinate of the face between box 0 and box 1.
    first_face: f64,
}

impl Lattice {
    /// Makes the boxes of a volume under a reconstruction filter.
    pub fn new(dims: Dims, filter: Filter) -> Self {
        match filter {
            Filter::Linear => Self {
                count: dims.cells().map(|n| n as usize),
                first_face: 1.0,
            },
            Filter::Nearest => Self {
                count: dims.usize(),
                first_face: 0.5,
            },
        }
    }

    /// The coordinate of the face between box `below` and the next.
    fn face(&self, below: usize) -> f64 {
        below as f64 + self.first_face
    }

    /// The box of a coordinate; on a face, the higher one.
    fn box_at(&self, axis: usize, p: f64) -> usize {
        let index = (p - self.first_face + 1.0).floor().max(0.0);
        (index as usize).min(self.count[axis] - 1)
    }
}

/// The part of a ray inside one box. Its ends are distances from the interval's start; `s` runs
/// from 0 to 1 between them.
#[derive(Debug, Clone, Copy)]
pub struct Segment {
    /// Distance of its start from the interval's start, mm.
    pub from_mm: f64,
    /// Distance of its end from the interval's start, mm.
    pub to_mm: f64,
    /// Index-space position of its start; exact on the face it lies on.
    pub p0: [f64; 3],
    /// Index-space position of its end; exact on the face it lies on.
    pub p1: [f64; 3],
    /// The index of the box along each axis.
    pub cell: [usize; 3],
}

impl Segment {
    /// The length of the segment, mm.
    pub fn length_mm(&self) -> f64 {
        self.to_mm - self.from_mm
    }

    /// The distance from the interval's start at `s`, mm.
    pub fn at_mm(&self, s: f64) -> f64 {
        self.from_mm + self.length_mm() * s
    }
}

/// The segments of an interval, in order: the end of one is the start of the next, bit for bit.
/// An interval without length has one segment without length. At most nx + ny + nz segments.
pub struct Walk {
    lattice: Lattice,
    interval: Interval,
    cell: [usize; 3],
    /// Distance to the next face along each axis; infinite after the last.
    next_mm: [f64; 3],
    at_mm: f64,
    p: [f64; 3],
    done: bool,
}

impl Walk {
    /// Starts a walk through the boxes at the interval's start.
    pub fn new(lattice: Lattice, interval: &Interval) -> Self {
        let mut walk = Self {
            lattice,
            interval: *interval,
            cell: [0; 3],
            next_mm: [f64::INFINITY; 3],
            at_mm: 0.0,
            p: interval.start,
            done: false,
        };
        for axis in 0..3 {
            walk.cell[axis] = lattice.box_at(axis, interval.start[axis]);
            walk.next_mm[axis] = walk.face_ahead(axis).map_or(f64::INFINITY, |(_, mm)| mm);
            walk.pass(axis, 0.0);
        }
        walk
    }

    /// The face ahead along an axis: coordinate and distance.
    fn face_ahead(&self, axis: usize) -> Option<(f64, f64)> {
        let (dir, cell) = (self.interval.dir[axis], self.cell[axis]);
        let below = if dir > 0.0 {
            (cell + 1 < self.lattice.count[axis]).then_some(cell)?
        } else if dir < 0.0 {
            cell.checked_sub(1)?
        } else {
            return None;
        };
        let face = self.lattice.face(below);
        Some((face, (face - self.interval.start[axis]) / dir))
    }

    /// Goes through the axis's faces that lie at `mm` or before; returns the last one's coordinate.
    fn pass(&mut self, axis: usize, mm: f64) -> Option<f64> {
        let mut passed = None;
        while self.next_mm[axis] <= mm {
            passed = self.face_ahead(axis).map(|(face, _)| face);
            if self.interval.dir[axis] > 0.0 {
                self.cell[axis] += 1;
            } else {
                self.cell[axis] -= 1;
            }
            self.next_mm[axis] = self.face_ahead(axis).map_or(f64::INFINITY, |(_, mm)| mm);
        }
        passed
    }
}

impl Iterator for Walk {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        if self.done {
            return None;
        }
        let end_mm = self.interval.length_mm;
        let to_mm = self.next_mm.iter().copied().fold(end_mm, f64::min);
        let mut segment = Segment {
            from_mm: self.at_mm,
            to_mm,
            p0: self.p,
            p1: self.p,
            cell: self.cell,
        };
        for axis in 0..3 {
            let face = self.pass(axis, to_mm);
            let free = self.interval.start[axis] + self.interval.dir[axis] * to_mm;
            segment.p1[axis] = face.unwrap_or(free);
        }
        self.at_mm = to_mm;
        self.p = segment.p1;
        self.done = to_mm >= end_mm;
        Some(segment)
    }
}

#[cfg(test)]
mod tests {
    use super::super::interval::IndexRay;
    use super::*;

    /// Counts faults of a walk: it must tile the interval, and each segment's middle must lie in its own
    /// box.
    fn faults(dims: Dims, walk: Filter, lattice_filter: Filter, interval: &Interval) -> usize {
        let segments: Vec<Segment> = Walk::new(Lattice::new(dims, walk), interval).collect();
        let lattice = Lattice::new(dims, lattice_filter);
        let mut faults = 0;
        let mut at_mm = 0.0;
        for s in &segments {
            faults += usize::from(s.from_mm != at_mm || s.to_mm < s.from_mm);
            at_mm = s.to_mm;
            for axis in 0..3 {
                if dims.usize()[axis] > 1 {
                    let middle = (s.p0[axis] + s.p1[axis]) / 2.0;
                    let low = s.cell[axis] as f64 - (1.0 - lattice.first_face);
                    let inside = middle >= low - 1e-12 && middle <= low + 1.0 + 1e-12;
                    faults += usize::from(!inside || s.cell[axis] >= lattice.count[axis]);
                }
            }
        }
        faults + usize::from(at_mm != interval.length_mm)
    }

    #[test]
    fn segments_tile_the_interval_in_their_own_cells() {
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut hits, mut caught) = (0, 0);
        for case in 0..6000 {
            let dims = Dims::new([[7, 5, 9], [1, 6, 4], [2, 2, 2], [1, 1, 1]][case % 4]).unwrap();
            let filter = [Filter::Linear, Filter::Nearest][case / 4 % 2];
            let mut origin = [0.0; 3].map(|_: f64| random() * 12.0 - 4.0);
            let mut dir = [0.0; 3].map(|_: f64| random() - 0.5);
            for axis in 0..3 {
                if random() < 0.3 {
                    dir[axis] = [0.0, -0.0, 5e-324, -1e-310][(random() * 4.0) as usize];
                }
                if random() < 0.5 {
                    origin[axis] = (origin[axis] * 2.0).round() / 2.0;
                }
                if random() < 0.2 {
                    dir[axis] = if dir[axis] < 0.0 { -0.25 } else { 0.25 };
                }
            }
            let Some(interval) = Interval::new(&IndexRay { origin, dir }, dims) else {
                continue;
            };
            hits += 1;
            let found = faults(dims, filter, filter, &interval);
            assert_eq!(found, 0, "{origin:?} {dir:?}");
            // The other filter's boxes are not these.
            let other = [Filter::Nearest, Filter::Linear][case / 4 % 2];
            caught += usize::from(faults(dims, filter, other, &interval) > 0);
        }
        assert!(hits > 300 && caught > 100, "{hits} met, {caught} caught");
    }

    #[test]
    fn the_diagonal_passes_through_corners_without_empty_segments() {
        let dims = Dims::new([5, 5, 5]).unwrap();
        for (origin, step) in [([-1.0; 3], 1.0), ([5.0; 3], -1.0)] {
            let ray = IndexRay {
                origin,
                dir: [step; 3],
            };
            let interval = Interval::new(&ray, dims).unwrap();
            let walk = Walk::new(Lattice::new(dims, Filter::Linear), &interval);
            let cells: Vec<[usize; 3]> = walk.map(|s| s.cell).collect();
            let mut expected: Vec<_> = (0..4).map(|i| [i; 3]).collect();
            if step < 0.0 {
                expected.reverse();
            }
            assert_eq!(cells, expected);
        }
    }
}
