//! The observed order of convergence of the rules that sum light along a ray, on smooth scenes whose
//! integrals are known: one cell, in which the field is linear or a cubic along the ray, under a
//! transfer function that is linear over all of it.

use glam::{DMat3, DVec3};

use crate::error::Result;
use crate::extent::{Dims, ImageSize};
use crate::frame::Wanted;
use crate::gpu::Device;
use crate::octree::{Leaf, Octree};
use crate::progress::Silent;
use crate::render::{Options, Renderer};
use crate::scene::{
    Camera, Emission, Knot, Lens, Picture, Quadrature, QuadratureMethod, Rgb, Scene, StepVoxels,
    Termination, TransferFunction,
};
use crate::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};

const EDGE_MM: f64 = 8.0;
const UNIT_MM: f64 = 3.0;
/// Colour and opacity where the field is 0, and where it is 1.
const NEAR: ([f64; 3], f64) = ([0.9, 0.2, 0.4], 0.1);
const FAR: ([f64; 3], f64) = ([0.1, 0.6, 0.8], 0.6);

/// The known order of each rule; preintegration takes the field for linear, as it is on the ramp.
pub const ORDERS: [(QuadratureMethod, f64); 6] = [
    (QuadratureMethod::Riemann, 1.0),
    (QuadratureMethod::Midpoint, 2.0),
    (QuadratureMethod::Simpson, 4.0),
    (QuadratureMethod::Romberg, 6.0),
    (QuadratureMethod::Rk4, 4.0),
    (QuadratureMethod::Preintegrated, 2.0),
];

/// The error below which rounding decides, in sums of few panels.
pub const FLOOR_OF_FEW: f64 = 4e-7;
/// The rounding error of a sum of many panels.
const FLOOR_OF_MANY: f64 = 3e-6;

/// A path through one cell, and what is seen along it.
pub struct Smooth {
    /// The name of the field along the path, such as `ramp`.
    pub name: &'static str,
    volume: Volume,
    toward: DVec3,
    /// The path's length in edges of the cell.
    edges: f64,
    /// The exact result: premultiplied colour and opacity.
    pub reference: [f64; 4],
}

impl Smooth {
    fn new(
        name: &'static str,
        corner: impl Fn(u32) -> f32,
        toward: DVec3,
        phi: impl Fn(f64) -> f64,
    ) -> Result<Self> {
        let voxels: Vec<f32> = (0..8_u32).map(corner).collect();
        let geometry = Geometry::new(DVec3::ZERO, DMat3::IDENTITY, DVec3::splat(EDGE_MM))?;
        let volume = Volume::new(
            Dims::new([2; 3])?,
            Voxels::from(voxels),
            geometry,
            Rescale::IDENTITY,
            NonFinite::Refuse,
        )?;
        let edges = toward.length();
        Ok(Self {
            name,
            volume,
            toward,
            edges,
            reference: integral(phi, EDGE_MM * edges),
        })
    }

    /// A field that rises linearly from 0 to 1 along the path.
    ///
    /// # Errors
    /// The volume is refused, as it is if there is no memory for it.
    pub fn ramp() -> Result<Self> {
        Self::new("ramp", |n| (n & 1) as f32, DVec3::X, |s| s)
    }

    /// A cubic field along the diagonal: the Bézier ordinates are the means of the corners with 0, 1, 2,
    /// 3 ones.
    ///
    /// # Errors
    /// As [`Smooth::ramp`].
    pub fn cubic() -> Result<Self> {
        let ordinates = [0.0, 1.0, 0.0, 1.0];
        let phi = move |s: f64| {
            let u = 1.0 - s;
            let bernstein = [u * u * u, 3.0 * u * u * s, 3.0 * u * s * s, s * s * s];
            (0..4).map(|i| bernstein[i] * ordinates[i]).sum()
        };
        let corner = move |n: u32| ordinates[n.count_ones() as usize] as f32;
        Self::new("cubic", corner, DVec3::ONE, phi)
    }

    /// A medium that is the same everywhere.
    ///
    /// # Errors
    /// As [`Smooth::ramp`].
    pub fn homogeneous() -> Result<Self> {
        Self::new("homogeneous", |_| 0.5, DVec3::X, |_| 0.5)
    }
}

/// The errors of one rule on one path, one for each step size.
pub struct Errors {
    /// The errors of the colour: the largest difference of its three channels.
    pub color: Vec<f64>,
    /// The errors of the opacity: its difference.
    pub opacity: Vec<f64>,
}

/// Steps of the whole path, half of it, a quarter …
pub fn halvings() -> Vec<f64> {
    (0..10).map(|i| 0.5_f64.powi(i)).collect()
}

/// The errors of a rule on the device at `steps`, shares of the path.
///
/// # Errors
/// The device fails.
pub fn errors(
    device: &Device,
    smooth: &Smooth,
    method: QuadratureMethod,
    steps: &[f64],
) -> Result<Errors> {
    let volume = &smooth.volume;
    let scene = |step: &f64| {
        let emission = Emission {
            quadrature: Quadrature::of(method),
            termination: Termination::NEVER,
            ..Emission::of(transfer()?)
        };
        let middle = DVec3::splat(0.5 * EDGE_MM);
        let mut scene = through(volume, middle, smooth.toward, emission)?;
        scene.sampling.step = StepVoxels::new(step * smooth.edges)?;
        Ok(scene)
    };
    let scenes: Vec<Scene> = steps.iter().map(scene).collect::<Result<_>>()?;
    let seen = colors(device, volume, &scenes)?;
    let opaque = |[r, g, b, _]: [f64; 4]| [r, g, b, 0.0];
    let color = |seen: &[f64; 4]| apart(opaque(*seen), opaque(smooth.reference));
    let opacity = |seen: &[f64; 4]| (seen[3] - smooth.reference[3]).abs();
    Ok(Errors {
        color: seen.iter().map(color).collect(),
        opacity: seen.iter().map(opacity).collect(),
    })
}

/// The slope between the last two errors above the floor: `None` where there are no two.
pub fn observed_order(errors: &[f64], expected: f64) -> Option<f64> {
    if expected > 5.0 {
        // Two or three steps lead from all to the floor: the steepest, the last one cut by it.
        return slopes(errors, 2.5e-8).into_iter().reduce(f64::max);
    }
    let floor = if expected > 3.0 {
        FLOOR_OF_FEW
    } else {
        FLOOR_OF_MANY
    };
    slopes(errors, floor).pop()
}

/// The slopes of the errors at halved steps, as long as they are above a floor.
fn slopes(errors: &[f64], floor: f64) -> Vec<f64> {
    let above = errors.iter().take_while(|&&e| e > floor).count();
    let pairs = errors[..above].windows(2);
    pairs.map(|pair| (pair[0] / pair[1]).log2()).collect()
}

/// One pixel that looks along `toward` through a point.
///
/// # Errors
/// A direction of no length.
pub fn through(volume: &Volume, point: DVec3, toward: DVec3, emission: Emission) -> Result<Scene> {
    let (_, radius_mm) = volume.bounding_sphere();
    let toward = toward.normalize_or_zero();
    let camera = Camera::look_at(
        point - toward * (4.0 * radius_mm),
        point,
        toward.any_orthonormal_vector(),
        Lens::Orthographic { height_mm: 1e-6 },
    )?;
    Ok(Scene {
        size: ImageSize::new(1, 1)?,
        camera,
        picture: Picture::Emission(emission),
        clip_planes: Vec::new(),
        sampling: Default::default(),
        anti_aliasing: Default::default(),
        sparse: None,
        lights: vec![Default::default()],
        ambient_occlusion: None,
        shadows: None,
        depth_of_field: None,
        depth_cues: None,
        gradient: Default::default(),
        tone: Default::default(),
    })
}

/// The colours of a volume's scenes, the first pixel of each.
///
/// # Errors
/// The device fails.
pub fn colors(device: &Device, volume: &Volume, scenes: &[Scene]) -> Result<Vec<[f64; 4]>> {
    let octree = Octree::build(volume, Leaf::default(), &Silent)?;
    let mut renderer = Renderer::new(device, volume, &octree, Options::default())?;
    let scenes = scenes.iter();
    scenes
        .map(|scene| {
            let frame = renderer.render(scene, Wanted::NONE)?.frame;
            Ok(frame.color[0].map(f64::from))
        })
        .collect()
}

/// The largest difference of any channel.
pub fn apart(a: [f64; 4], b: [f64; 4]) -> f64 {
    (0..4).fold(0.0, |max, c| f64::max(max, (a[c] - b[c]).abs()))
}

fn transfer() -> Result<TransferFunction> {
    let knot = |value, (color, opacity)| Knot {
        value,
        color: Rgb(color),
        opacity,
    };
    TransferFunction::new(vec![knot(0.0, NEAR), knot(1.0, FAR)], UNIT_MM)
}

/// Colour and opacity of a path through a field that is `phi` of its share: Simpson's rule in double
/// precision on panels so short that 14 digits stand.
fn integral(phi: impl Fn(f64) -> f64, length_mm: f64) -> [f64; 4] {
    const PANELS: u32 = 1 << 13;
    let h = 1.0 / f64::from(PANELS);
    let absorption = |s: f64| {
        let opacity = NEAR.1 + (FAR.1 - NEAR.1) * phi(s);
        -(-opacity).ln_1p() * length_mm / UNIT_MM
    };
    let mut depth = 0.0;
    let mut seen = [0.0; 4];
    for panel in 0..PANELS {
        let s = f64::from(panel) * h;
        let [a, b, c] = [s, s + 0.5 * h, s + h].map(absorption);
        let middle = depth + h / 24.0 * (5.0 * a + 8.0 * b - c);
        let end = depth + h / 6.0 * (a + 4.0 * b + c);
        for (channel, sum) in seen.iter_mut().enumerate().take(3) {
            let light = |s: f64, absorption: f64, depth: f64| {
                let color = NEAR.0[channel] + (FAR.0[channel] - NEAR.0[channel]) * phi(s);
                color * absorption * (-depth).exp()
            };
            *sum += h / 6.0
                * (light(s, a, depth) + 4.0 * light(s + 0.5 * h, b, middle) + light(s + h, c, end));
        }
        depth = end;
    }
    seen[3] = -(-depth).exp_m1();
    seen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_is_the_closed_form() {
        // Depth of a ramp of opacity from a to b: the antiderivative of -ln(1 - x) is
        // (1-x) ln(1-x) + x.
        let whole = |x: f64| (1.0 - x) * (1.0 - x).ln() + x;
        let depth = (whole(FAR.1) - whole(NEAR.1)) / (FAR.1 - NEAR.1) * EDGE_MM / UNIT_MM;
        let opacity = integral(|s| s, EDGE_MM)[3];
        assert!((opacity + (-depth).exp_m1()).abs() < 1e-12);
        assert!((opacity + (-1.000_001 * depth).exp_m1()).abs() > 1e-12);
        // A homogeneous medium's colour, whatever the rule.
        let constant = integral(|_| 0.0, EDGE_MM);
        assert!((constant[0] - NEAR.0[0] * constant[3]).abs() < 1e-12);
    }
}
