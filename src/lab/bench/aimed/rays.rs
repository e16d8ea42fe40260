//! Rays aimed at where a cast goes wrong: corners, edges and faces of cells, grid lines, tangents of
//! the surface, and rays that begin on any of them.
//!
//! Origins and directions are numbers of single precision, so that a device and the reference in
//! double precision get the same ray to the bit. Directions are not of unit length.

use glam::DVec3;

use super::Target;
use crate::lab::bench::rng::Rng;

/// The feature of the volume at which a ray is aimed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Aim {
    /// A point through a voxel: the corner of eight cells.
    Corner,
    /// A ray through a cell's edge, or along it.
    Edge,
    /// A ray in the plane of cell faces.
    InFace,
    /// A ray along an axis, on lines of the grid or a hair beside.
    GridLine,
    /// A ray through the middle of a cell's face, nearly in its plane.
    Grazing,
    /// Touching the surface, or passing it at 1e-6 to 1e-2 voxel.
    Tangent,
    /// Beginning inside: on a voxel, a face, an edge, the surface.
    FromInside,
}

impl Aim {
    /// All aims, in the order of their discriminants.
    pub const ALL: [Self; 7] = [
        Self::Corner,
        Self::Edge,
        Self::InFace,
        Self::GridLine,
        Self::Grazing,
        Self::Tangent,
        Self::FromInside,
    ];

    /// The aim's name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Corner => "corner",
            Self::Edge => "edge",
            Self::InFace => "in a face",
            Self::GridLine => "grid line",
            Self::Grazing => "grazing",
            Self::Tangent => "tangent",
            Self::FromInside => "from inside",
        }
    }
}

/// A ray in index space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AimedRay {
    /// The feature at which the ray is aimed.
    pub aim: Aim,
    /// The ray's first point, in index space.
    pub origin: [f32; 3],
    /// The direction, in index units per unit of t.
    pub dir: [f32; 3],
}

/// `count` rays at a target, each aim in turn.
pub fn rays(target: &Target, seed: u64, count: usize) -> Vec<AimedRay> {
    let mut aimer = Aimer {
        target,
        sides: target.volume.dims().array(),
        rng: Rng::new(seed),
    };
    let each = |i: usize| aimer.ray(Aim::ALL[i % Aim::ALL.len()]);
    (0..count).map(each).collect()
}

struct Aimer<'a> {
    target: &'a Target,
    sides: [u32; 3],
    rng: Rng,
}

fn narrow(v: DVec3) -> [f32; 3] {
    v.to_array().map(|c| c as f32)
}

impl Aimer<'_> {
    fn ray(&mut self, aim: Aim) -> AimedRay {
        let (origin, dir) = match aim {
            Aim::Corner => {
                let at = self.voxel();
                self.through(at)
            }
            Aim::Edge => self.at_edge(),
            Aim::InFace => self.in_face(),
            Aim::GridLine => self.on_grid_line(),
            Aim::Grazing => self.grazing(),
            Aim::Tangent => self.tangent(),
            Aim::FromInside => self.inside_out(),
        };
        AimedRay {
            aim,
            origin: narrow(origin),
            dir: narrow(dir),
        }
    }

    fn at_edge(&mut self) -> (DVec3, DVec3) {
        let mut at = self.voxel();
        let axis = self.rng.below(3) as usize;
        at[axis] = self.anywhere(axis);
        if self.rng.one_in(4) {
            let dir = DVec3::AXES[axis] * self.rng.sign();
            (at - dir * 40.0, dir)
        } else {
            self.through(at)
        }
    }

    fn in_face(&mut self) -> (DVec3, DVec3) {
        let axis = self.rng.below(3) as usize;
        let mut at = self.inside();
        at[axis] = f64::from(self.rng.below(self.sides[axis]));
        let mut dir = self.rng.direction();
        dir[axis] = if self.rng.one_in(2) { 0.0 } else { -0.0 };
        let mut origin = DVec3::from_array(narrow(at - dir * 40.0).map(f64::from));
        origin[axis] = at[axis];
        (origin, dir)
    }

    fn on_grid_line(&mut self) -> (DVec3, DVec3) {
        let axis = self.rng.below(3) as usize;
        let mut at = self.voxel();
        for side in [1, 2].map(|n| (axis + n) % 3) {
            at[side] += match self.rng.below(4) {
                0 => 0.5,
                1 => self.rng.sign() * (-20.0_f64).exp2(),
                _ => 0.0,
            };
        }
        let dir = DVec3::AXES[axis] * self.rng.sign();
        (at - dir * 40.0, dir)
    }

    fn grazing(&mut self) -> (DVec3, DVec3) {
        let axis = self.rng.below(3) as usize;
        let mut at = self.voxel() + 0.5;
        at[axis] = at[axis].floor();
        let mut dir = self.plain_direction();
        dir[axis] = self.rng.sign() * (-4.0 - f64::from(self.rng.below(17))).exp2();
        self.shifted(at - dir * 40.0, dir)
    }

    fn inside_out(&mut self) -> (DVec3, DVec3) {
        let mut origin = self.voxel();
        match self.rng.below(4) {
            0 => {}
            1 => {
                let axis = self.rng.below(3) as usize;
                origin[axis] = self.anywhere(axis);
            }
            2 => {
                let axis = self.rng.below(3) as usize;
                let at = origin[axis];
                origin = self.inside();
                origin[axis] = at;
            }
            _ => origin = self.surface().map_or(origin, |(at, _)| at),
        }
        let dir = if self.rng.one_in(2) {
            self.plain_direction()
        } else {
            self.rng.direction()
        };
        (origin, dir)
    }

    /// Any voxel's index.
    fn voxel(&mut self) -> DVec3 {
        DVec3::from_array(self.sides.map(|n| f64::from(self.rng.below(n))))
    }

    /// A coordinate of few digits on an axis.
    fn anywhere(&mut self, axis: usize) -> f64 {
        f64::from(self.rng.below((self.sides[axis] - 1) * 64 + 1)) / 64.0
    }

    fn inside(&mut self) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|axis| self.anywhere(axis)))
    }

    /// Components of six binary digits, some of them 0: whole steps along it stay exact.
    fn plain_direction(&mut self) -> DVec3 {
        loop {
            let component = |rng: &mut Rng| match rng.below(4) {
                0 => 0.0 * rng.sign(),
                _ => (f64::from(rng.below(129)) - 64.0) / 64.0,
            };
            let dir = DVec3::from_array([(); 3].map(|()| component(&mut self.rng)));
            if dir.abs().max_element() >= 0.25 {
                return dir;
            }
        }
    }

    /// A ray through a point of few digits, from outside, exactly; every other one a hair beside.
    fn through(&mut self, at: DVec3) -> (DVec3, DVec3) {
        let dir = self.plain_direction();
        let steps = f64::from(40 + self.rng.below(64));
        self.shifted(at - dir * steps, dir)
    }

    /// Every other ray moved by 2^-10 to 2^-24 along one axis.
    fn shifted(&mut self, mut origin: DVec3, dir: DVec3) -> (DVec3, DVec3) {
        if self.rng.one_in(2) {
            let axis = self.rng.below(3) as usize;
            let hair = (-10.0 - f64::from(self.rng.below(15))).exp2();
            origin[axis] += self.rng.sign() * hair;
        }
        (origin, dir)
    }

    /// A ray at right angles to the gradient at a point of the surface, moved off it by 0 or 1e-6 to
    /// 1e-2 voxel; any ray where the target has no surface nearby.
    fn tangent(&mut self) -> (DVec3, DVec3) {
        let Some((at, gradient)) = self.surface() else {
            let at = self.inside();
            return self.through(at);
        };
        let Some(normal) = gradient.try_normalize() else {
            return self.through(at);
        };
        let turn = self.rng.between(0.0, std::f64::consts::TAU);
        let side = normal.any_orthonormal_vector();
        let dir = side * turn.cos() + normal.cross(side) * turn.sin();
        let off = match self.rng.below(6) {
            0 => 0.0,
            n => self.rng.sign() * 10_f64.powi(-1 - n as i32),
        };
        let before = self.rng.between(0.0, 20.0);
        (at + normal * off - dir * before, dir)
    }

    /// A point of the surface in a random cell that it crosses, and the field's gradient there.
    fn surface(&mut self) -> Option<(DVec3, DVec3)> {
        const TRIES: u32 = 24;
        for _ in 0..TRIES {
            let low = DVec3::from_array(self.sides.map(|n| f64::from(self.rng.below(n - 1))));
            let cell = Cell::new(self.target, low);
            let any = |rng: &mut Rng| DVec3::new(rng.unit(), rng.unit(), rng.unit());
            let (mut a, mut b) = (any(&mut self.rng), any(&mut self.rng));
            let inside = |p| cell.value(p) >= self.target.iso;
            if inside(a) == inside(b) {
                continue;
            }
            for _ in 0..50 {
                let middle = (a + b) * 0.5;
                if inside(middle) == inside(a) {
                    a = middle;
                } else {
                    b = middle;
                }
            }
            return Some((low + a, cell.gradient(a)));
        }
        None
    }
}

/// One cell's trilinear field, apart from the reference's: positions from 0 to 1 along each axis.
struct Cell([f64; 8]);

impl Cell {
    fn new(target: &Target, low: DVec3) -> Self {
        let [nx, ny, _] = target.volume.dims().usize();
        let [x, y, z] = low.to_array().map(|c| c as usize);
        let rescale = target.volume.rescale();
        Self([0, 1, 2, 3, 4, 5, 6, 7].map(|corner| {
            let (x, y, z) = (x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2));
            rescale.physical(target.volume.voxels().stored(x + nx * (y + ny * z)))
        }))
    }

    /// Corners weighted by `weight(axis, upper)`.
    fn sum(&self, weight: impl Fn(usize, bool) -> f64) -> f64 {
        let corners = self.0.iter().enumerate();
        let weighted = |(corner, value): (usize, &f64)| {
            value
                * (0..3)
                    .map(|axis| weight(axis, corner >> axis & 1 == 1))
                    .product::<f64>()
        };
        corners.map(weighted).sum()
    }

    fn value(&self, p: DVec3) -> f64 {
        self.sum(|axis, upper| if upper { p[axis] } else { 1.0 - p[axis] })
    }

    fn gradient(&self, p: DVec3) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|along| {
            self.sum(|axis, upper| match (axis == along, upper) {
                (true, true) => 1.0,
                (true, false) => -1.0,
                (false, true) => p[axis],
                (false, false) => 1.0 - p[axis],
            })
        }))
    }
}
