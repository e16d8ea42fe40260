//! The observed order of convergence of each fixed-step rule on smooth scenes: one cell, in which
//! the field is linear or a cubic along the ray, under a transfer function that is linear over all
//! of it. `cargo nextest run --test quadrature --no-capture | grep '|'` prints it.

use angioray::scene::{Emission, Quadrature, QuadratureMethod, TransferFunction};
use angioray::volume::{Geometry, Volume};
use glam::{DMat3, DVec3};

use crate::common::{self, volume_with};
use crate::{apart, colors, knot, through};

const EDGE_MM: f64 = 8.0;
const UNIT_MM: f64 = 3.0;
const NEAR: ([f64; 3], f64) = ([0.9, 0.2, 0.4], 0.1);
const FAR: ([f64; 3], f64) = ([0.1, 0.6, 0.8], 0.6);

/// One cell with its eight corners.
fn cell(corner: impl Fn(f64, f64, f64) -> f32) -> Volume {
    let spacing = DVec3::splat(EDGE_MM);
    let geometry = Geometry::new(DVec3::ZERO, DMat3::IDENTITY, spacing).unwrap();
    volume_with([2, 2, 2], geometry, corner)
}

fn transfer() -> TransferFunction {
    TransferFunction::new(
        vec![knot(0.0, NEAR.0, NEAR.1), knot(1.0, FAR.0, FAR.1)],
        UNIT_MM,
    )
    .unwrap()
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

/// Below this, rounding decides: of sums of few panels, and of many.
const FLOOR_OF_FEW: f64 = 4e-7;
const FLOOR_OF_MANY: f64 = 3e-6;

/// The slopes of the errors at halved steps, as long as they are above a floor.
fn slopes(errors: &[f64], floor: f64) -> Vec<f64> {
    let above = errors.iter().take_while(|&&e| e > floor).count();
    let pairs = errors[..above].windows(2);
    pairs.map(|pair| (pair[0] / pair[1]).log2()).collect()
}

/// The slope between the last two errors above the floor: `None` where there are no two.
fn observed_order(errors: &[f64], expected: f64) -> Option<f64> {
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

struct Smooth {
    name: &'static str,
    volume: Volume,
    point: DVec3,
    toward: DVec3,
    /// The path's length in edges of the cell.
    edges: f64,
    truth: [f64; 4],
}

fn ramp() -> Smooth {
    Smooth {
        name: "ramp",
        volume: cell(|x, _, _| x as f32),
        point: DVec3::splat(0.5 * EDGE_MM),
        toward: DVec3::X,
        edges: 1.0,
        truth: integral(|s| s, EDGE_MM),
    }
}

/// Along the diagonal: the Bézier ordinates are the means of the corners with 0, 1, 2, 3 ones.
fn cubic() -> Smooth {
    let ordinates = [0.0, 1.0, 0.0, 1.0];
    let phi = move |s: f64| {
        let u = 1.0 - s;
        let bernstein = [u * u * u, 3.0 * u * u * s, 3.0 * u * s * s, s * s * s];
        (0..4).map(|i| bernstein[i] * ordinates[i]).sum()
    };
    Smooth {
        name: "cubic",
        volume: cell(move |x, y, z| ordinates[(x + y + z) as usize] as f32),
        point: DVec3::splat(0.5 * EDGE_MM),
        toward: DVec3::ONE,
        edges: 3.0_f64.sqrt(),
        truth: integral(phi, EDGE_MM * 3.0_f64.sqrt()),
    }
}

/// Errors of colour and of opacity at steps of the whole path, half of it, a quarter …
fn errors(scene: &Smooth, method: QuadratureMethod) -> Option<(Vec<f64>, Vec<f64>)> {
    let device = common::device()?;
    let steps: Vec<f64> = (0..10).map(|i| 0.5_f64.powi(i)).collect();
    let scenes: Vec<_> = steps
        .iter()
        .map(|&step| {
            let emission = Emission {
                quadrature: Quadrature::of(method),
                termination: 1.0,
                ..Emission::of(transfer())
            };
            let mut view = through(&scene.volume, scene.point, scene.toward, emission);
            view.sampling.step_voxels = step * scene.edges;
            view
        })
        .collect();
    let seen = colors(&device, &scene.volume, &scenes);
    let color = |seen: &[f64; 4]| {
        let [r, g, b, _] = *seen;
        apart(
            [r, g, b, 0.0],
            [scene.truth[0], scene.truth[1], scene.truth[2], 0.0],
        )
    };
    let opacity = |seen: &[f64; 4]| (seen[3] - scene.truth[3]).abs();
    Some((
        seen.iter().map(color).collect(),
        seen.iter().map(opacity).collect(),
    ))
}

/// What each rule is known to have; preintegration takes the field for linear, as on the ramp it is.
const ORDERS: [(QuadratureMethod, f64); 6] = [
    (QuadratureMethod::Riemann, 1.0),
    (QuadratureMethod::Midpoint, 2.0),
    (QuadratureMethod::Simpson, 4.0),
    (QuadratureMethod::Romberg, 6.0),
    (QuadratureMethod::Rk4, 4.0),
    (QuadratureMethod::Preintegrated, 2.0),
];

#[test]
fn every_rule_converges_with_its_order() {
    for scene in [ramp(), cubic()] {
        for (method, order) in ORDERS {
            let Some((color, opacity)) = errors(&scene, method) else {
                return;
            };
            let name = format!("{} {method}", scene.name);
            let [of_color, of_opacity] = [&color, &opacity].map(|e| observed_order(e, order));
            let print = |order: Option<f64>| order.map_or("exact".into(), |o| format!("{o:.2}"));
            println!(
                "| {name} | {} | {} | {:.1e} | {:.1e} |",
                print(of_color),
                print(of_opacity),
                color[3],
                opacity[3]
            );
            let agrees = |observed: f64, expected: f64| match expected {
                6.0 => observed >= 5.5,
                expected => (observed - expected).abs() <= 0.15,
            };
            assert!(agrees(of_color.unwrap(), order), "{name}: {color:?}");
            if scene.name == "ramp" && method == QuadratureMethod::Preintegrated {
                assert!(
                    opacity.iter().all(|&e| e < FLOOR_OF_FEW),
                    "{name}: {opacity:?}"
                );
                continue;
            }
            let of_opacity = of_opacity.unwrap();
            assert!(agrees(of_opacity, order), "{name}: {opacity:?}");
            // The control: no rule is taken for one of another order.
            for other in [1.0, 2.0, 4.0, 6.0] {
                let observed = observed_order(&opacity, other).unwrap_or(0.0);
                assert_eq!(
                    agrees(observed, other),
                    other == order,
                    "{name} {other}: {opacity:?}"
                );
            }
        }
    }
}

#[test]
fn the_integral_is_the_closed_form() {
    // Depth of a ramp of opacity from a to b: the antiderivative of -ln(1 - x) is (1-x) ln(1-x) + x.
    let whole = |x: f64| (1.0 - x) * (1.0 - x).ln() + x;
    let depth = (whole(FAR.1) - whole(NEAR.1)) / (FAR.1 - NEAR.1) * EDGE_MM / UNIT_MM;
    let opacity = integral(|s| s, EDGE_MM)[3];
    assert!((opacity + (-depth).exp_m1()).abs() < 1e-12);
    assert!((opacity + (-1.000_001 * depth).exp_m1()).abs() > 1e-12);
    // A homogeneous medium's colour, whatever the rule.
    let constant = integral(|_| 0.0, EDGE_MM);
    assert!((constant[0] - NEAR.0[0] * constant[3]).abs() < 1e-12);
}

/// Every rule is exact at any step where the medium is the same everywhere.
#[test]
fn a_homogeneous_medium_is_exact_at_any_step() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = cell(|_, _, _| 0.5);
    let truth = integral(|_| 0.5, EDGE_MM);
    let steps = [3.0, 1.0, 0.37];
    for (method, _) in ORDERS {
        let scenes = steps.map(|step| {
            let emission = Emission {
                quadrature: Quadrature::of(method),
                termination: 1.0,
                ..Emission::of(transfer())
            };
            let mut scene = through(&volume, DVec3::splat(4.0), DVec3::X, emission);
            scene.sampling.step_voxels = step;
            scene
        });
        for seen in colors(&device, &volume, &scenes) {
            let error = apart(seen, truth);
            assert!(error < 1e-6, "{method}: {error}");
        }
    }
    assert!(apart(truth, integral(|_| 0.501, EDGE_MM)) > 1e-6);
}
