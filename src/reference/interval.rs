//! The part of a ray inside the volume, in front of the eye.

use crate::extent::Dims;

/// A ray in index space: `p_index = origin + dir · t`, t in mm from the eye.
#[derive(Debug, Clone, Copy)]
pub struct IndexRay {
    /// The eye, in voxels.
    pub origin: [f64; 3],
    /// The direction, in voxels per mm.
    pub dir: [f64; 3],
}

/// A face of the volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Face {
    /// The axis to which the face is orthogonal: 0, 1 or 2.
    pub axis: usize,
    /// Whether it is the face at the axis's low end.
    pub low: bool,
}

/// The face or plane through which a ray enters its interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Entry {
    /// One of the volume's own faces.
    Face(Face),
    /// The number of the scene's clip plane.
    Plane(usize),
}

/// The ray's interval, measured from where it starts: a far eye costs no digits inside.
#[derive(Debug, Clone, Copy)]
pub struct Interval {
    /// Distance from the eye to the interval's start, mm.
    pub enter_mm: f64,
    /// The length of the interval, mm.
    pub length_mm: f64,
    /// Index-space position of the start, within the domain.
    pub start: [f64; 3],
    /// The direction, in voxels per mm.
    pub dir: [f64; 3],
    /// `None` when the ray starts inside (or on the surface).
    pub entry: Option<Entry>,
}

impl Interval {
    /// The ray's intersection with the closed domain by the slab method (Kay and Kajiya 1986), at
    /// t ≥ 0. A ray that lies in a face is inside; where the ray enters through an edge or a
    /// corner, the lowest axis names the face.
    pub fn new(ray: &IndexRay, dims: Dims) -> Option<Self> {
        if !ray.origin.iter().chain(&ray.dir).all(|c| c.is_finite()) {
            return None;
        }
        let domain = dims.domain();
        let (mut enter_mm, mut leave_mm, mut face) = (0.0_f64, f64::INFINITY, None);
        for (axis, &(low, high)) in domain.iter().enumerate() {
            let (origin, dir) = (ray.origin[axis], ray.dir[axis]);
            if dir == 0.0 {
                if origin < low || origin > high {
                    return None;
                }
                continue;
            }
            let (near, far) = if dir > 0.0 { (low, high) } else { (high, low) };
            let near_mm = (near - origin) / dir;
            if near_mm > enter_mm {
                enter_mm = near_mm;
                face = Some(Face {
                    axis,
                    low: dir > 0.0,
                });
            }
            leave_mm = leave_mm.min((far - origin) / dir);
        }
        if enter_mm > leave_mm || !leave_mm.is_finite() {
            return None;
        }
        let mut start = [0.0; 3];
        for axis in 0..3 {
            let (low, high) = domain[axis];
            start[axis] = match face {
                Some(face) if face.axis == axis => {
                    if face.low {
                        low
                    } else {
                        high
                    }
                }
                _ => (ray.origin[axis] + ray.dir[axis] * enter_mm).clamp(low, high),
            };
        }
        let mut length_mm = f64::INFINITY;
        for axis in 0..3 {
            let (low, high) = domain[axis];
            if ray.dir[axis] != 0.0 {
                let far = if ray.dir[axis] > 0.0 { high } else { low };
                length_mm = length_mm.min((far - start[axis]) / ray.dir[axis]);
            }
        }
        Some(Self {
            enter_mm,
            length_mm,
            start,
            dir: ray.dir,
            entry: face.map(Entry::Face),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interval(origin: [f64; 3], dir: [f64; 3]) -> Option<Interval> {
        Interval::new(&IndexRay { origin, dir }, Dims::new([5, 9, 3]).unwrap())
    }

    #[test]
    fn rays_enter_and_leave_through_faces() {
        let i = interval([-2.0, 4.0, 1.0], [0.5, 0.0, -0.0]).unwrap();
        assert_eq!((i.enter_mm, i.length_mm), (4.0, 8.0));
        let low_x = Face { axis: 0, low: true };
        assert_eq!(i.entry, Some(Entry::Face(low_x)));
        let i = interval([1.0, 4.0, 1.0], [0.0, 0.0, -1.0]).unwrap();
        assert_eq!((i.enter_mm, i.length_mm, i.entry), (0.0, 1.0, None));
        assert!(interval([-2.0, 4.0, 1.0], [-0.5, 0.0, 0.0]).is_none());
        assert!(interval([-2.0, 9.0, 1.0], [0.5, 0.0, 0.0]).is_none());
    }

    #[test]
    fn a_ray_in_a_face_is_inside_and_one_beside_it_is_not() {
        for zero in [0.0, -0.0, 5e-324, -5e-324] {
            let i = interval([-1.0, 8.0, 0.0], [1.0, zero, zero]);
            // A direction that leaves the face, however slowly, has left it before the volume.
            let leaves = zero != 0.0;
            if leaves {
                assert!(i.is_none_or(|i| i.length_mm <= 4.0));
            } else {
                assert_eq!(i.unwrap().length_mm, 4.0);
            }
            let beside = 8.0_f64.next_up();
            assert!(interval([-1.0, beside, 0.0], [1.0, zero, 0.0]).is_none());
        }
    }

    #[test]
    fn touching_a_corner_is_an_interval_without_length() {
        let i = interval([-1.0, 1.0, 1.0], [1.0, -1.0, 0.0]).unwrap();
        assert_eq!((i.enter_mm, i.length_mm), (1.0, 0.0));
        assert!(interval([-1.0, 0.999, 1.0], [1.0, -1.0, 0.0]).is_none());
    }

    #[test]
    fn nothing_infinite_comes_in() {
        assert!(interval([f64::INFINITY, 1.0, 1.0], [1.0, 0.0, 0.0]).is_none());
        assert!(interval([1.0, 1.0, 1.0], [0.0, 0.0, 0.0]).is_none());
    }
}
