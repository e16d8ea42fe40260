//! Emission and absorption along a ray, integrated adaptively between the points where the
//! integrand is not smooth: cell faces, knots of the transfer function, and, when shaded, where
//! the surface turns away from the viewer or the light.

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use crate::scene::Gradient;
use crate::volume::Voxel;

use super::cells::{Segment, Walk};
use super::collocation::{GAUSS, NODES};
use super::cubic::Cubic;
use super::field::{Field, bounds};
use super::interval::Interval;
use super::medium::{Medium, Ramp};
use super::shade::{Lighting, normal_from_gradient};

/// The sum of the error estimates of a ray, per channel, but for [`FLOOR`] a piece. An estimate is
/// that of the coarser of two results, of which the finer one is taken.
const TOLERANCE: f64 = 1e-7;
/// The estimate at which a piece is accepted however short it is; a ray has fewer than 10⁵ pieces
/// by far that need it.
const FLOOR: f64 = 1e-12;
/// Rounding errors of Φ along a segment, as a share of its largest corner: what they do to the
/// integrand, no halving undoes.
const NOISE_SHARE: f64 = 8.0 * f64::EPSILON;
/// A piece that absorbs more than this is split before its estimate is believed: its nodes might
/// all lie in the dark.
const MAX_DEPTH_OF_PIECE: f64 = 4.0;
/// A shorter piece, as a share of its segment, is not halved.
const SHORTEST: f64 = 1e-13;
/// The cosine within which a piece's normals must lie before its estimate is believed.
const STEADY: f64 = 0.8;
/// Light behind this transmittance is not followed.
const DARK: f64 = 1e-12;

/// What a ray sees of an emitting, absorbing medium.
#[derive(Debug, Clone, Copy)]
pub struct Emitted {
    /// Premultiplied linear light.
    pub color: [f64; 3],
    /// exp(−∫κ) over the whole interval, or below [`DARK`].
    pub transmittance: f64,
    /// Boxes walked.
    pub walked: u32,
}

/// How the medium's points are lit.
#[derive(Debug, Clone, Copy)]
pub struct Shading {
    pub lighting: Lighting,
    pub gradient: Gradient,
    /// The inverse transpose of world_from_index's linear part.
    pub gradient_world_from_index: glam::DMat3,
}

/// `∫ c κ T dt` and T over the interval, within 1e-6 per channel (for colours up to 1).
pub fn integrate<T: Voxel>(
    field: &Field<T>,
    interval: &Interval,
    medium: &Medium,
    shading: Option<&Shading>,
) -> Emitted {
    let mut ray = Ray {
        medium,
        tolerance_per_mm: TOLERANCE / interval.length_mm,
        brightest: shading.map_or(1.0, |s| s.lighting.brightest().max(1.0)),
        color: [0.0; 3],
        transmittance: 1.0,
    };
    let mut walked = 0;
    for segment in Walk::new(field.lattice, interval) {
        walked += 1;
        let corners = field.corners(segment.cell);
        let (low, high) = bounds(&corners);
        if medium.is_clear(low, high) || segment.length_mm() <= 0.0 {
            continue;
        }
        let stretch = Stretch {
            phi: Field::<T>::along(&corners, &segment),
            noise: NOISE_SHARE * low.abs().max(high.abs()),
            length_mm: segment.length_mm(),
            lit: shading.map(|shading| Lit::new(field, &segment, shading)),
        };
        let breaks = stretch.breaks(medium);
        for ends in breaks.windows(2) {
            let (from, to) = (ends[0], ends[1]);
            let ramp = medium.ramp(stretch.phi.at(0.5 * (from + to)));
            if from < to && !ramp.is_clear() {
                ray.add(&stretch, ramp, from, to);
            }
        }
        if ray.transmittance < DARK {
            break;
        }
    }
    Emitted {
        color: ray.color,
        transmittance: ray.transmittance,
        walked,
    }
}

/// The light on a segment.
struct Lit {
    lighting: Lighting,
    /// ∇Φ in world space, each component a cubic.
    gradient_world: [Cubic; 3],
}

impl Lit {
    fn new<T: Voxel>(field: &Field<T>, segment: &Segment, shading: &Shading) -> Self {
        let gradient = field.gradient(segment, shading.gradient);
        let rows = shading.gradient_world_from_index.transpose();
        let component = |row: DVec3| Cubic::combine(&gradient, row.to_array());
        Self {
            lighting: shading.lighting,
            gradient_world: [rows.x_axis, rows.y_axis, rows.z_axis].map(component),
        }
    }

    fn reflect(&self, color: [f64; 3], s: f64) -> [f64; 3] {
        let gradient = DVec3::from_array(self.gradient_world.map(|c| c.at(s)));
        let normal = normal_from_gradient(gradient, self.lighting.to_viewer);
        self.lighting.reflect(color, normal)
    }

    /// Whether the normal surely turns little on a piece: a swing where the gradient almost
    /// vanishes might lie between all nodes. The gradient lies in the hull of its Bézier points.
    fn is_steady(&self, from: f64, to: f64) -> bool {
        let [x, y, z] = self.gradient_world.map(|c| c.hull(from, to));
        let points: [DVec3; 4] = std::array::from_fn(|i| DVec3::new(x[i], y[i], z[i]));
        let middle: DVec3 = points.iter().sum();
        points
            .iter()
            .all(|p| p.dot(middle) >= STEADY * p.length() * middle.length())
    }
}

/// The integrand on one segment.
struct Stretch {
    phi: Cubic,
    /// Rounding error of Φ.
    noise: f64,
    length_mm: f64,
    lit: Option<Lit>,
}

impl Stretch {
    /// Colour and absorption per mm at a point.
    fn emits(&self, medium: &Medium, ramp: &Ramp, s: f64) -> ([f64; 3], f64) {
        let (color, absorption) = medium.at(ramp, self.phi.at(s));
        match &self.lit {
            Some(lit) => (lit.reflect(color, s), absorption),
            None => (color, absorption),
        }
    }

    /// Where the integrand is not smooth, with 0 and 1, ascending.
    fn breaks(&self, medium: &Medium) -> SmallVec<[f64; 16]> {
        let mut breaks: SmallVec<[f64; 16]> = smallvec![0.0, 1.0];
        for ends in self.phi.monotone_ends().windows(2) {
            let (a, b) = (self.phi.at(ends[0]), self.phi.at(ends[1]));
            for &level in medium.levels_between(a.min(b), a.max(b)) {
                breaks.push(self.phi.crossing(level, ends[0], ends[1]));
            }
        }
        if let Some(lit) = &self.lit {
            for toward in [lit.lighting.to_viewer, lit.lighting.to_light] {
                Cubic::combine(&lit.gradient_world, toward.to_array())
                    .push_crossings(0.0, &mut breaks);
            }
        }
        breaks.sort_by(f64::total_cmp);
        breaks
    }
}

/// Light and optical depth of a piece on its own.
#[derive(Clone, Copy)]
struct Panel {
    color: [f64; 3],
    depth: f64,
}

impl Panel {
    fn then(self, next: Self) -> Self {
        let through = (-self.depth).exp();
        Self {
            color: std::array::from_fn(|c| self.color[c] + through * next.color[c]),
            depth: self.depth + next.depth,
        }
    }
}

/// The light gathered so far.
struct Ray<'a> {
    medium: &'a Medium,
    tolerance_per_mm: f64,
    brightest: f64,
    color: [f64; 3],
    transmittance: f64,
}

impl Ray<'_> {
    fn add(&mut self, stretch: &Stretch, ramp: &Ramp, from: f64, to: f64) {
        let whole = self.panel(stretch, ramp, from, to);
        self.refine(stretch, ramp, (from, to), whole);
    }

    /// One step of the collocation rule.
    fn panel(&self, stretch: &Stretch, ramp: &Ramp, from: f64, to: f64) -> Panel {
        let rule = &*GAUSS;
        let length_mm = stretch.length_mm * (to - from);
        let mut color = [[0.0; 3]; NODES];
        let mut depth = [0.0; NODES];
        for i in 0..NODES {
            let s = from + (to - from) * rule.nodes[i];
            let (emitted, absorption) = stretch.emits(self.medium, ramp, s);
            color[i] = emitted;
            depth[i] = absorption * length_mm;
        }
        let dot = |weights: &[f64; NODES]| (0..NODES).map(|j| weights[j] * depth[j]).sum::<f64>();
        let mut panel = Panel {
            color: [0.0; 3],
            depth: dot(&rule.weights),
        };
        for i in 0..NODES {
            let seen = rule.weights[i] * depth[i] * (-dot(&rule.to_node[i])).exp();
            for (sum, c) in panel.color.iter_mut().zip(color[i]) {
                *sum += seen * c;
            }
        }
        panel
    }

    /// Adds a piece front to back: as two halves if they agree with the whole, else half by half;
    /// a piece too short to halve, as one of constant colour.
    fn refine(&mut self, stretch: &Stretch, ramp: &Ramp, (from, to): (f64, f64), whole: Panel) {
        if self.transmittance < DARK {
            return;
        }
        let middle = 0.5 * (from + to);
        let first = self.panel(stretch, ramp, from, middle);
        let second = self.panel(stretch, ramp, middle, to);
        let halves = first.then(second);
        let off = (0..3).fold(0.0_f64, |off, c| {
            off.max((whole.color[c] - halves.color[c]).abs())
        });
        let leaves = |panel: Panel| (-panel.depth).exp();
        let estimate = off + self.brightest * (leaves(whole) - leaves(halves)).abs();
        let length_mm = stretch.length_mm * (to - from);
        let allowed = (self.tolerance_per_mm * length_mm).max(FLOOR);
        let noise = self.medium.noise_per_mm(ramp, stretch.noise) * length_mm;
        let left = leaves(halves);
        let agree = self.transmittance * estimate <= allowed || estimate <= noise;
        let is_steady = || match &stretch.lit {
            Some(lit) => lit.is_steady(from, to),
            None => true,
        };
        let is_faint = self.transmittance * self.brightest * (1.0 - left) <= FLOOR;
        if agree && halves.depth <= MAX_DEPTH_OF_PIECE && (is_faint || is_steady()) {
            self.gather(halves.color, left);
        } else if to - from > SHORTEST {
            self.refine(stretch, ramp, (from, middle), first);
            self.refine(stretch, ramp, (middle, to), second);
        } else {
            let (color, _) = stretch.emits(self.medium, ramp, middle);
            self.gather(color.map(|c| c * (1.0 - left)), left);
        }
    }

    /// Adds the light of the next piece, which lets `left` of the light behind it through.
    fn gather(&mut self, color: [f64; 3], left: f64) {
        for (sum, c) in self.color.iter_mut().zip(color) {
            *sum += self.transmittance * c;
        }
        self.transmittance *= left;
    }
}
