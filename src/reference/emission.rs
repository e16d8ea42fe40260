//! Emission and absorption along a ray, integrated adaptively between the points where the
//! integrand is not smooth: cell faces, knots of the transfer function, and, when shaded, where
//! the surface turns away from the viewer or a light, and where the gradient is that from which it is shaded fully.

use glam::{DMat3, DVec3};
use smallvec::{SmallVec, smallvec};

use crate::extent::Range;
use crate::scene::{Gradient, LightFrom};
use crate::volume::Voxel;

use super::bernstein::{Ordinates, each_zero, product, sum};
use super::cells::{Segment, Walk};
use super::collocation::{GAUSS, NODES};
use super::cubic::Cubic;
use super::field::{Field, bounds};
use super::interval::Interval;
use super::leaving::Surroundings;
use super::medium::{Medium, Ramp};
use super::shade::{Lamp, Lighting, LitPoint, normal_from_gradient};

/// The sum of the error estimates of a ray, per channel, but for [`FLOOR`] a piece. An estimate is
/// that of the coarser of two results, of which the finer one is taken.
const TOLERANCE: f64 = 1e-7;
/// The same where light is followed to each point through the medium, since every point costs a ray of its own.
const SHADOWED_TOLERANCE: f64 = 1e-5;
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

/// The light that a ray receives from an emitting, absorbing medium.
#[derive(Debug, Clone, Copy)]
pub struct Emitted {
    /// The colour: premultiplied linear light.
    pub color: [f64; 3],
    /// exp(−∫κ) over the whole interval, or below [`DARK`].
    pub transmittance: f64,
    /// The number of boxes walked.
    pub walked: u32,
}

/// Means along a ray, each point weighted as its light is that reaches the eye: ∫ x κT dt / ∫ κT dt.
#[derive(Debug, Clone, Copy)]
pub struct Means {
    /// The mean distance from the interval's start, mm.
    pub at_mm: f64,
    /// The mean of Φ, physical.
    pub value: f64,
    /// The mean of the unit normals, world space, itself not of unit length; 0 if none were requested.
    pub normal_world: DVec3,
}

/// A ray in world space.
#[derive(Debug, Clone, Copy)]
pub struct Path {
    /// Where the interval begins.
    pub start_world: DVec3,
    /// The ray's direction, a unit vector.
    pub dir_world: DVec3,
}

impl Path {
    /// The point so far from the interval's start.
    fn at(&self, mm: f64) -> DVec3 {
        self.start_world + self.dir_world * mm
    }
}

/// How the medium's points along a ray are lit.
#[derive(Debug, Clone, Copy)]
pub struct Shading<'a> {
    /// The lights and the reflection.
    pub lighting: &'a Lighting,
    /// The ray.
    pub path: Path,
    /// What the light passes that reaches a point; `None`: nothing is in its way.
    pub shadows: Option<Surroundings<'a>>,
    /// The gradient, per mm, from which points are shaded fully; 0: all are.
    pub shaded_from: f64,
    /// How gradients are computed.
    pub gradient: Gradient,
    /// The inverse transpose of world_from_index's linear part.
    pub gradient_world_from_index: DMat3,
}

/// How normals are computed and turned to world space.
#[derive(Debug, Clone, Copy)]
pub struct Normals {
    /// How gradients are computed.
    pub gradient: Gradient,
    /// The inverse transpose of world_from_index's linear part.
    pub gradient_world_from_index: DMat3,
    /// The normal where Φ has no gradient.
    pub toward_eye: DVec3,
}

/// `∫ c κ T dt` and T over the interval, within 1e-6 per channel (for colours up to 1), with shadows within 1e-4.
pub fn integrate<T: Voxel>(
    field: &Field<T>,
    interval: &Interval,
    medium: &Medium,
    shading: Option<&Shading>,
) -> Emitted {
    let brightest = shading.map_or(1.0, |s| s.lighting.brightest().max(1.0));
    let mut ray = Ray::new(medium, interval, brightest);
    if shading.is_some_and(|shading| shading.shadows.is_some()) {
        ray.tolerance_per_mm = SHADOWED_TOLERANCE / interval.length_mm;
    }
    let walked = ray.along(field, interval, |segment| Tint {
        lit: shading.map(|shading| Lit::new(field, medium, segment, shading)),
    });
    Emitted {
        color: ray.light,
        transmittance: ray.transmittance,
        walked,
    }
}

/// exp(−∫κ) over the interval, or below [`DARK`].
pub fn transmittance<T: Voxel>(field: &Field<T>, interval: &Interval, medium: &Medium) -> f64 {
    let mut ray = Ray::<0>::new(medium, interval, 1.0);
    ray.along(field, interval, |_| Nothing);
    ray.transmittance
}

/// The share of a light that reaches a point of the medium.
pub fn visibility<T: Voxel>(
    field: &Field<T>,
    medium: &Medium,
    shadows: &Surroundings,
    at_world: DVec3,
    to_viewer: DVec3,
    light: LightFrom,
) -> f64 {
    match light {
        LightFrom::Eye => 1.0,
        LightFrom::Direction(_) | LightFrom::Point(_) => {
            let interval = shadows.interval_to_light(at_world, to_viewer, light);
            interval.map_or(1.0, |interval| transmittance(field, &interval, medium))
        }
    }
}

/// The mean of what reaches an interval's points of a light, weighted as their own light is.
pub fn mean_visibility<T: Voxel>(
    field: &Field<T>,
    interval: &Interval,
    medium: &Medium,
    path: Path,
    shadows: &Surroundings,
    light: LightFrom,
) -> f64 {
    let mut ray = Ray::new(medium, interval, 1.0);
    ray.tolerance_per_mm = SHADOWED_TOLERANCE / interval.length_mm;
    ray.along(field, interval, |segment| Reached {
        ends_world: [segment.from_mm, segment.to_mm].map(|mm| path.at(mm)),
        of_point: |at_world| visibility(field, medium, shadows, at_world, -path.dir_world, light),
    });
    let [reached] = ray.light;
    reached / (1.0 - ray.transmittance)
}

/// The means of an interval in which something absorbs, the normal if requested. Their integrals are as
/// exact as [`integrate`]'s, in shares of the interval's length and of `range`, the field's values.
pub fn means<T: Voxel>(
    field: &Field<T>,
    interval: &Interval,
    medium: &Medium,
    range: Range,
    normals: Option<&Normals>,
) -> Means {
    let mut ray = Ray::new(medium, interval, 1.0);
    ray.along(field, interval, |segment| Place {
        from: segment.from_mm / interval.length_mm,
        to: segment.to_mm / interval.length_mm,
        range,
        normals: normals.map(|normals| Turned::new(field, segment, normals)),
    });
    let opacity = 1.0 - ray.transmittance;
    let [at, value, x, y, z] = ray.light.map(|sum| sum / opacity);
    Means {
        at_mm: at * interval.length_mm,
        value: range.min + value * range.width(),
        normal_world: DVec3::new(x, y, z),
    }
}

/// A quantity that is summed over a segment's points: N numbers each, weighted by κT.
trait Points<const N: usize> {
    /// The numbers at s of the segment, where Φ is `value` and the medium has a colour.
    fn at(&self, s: f64, value: f64, color: [f64; 3]) -> [f64; N];

    /// Where these numbers are not smooth.
    fn push_breaks(&self, _breaks: &mut Breaks) {}

    /// Whether the numbers surely change little on a piece: a swing might lie between all nodes.
    fn is_steady(&self, _from: f64, _to: f64) -> bool {
        true
    }
}

/// Nothing is summed but optical depth.
struct Nothing;

impl Points<0> for Nothing {
    fn at(&self, _s: f64, _value: f64, _color: [f64; 3]) -> [f64; 0] {
        []
    }
}

/// What reaches the points of a segment of a light.
struct Reached<F> {
    ends_world: [DVec3; 2],
    of_point: F,
}

impl<F: Fn(DVec3) -> f64> Points<1> for Reached<F> {
    fn at(&self, s: f64, _value: f64, _color: [f64; 3]) -> [f64; 1] {
        [(self.of_point)(
            self.ends_world[0].lerp(self.ends_world[1], s),
        )]
    }
}

type Breaks = SmallVec<[f64; 16]>;

/// ∇Φ along a segment in world space, each component a cubic.
struct WorldGradient([Cubic; 3]);

impl WorldGradient {
    fn new<T: Voxel>(
        field: &Field<T>,
        segment: &Segment,
        gradient: Gradient,
        gradient_world_from_index: DMat3,
    ) -> Self {
        let gradient = field.gradient(segment, gradient);
        let rows = gradient_world_from_index.transpose();
        let component = |row: DVec3| Cubic::combine(&gradient, row.to_array());
        Self([rows.x_axis, rows.y_axis, rows.z_axis].map(component))
    }

    fn at(&self, s: f64) -> DVec3 {
        DVec3::from_array(self.0.map(|c| c.at(s)))
    }

    fn normal(&self, s: f64, toward_eye: DVec3) -> DVec3 {
        normal_from_gradient(self.at(s), toward_eye)
    }

    /// Whether the normal surely turns little on a piece: a swing where the gradient almost
    /// vanishes might lie between all nodes. The gradient lies in the hull of its Bézier points.
    fn is_steady(&self, from: f64, to: f64) -> bool {
        let [x, y, z] = self.0.map(|c| c.hull(from, to));
        let points: [DVec3; 4] = std::array::from_fn(|i| DVec3::new(x[i], y[i], z[i]));
        is_narrow(&points)
    }
}

/// Whether vectors, and so all in their hull, have about one direction.
fn is_narrow(vectors: &[DVec3]) -> bool {
    let middle: DVec3 = vectors.iter().sum();
    vectors
        .iter()
        .all(|v| v.dot(middle) >= STEADY * v.length() * middle.length())
}

/// The light on a segment.
struct Lit<'a, T> {
    field: &'a Field<'a, T>,
    medium: &'a Medium,
    shading: Shading<'a>,
    gradient: WorldGradient,
    /// Where the segment begins and ends, world space.
    ends_world: [DVec3; 2],
}

impl<'a, T: Voxel> Lit<'a, T> {
    fn new(
        field: &'a Field<'a, T>,
        medium: &'a Medium,
        segment: &Segment,
        shading: &Shading<'a>,
    ) -> Self {
        let to_world = shading.gradient_world_from_index;
        let place = |mm: f64| shading.path.at(mm);
        Self {
            field,
            medium,
            shading: *shading,
            gradient: WorldGradient::new(field, segment, shading.gradient, to_world),
            ends_world: [place(segment.from_mm), place(segment.to_mm)],
        }
    }

    fn at_world(&self, s: f64) -> DVec3 {
        self.ends_world[0].lerp(self.ends_world[1], s)
    }

    /// The light of a point: the shaded colour, mixed with the unshaded where the gradient is small.
    fn reflect(&self, s: f64, color: [f64; 3]) -> [f64; 3] {
        let to_viewer = -self.shading.path.dir_world;
        let at_world = self.at_world(s);
        let point = LitPoint {
            at_world,
            to_viewer,
            normal: self.gradient.normal(s, to_viewer),
        };
        let reached = |lamp: &Lamp| {
            self.shading.shadows.as_ref().map_or(1.0, |shadows| {
                visibility(
                    self.field,
                    self.medium,
                    shadows,
                    at_world,
                    to_viewer,
                    lamp.from,
                )
            })
        };
        let shaded = self.shading.lighting.reflect(color, point, 1.0, reached);
        let share = self.shaded_share(s);
        std::array::from_fn(|c| shaded[c] * share + color[c] * (1.0 - share))
    }

    /// min(1, |∇Φ| / G); 1 where G is 0.
    fn shaded_share(&self, s: f64) -> f64 {
        match self.shading.shaded_from {
            0.0 => 1.0,
            from => (self.gradient.at(s) / from).length().min(1.0),
        }
    }

    /// ∇Φ·l along the segment, as Bernstein ordinates: of a light at a point l is linear, but for its length.
    fn facing(&self, from: LightFrom) -> Ordinates {
        let along = |toward: DVec3| Cubic::combine(&self.gradient.0, toward.to_array()).0;
        match from {
            LightFrom::Eye => along(-self.shading.path.dir_world).as_slice().into(),
            LightFrom::Direction(toward) => along(toward).as_slice().into(),
            LightFrom::Point(light_world) => {
                let [near, far] = self.ends_world.map(|end| (light_world - end).to_array());
                let axis = |a: usize| product(&self.gradient.0[a].0, &[near[a], far[a]]);
                sum(&sum(&axis(0), &axis(1)), &axis(2))
            }
        }
    }

    /// (|∇Φ| / G)² − 1 along the segment, as Bernstein ordinates.
    fn beyond_shaded_from(&self) -> Ordinates {
        let squares = (self.gradient.0).map(|component| {
            let scaled = component.0.map(|value| value / self.shading.shaded_from);
            product(&scaled, &scaled)
        });
        let square = sum(&sum(&squares[0], &squares[1]), &squares[2]);
        square.iter().map(|ordinate| ordinate - 1.0).collect()
    }
}

/// Colours, under lights where there are any.
struct Tint<'a, T> {
    lit: Option<Lit<'a, T>>,
}

impl<T: Voxel> Points<3> for Tint<'_, T> {
    fn at(&self, s: f64, _value: f64, color: [f64; 3]) -> [f64; 3] {
        match &self.lit {
            Some(lit) => lit.reflect(s, color),
            None => color,
        }
    }

    fn push_breaks(&self, breaks: &mut Breaks) {
        let Some(lit) = &self.lit else {
            return;
        };
        let lamps = lit.shading.lighting.lamps().iter().map(|lamp| lamp.from);
        for from in std::iter::once(LightFrom::Eye).chain(lamps) {
            let facing = lit.facing(from);
            match <[f64; 4]>::try_from(facing.as_slice()) {
                Ok(cubic) => Cubic(cubic).push_crossings(0.0, breaks),
                Err(_) => each_zero(&facing, &mut |s| breaks.push(s)),
            }
        }
        if lit.shading.shaded_from > 0.0 {
            each_zero(&lit.beyond_shaded_from(), &mut |s| breaks.push(s));
        }
    }

    fn is_steady(&self, from: f64, to: f64) -> bool {
        let Some(lit) = &self.lit else {
            return true;
        };
        let is_steady = |of: LightFrom| match of {
            LightFrom::Point(light_world) => {
                is_narrow(&[from, to].map(|s| light_world - lit.at_world(s)))
            }
            LightFrom::Eye | LightFrom::Direction(_) => true,
        };
        let lamps = lit.shading.lighting.lamps();
        lit.gradient.is_steady(from, to) && lamps.iter().all(|lamp| is_steady(lamp.from))
    }
}

/// The normals of a segment.
struct Turned {
    gradient: WorldGradient,
    toward_eye: DVec3,
}

impl Turned {
    fn new<T: Voxel>(field: &Field<T>, segment: &Segment, normals: &Normals) -> Self {
        let to_world = normals.gradient_world_from_index;
        Self {
            gradient: WorldGradient::new(field, segment, normals.gradient, to_world),
            toward_eye: normals.toward_eye,
        }
    }
}

/// Where points are, as a share of the interval; Φ, as a share of its range; and their normals.
struct Place {
    from: f64,
    to: f64,
    range: Range,
    normals: Option<Turned>,
}

impl Points<5> for Place {
    fn at(&self, s: f64, value: f64, _color: [f64; 3]) -> [f64; 5] {
        let normal = self.normals.as_ref().map_or(DVec3::ZERO, |turned| {
            turned.gradient.normal(s, turned.toward_eye)
        });
        let share = if self.range.width() > 0.0 {
            (value - self.range.min) / self.range.width()
        } else {
            0.0
        };
        let at = self.from + (self.to - self.from) * s;
        [at, share, normal.x, normal.y, normal.z]
    }

    fn is_steady(&self, from: f64, to: f64) -> bool {
        let normals = self.normals.as_ref();
        normals.is_none_or(|turned| turned.gradient.is_steady(from, to))
    }
}

/// The integrand on one segment.
struct Integrand<P> {
    phi: Cubic,
    /// Rounding error of Φ.
    noise: f64,
    length_mm: f64,
    points: P,
}

impl<P> Integrand<P> {
    /// The summed quantity, and the absorption per mm, at a point.
    fn emits<const N: usize>(&self, medium: &Medium, ramp: &Ramp, s: f64) -> ([f64; N], f64)
    where
        P: Points<N>,
    {
        let value = self.phi.at(s);
        let (color, absorption) = medium.at(ramp, value);
        (self.points.at(s, value, color), absorption)
    }

    /// Where the integrand is not smooth, with 0 and 1, ascending.
    fn breaks<const N: usize>(&self, medium: &Medium) -> Breaks
    where
        P: Points<N>,
    {
        let mut breaks: Breaks = smallvec![0.0, 1.0];
        for ends in self.phi.monotone_ends().windows(2) {
            let (a, b) = (self.phi.at(ends[0]), self.phi.at(ends[1]));
            for &level in medium.levels_between(a.min(b), a.max(b)) {
                breaks.push(self.phi.crossing(level, ends[0], ends[1]));
            }
        }
        self.points.push_breaks(&mut breaks);
        breaks.sort_by(f64::total_cmp);
        breaks
    }
}

/// Light, or what else is summed, and optical depth of a piece on its own.
#[derive(Clone, Copy)]
struct Panel<const N: usize> {
    light: [f64; N],
    depth: f64,
}

impl<const N: usize> Panel<N> {
    fn then(self, next: Self) -> Self {
        let through = (-self.depth).exp();
        Self {
            light: std::array::from_fn(|c| self.light[c] + through * next.light[c]),
            depth: self.depth + next.depth,
        }
    }
}

/// The sums along a ray so far.
struct Ray<'a, const N: usize> {
    medium: &'a Medium,
    tolerance_per_mm: f64,
    brightest: f64,
    light: [f64; N],
    transmittance: f64,
}

impl<'a, const N: usize> Ray<'a, N> {
    /// Starts the sums of an interval. `brightest`: the most that a point's numbers are.
    fn new(medium: &'a Medium, interval: &Interval, brightest: f64) -> Self {
        Self {
            medium,
            tolerance_per_mm: TOLERANCE / interval.length_mm,
            brightest,
            light: [0.0; N],
            transmittance: 1.0,
        }
    }

    /// Gathers the whole interval; the boxes walked.
    fn along<T: Voxel, P: Points<N>>(
        &mut self,
        field: &Field<T>,
        interval: &Interval,
        points: impl Fn(&Segment) -> P,
    ) -> u32 {
        let mut walked = 0;
        for segment in Walk::new(field.lattice, interval) {
            walked += 1;
            let corners = field.corners(segment.cell);
            let (low, high) = bounds(&corners);
            if self.medium.is_clear(low, high) || segment.length_mm() <= 0.0 {
                continue;
            }
            let integrand = Integrand {
                phi: Field::<T>::along(&corners, &segment),
                noise: NOISE_SHARE * low.abs().max(high.abs()),
                length_mm: segment.length_mm(),
                points: points(&segment),
            };
            for ends in integrand.breaks(self.medium).windows(2) {
                let (from, to) = (ends[0], ends[1]);
                let ramp = self.medium.ramp(integrand.phi.at(0.5 * (from + to)));
                if from < to && !ramp.is_clear() {
                    self.add(&integrand, ramp, from, to);
                }
            }
            if self.transmittance < DARK {
                break;
            }
        }
        walked
    }

    fn add<P: Points<N>>(&mut self, integrand: &Integrand<P>, ramp: &Ramp, from: f64, to: f64) {
        let whole = self.panel(integrand, ramp, from, to);
        self.refine(integrand, ramp, (from, to), whole);
    }

    /// One step of the collocation rule.
    fn panel<P: Points<N>>(
        &self,
        integrand: &Integrand<P>,
        ramp: &Ramp,
        from: f64,
        to: f64,
    ) -> Panel<N> {
        let rule = &*GAUSS;
        let length_mm = integrand.length_mm * (to - from);
        let mut light = [[0.0; N]; NODES];
        let mut depth = [0.0; NODES];
        for i in 0..NODES {
            let s = from + (to - from) * rule.nodes[i];
            let (emitted, absorption) = integrand.emits(self.medium, ramp, s);
            light[i] = emitted;
            depth[i] = absorption * length_mm;
        }
        let dot = |weights: &[f64; NODES]| (0..NODES).map(|j| weights[j] * depth[j]).sum::<f64>();
        let mut panel = Panel {
            light: [0.0; N],
            depth: dot(&rule.weights),
        };
        for i in 0..NODES {
            let seen = rule.weights[i] * depth[i] * (-dot(&rule.to_node[i])).exp();
            for (sum, c) in panel.light.iter_mut().zip(light[i]) {
                *sum += seen * c;
            }
        }
        panel
    }

    /// Adds a piece front to back: as two halves if they agree with the whole, else half by half;
    /// a piece too short to halve, as one of constant colour.
    fn refine<P: Points<N>>(
        &mut self,
        integrand: &Integrand<P>,
        ramp: &Ramp,
        (from, to): (f64, f64),
        whole: Panel<N>,
    ) {
        if self.transmittance < DARK {
            return;
        }
        let middle = 0.5 * (from + to);
        let first = self.panel(integrand, ramp, from, middle);
        let second = self.panel(integrand, ramp, middle, to);
        let halves = first.then(second);
        let off = (0..N).fold(0.0_f64, |off, c| {
            off.max((whole.light[c] - halves.light[c]).abs())
        });
        let leaves = |panel: Panel<N>| (-panel.depth).exp();
        let estimate = off + self.brightest * (leaves(whole) - leaves(halves)).abs();
        let length_mm = integrand.length_mm * (to - from);
        let allowed = (self.tolerance_per_mm * length_mm).max(FLOOR);
        let noise = self.medium.noise_per_mm(ramp, integrand.noise) * length_mm;
        let left = leaves(halves);
        let agree = self.transmittance * estimate <= allowed || estimate <= noise;
        let is_steady = || integrand.points.is_steady(from, to);
        let is_faint = self.transmittance * self.brightest * (1.0 - left) <= FLOOR;
        if agree && halves.depth <= MAX_DEPTH_OF_PIECE && (is_faint || is_steady()) {
            self.gather(halves.light, left);
        } else if to - from > SHORTEST {
            self.refine(integrand, ramp, (from, middle), first);
            self.refine(integrand, ramp, (middle, to), second);
        } else {
            let (light, _) = integrand.emits(self.medium, ramp, middle);
            self.gather(light.map(|c| c * (1.0 - left)), left);
        }
    }

    /// Adds the light of the next piece, which lets `left` of the light behind it through.
    fn gather(&mut self, light: [f64; N], left: f64) {
        for (sum, c) in self.light.iter_mut().zip(light) {
            *sum += self.transmittance * c;
        }
        self.transmittance *= left;
    }
}
