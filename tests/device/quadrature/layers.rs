//! A medium's layers, ∫ x κT dt / ∫ κT dt of the distance, the value and the normal: closed forms on the
//! device under every rule and on the reference; and that wanting them changes nothing else.

use angioray::frame::{DEPTH, Frame, KIND, Layer, NORMAL, STEPS, VALUE, Wanted};
use angioray::octree::Octree;
use angioray::render::{Options, Renderer};
use angioray::scene::{
    Emission, Filter, Homogeneity, HomogeneityLimit, HomogeneityRule, Phong, Picture, Quadrature,
    QuadratureMethod, Scene, StepVoxels, Termination, TransferFunction,
};
use angioray::volume::Volume;
use glam::DVec3;

use super::{knot, through};
use crate::common::{self, hash, on_device, on_reference, volume_of};

const GREY: [f64; 3] = [0.5, 0.5, 0.5];

fn transfer(points: &[(f64, f64)], unit_mm: f64) -> TransferFunction {
    let knots = points
        .iter()
        .map(|&(value, opacity)| knot(value, GREY, opacity));
    TransferFunction::new(knots.collect(), unit_mm).unwrap()
}

/// Depth, value and normal of the first pixel.
#[derive(Debug, Clone, Copy)]
struct FirstPixel {
    depth: f64,
    value: f64,
    normal: DVec3,
    kind: u32,
}

impl FirstPixel {
    fn of(frame: &Frame) -> Self {
        let [x, y, z] = frame.plane(NORMAL).unwrap()[0].map(f64::from);
        Self {
            depth: frame.plane(DEPTH).unwrap()[0].into(),
            value: frame.plane(VALUE).unwrap()[0].into(),
            normal: DVec3::new(x, y, z),
            kind: frame.plane(KIND).unwrap()[0],
        }
    }
}

/// One ray along +x through a volume, 4 bounding radii before the point that it passes, under every rule at
/// steps of `step_voxels`, and last on the reference.
fn along_x(
    volume: &Volume,
    transfer: &TransferFunction,
    step_voxels: f64,
) -> Vec<(String, FirstPixel)> {
    let Some(device) = common::device() else {
        return Vec::new();
    };
    let scene = |method| {
        let emission = Emission {
            quadrature: Quadrature::of(method),
            termination: Termination::NEVER,
            ..Emission::of(transfer.clone())
        };
        let mut scene = through(volume, DVec3::splat(0.7), DVec3::X, emission);
        scene.sampling.step = StepVoxels::new(step_voxels).unwrap();
        scene
    };
    let scenes = QuadratureMethod::ALL.map(scene);
    let frames = on_device(&device, volume, &scenes);
    let names = QuadratureMethod::ALL.map(|method| method.to_string());
    let mut all: Vec<(String, FirstPixel)> = names
        .into_iter()
        .zip(frames.iter().map(FirstPixel::of))
        .collect();
    let reference = FirstPixel::of(&on_reference(volume, &scenes[0]));
    all.push(("reference".to_owned(), reference));
    all
}

/// From the eye of [`along_x`] to where x is 0.
fn before_mm(volume: &Volume) -> f64 {
    4.0 * volume.bounding_sphere().1 - 0.7
}

/// Where light comes from on the mean in a homogeneous medium of `length` mm that absorbs `kappa` a mm.
fn mean_of_slab(kappa: f64, length: f64) -> f64 {
    let depth = kappa * length;
    length * (1.0 / depth - 1.0 / depth.exp_m1())
}

#[test]
fn a_homogeneous_slab_is_where_its_integral_says() {
    let slab = volume_of([13, 4, 4], |_, _, _| 3_u8);
    for opacity in [0.005_f64, 0.1, 0.6] {
        let kappa = -(-opacity).ln_1p() / 2.0;
        let depth = before_mm(&slab) + mean_of_slab(kappa, 12.0);
        for (rule, seen) in along_x(&slab, &transfer(&[(0.0, opacity)], 2.0), 1.3) {
            let limit = match rule.as_str() {
                "reference" => 2e-6, // single precision of the plane
                // Of the rules that look inside their panels, the error of their order.
                "simpson" | "rk4" => 3e-3,
                _ => 5e-5,
            };
            assert!(
                (seen.depth - depth).abs() < limit,
                "{rule} {opacity}: {seen:?} {depth}"
            );
            assert!((seen.value - 3.0).abs() < 1e-5, "{rule}: {seen:?}");
            // No gradient: toward the eye.
            assert!(
                seen.normal.distance(DVec3::NEG_X) < 1e-6,
                "{rule}: {seen:?}"
            );
            assert_eq!(seen.kind, 1);
            // The control: the middle.
            assert!((before_mm(&slab) + 6.0 - depth).abs() > 1e-2);
        }
    }
}

#[test]
fn what_is_hardly_seen_has_no_layers() {
    let slab = volume_of([13, 4, 4], |_, _, _| 3_u8);
    for (share, kind) in [(0.99_f64, 0), (1.01, 1)] {
        let opacity = 1.0 - (1.0 - 0.01 * share).powf(1.0 / 12.0);
        for (rule, seen) in along_x(&slab, &transfer(&[(0.0, opacity)], 1.0), 0.5) {
            assert_eq!(seen.kind, kind, "{rule}: {seen:?}");
            assert_eq!(seen.depth.is_finite(), kind == 1, "{rule}: {seen:?}");
            assert_eq!(
                (seen.value == 0.0, seen.normal == DVec3::ZERO),
                (kind == 0, kind == 0)
            );
        }
    }
}

/// Two sheets where a ramp has the values 3.3 and 8.6: the mean of their places, each by its light.
#[test]
fn two_thin_sheets_have_the_mean_of_their_places() {
    let ramp = volume_of([13, 4, 4], |x, _, _| x as u8);
    let (half, opacity) = (0.02, 0.45_f64);
    let band = |at: f64| {
        [
            (at - half, 0.0),
            (at - half, opacity),
            (at + half, opacity),
            (at + half, 0.0),
        ]
    };
    let points = [band(3.3), band(8.6)].concat();
    let tf = transfer(&points, 2.0 * half);
    let (near, far) = (opacity, (1.0 - opacity) * opacity);
    let mean = (3.3 * near + 8.6 * far) / (near + far);
    let mut missed = 0;
    for (rule, seen) in along_x(&ramp, &tf, 0.5) {
        let off = (seen.value - mean)
            .abs()
            .max((seen.depth - before_mm(&ramp) - mean).abs());
        match rule.as_str() {
            // Within a sheet's thickness, in which its own light is not spread evenly.
            "reference" | "adaptive" | "preintegrated" => {
                assert!(off < 0.01, "{rule}: {seen:?} {mean}")
            }
            _ => missed += usize::from(off.is_nan() || off >= 0.01),
        }
    }
    // The control: rules that sample points alone miss a sheet, or take one for thicker than it is.
    assert!(missed >= 4 || common::device().is_none(), "{missed}");
}

#[test]
fn a_plane_has_its_normal_from_everywhere() {
    let Some(device) = common::device() else {
        return;
    };
    let slope = DVec3::new(-2.0, 1.0, -1.0); // rises away from the eye
    let plane = volume_of([16, 15, 14], |x, y, z| {
        (slope.dot(DVec3::new(x, y, z)) + 50.0) as u8
    });
    let tf = transfer(&[(33.0, 0.0), (35.0, 0.95)], 1.0);
    let picture = |method| {
        Picture::Emission(Emission {
            quadrature: Quadrature::of(method),
            ..Emission::of(tf.clone())
        })
    };
    let scenes = QuadratureMethod::ALL.map(|method| common::scene(&plane, 24, picture(method)));
    let mut frames = on_device(&device, &plane, &scenes);
    frames.push(on_reference(&plane, &scenes[0]));
    let normal = -slope.normalize();
    for frame in &frames {
        let seen = frame
            .plane(KIND)
            .into_iter()
            .flatten()
            .zip(frame.plane(NORMAL).into_iter().flatten());
        let seen: Vec<DVec3> = seen
            .filter(|(kind, _)| **kind == 1)
            .map(|(_, n)| DVec3::from_array(n.map(f64::from)))
            .collect();
        assert!(seen.len() > 100, "{}", seen.len());
        // But for rays that meet it where it comes to the volume's faces: differences there are one-sided.
        let exact = seen.iter().filter(|n| n.distance(normal) < 1e-4).count();
        assert!(exact * 3 > seen.len(), "{exact} of {}", seen.len());
        assert!(seen.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
        let turned = seen.iter().filter(|n| n.distance(slope.normalize()) < 1e-4);
        assert_eq!(turned.count(), 0);
    }
}

/// Every rule; some shaded, with the nearest filter, with leaves that are homogeneous.
fn emissions(volume: &Volume) -> Vec<Scene> {
    let tf = transfer(&[(60.0, 0.0), (140.0, 0.4), (220.0, 0.9)], 2.0);
    let scene = |method, phong, limit: Option<f64>, filter| {
        let rule = HomogeneityRule::Range;
        let emission = Emission {
            phong,
            quadrature: Quadrature::of(method),
            homogeneity: limit.map(|limit| Homogeneity {
                rule,
                limit: HomogeneityLimit::new(limit).unwrap(),
            }),
            ..Emission::of(tf.clone())
        };
        let mut scene = common::scene(volume, 32, Picture::Emission(emission));
        scene.sampling.filter = filter;
        scene
    };
    let plain = |method| scene(method, None, None, Filter::Linear);
    let mut scenes = QuadratureMethod::ALL.map(plain).to_vec();
    for method in [QuadratureMethod::Simpson, QuadratureMethod::Adaptive] {
        scenes.push(scene(method, Some(Phong::default()), None, Filter::Linear));
        scenes.push(scene(method, None, None, Filter::Nearest));
    }
    let preintegrated = QuadratureMethod::Preintegrated;
    scenes.push(scene(preintegrated, None, None, Filter::Nearest));
    scenes.push(scene(
        QuadratureMethod::Simpson,
        None,
        Some(0.1),
        Filter::Linear,
    ));
    scenes
}

/// Each layer, or those that are made together, alone.
const ALONE: [Wanted; 3] = [
    Wanted::NONE.with([Layer::Depth]),
    Wanted::NONE.with([Layer::Normal]),
    Wanted::NONE.with([Layer::Value, Layer::Kind]),
];

#[test]
fn wanting_layers_changes_no_bit_of_the_colours_and_no_sample() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume_of([25, 22, 27], |x, y, z| {
        let tube = (x - 12.0).hypot(z - 13.0) < 7.0;
        (if tube { 190.0 } else { 0.0 } + 20.0 * hash(x, y, z)) as u8
    });
    let octree: Octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    for (n, scene) in emissions(&volume).iter().enumerate() {
        let mut render = |wanted| renderer.render(scene, wanted).unwrap().frame;
        let (plain, all) = (render(Wanted::NONE), render(Wanted::ALL));
        let what = format!("{:?} {:?}", scene.picture, scene.sampling.filter);
        assert!(plain.layers.iter().next().is_none());
        assert!(plain.color == all.color, "{what}");
        if QuadratureMethod::ALL.get(n) != Some(&QuadratureMethod::Simpson) {
            continue;
        }
        let counted = render(Wanted::NONE.with(Layer::COUNTERS));
        assert!(counted.plane(STEPS) == all.plane(STEPS), "{what}");
        for wanted in ALONE {
            let alone = render(wanted);
            assert!(alone.color == all.color, "{what}");
            for (layer, plane) in alone.layers.iter() {
                assert!(Some(plane) == all.layers.get(layer), "{what} {layer:?}");
            }
            assert!(alone.layers.iter().next().is_some());
        }
    }
    let scene = &emissions(&volume)[0];
    let reference = on_reference(&volume, scene);
    let bare =
        angioray::reference::render(&volume, scene, Wanted::NONE, &angioray::progress::Silent);
    assert!(bare.unwrap().color == reference.color);
}
