//! Pictures that must not change when volume and camera change together, and opacities that must
//! not depend on how they are sampled: on the device, without any reference but arithmetic.

use crate::common;

use angioray::extent::{Dims, ImageSize};
use angioray::frame::{DEPTH, Frame, KIND, NORMAL, VALUE};
use angioray::scene::{
    Camera, Emission, Knot, Lens, Orientation, Phong, Picture, Projection, Refine, Rgb, Scene,
    StepVoxels, Termination, TransferFunction, View, Window,
};
use angioray::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};
use common::Figure::{AlphaMax, ColorMean, DepthMean, Kind, NormalMean};
use common::{Figure, on_device, volume_with};
use glam::{DMat3, DQuat, DVec3};

const DIMS: [u64; 3] = [14, 11, 17];
const SIZE_PX: u32 = 48;

/// A solid letter F of unequal arms and a bright dot: no turn or mirror image of it is itself.
fn lettered(x: f64, y: f64, z: f64) -> u8 {
    let within = |v: f64, low: f64, high: f64| (low..=high).contains(&v);
    let stem = within(x, 3.0, 5.0) && within(z, 2.0, 14.0);
    let top = within(x, 3.0, 11.0) && within(z, 12.0, 14.0);
    let arm = within(x, 3.0, 9.0) && within(z, 7.0, 9.0);
    let letter = within(y, 3.0, 5.0) && (stem || top || arm);
    let dot = (x - 9.0).hypot(y - 8.0).hypot(z - 4.0) < 1.6;
    if dot {
        250
    } else if letter {
        200
    } else {
        // A slope, so that nothing is plain.
        (2.0 * x + y + 0.5 * z) as u8
    }
}

fn geometry() -> Geometry {
    Geometry::new(
        DVec3::new(3.0, -4.0, 5.0),
        DMat3::IDENTITY,
        DVec3::new(1.0, 1.3, 0.8),
    )
    .unwrap()
}

fn knots(low: f64, high: f64, opacity: f64, unit_mm: f64) -> TransferFunction {
    let knot = |value, grey: f64, opacity| Knot {
        value,
        color: Rgb([grey, grey * 0.8, 0.3]),
        opacity,
    };
    TransferFunction::new(vec![knot(low, 0.2, 0.0), knot(high, 0.9, opacity)], unit_mm).unwrap()
}

/// A shaded surface, a maximum, an emission.
fn pictures(unit_mm: f64) -> [Picture; 3] {
    [
        Picture::Surface {
            iso: 120.0,
            caps: true,
            refine: Refine::default(),
            color: Rgb([0.9, 0.7, 0.4]),
            phong: Some(Phong::default()),
        },
        Picture::Projection {
            of: Projection::Maximum,
            window: Window::new(0.0, 255.0).unwrap(),
        },
        Picture::Emission(Emission {
            termination: Termination::NEVER,
            ..Emission::of(knots(60.0, 220.0, 0.4, unit_mm))
        }),
    ]
}

fn scenes(volume: &Volume, camera: Camera, unit_mm: f64) -> Vec<Scene> {
    let scene = |picture| Scene {
        camera,
        ..common::scene(volume, SIZE_PX, picture)
    };
    pictures(unit_mm).map(scene).into()
}

/// What two pictures of the same content may differ by: rounding, and the samples' places.
#[rustfmt::skip]
const SAME: [&[(Figure, f64)]; 3] = [
    &[(Kind, 0.003), (DepthMean, 1e-3), (NormalMean, 0.1), (ColorMean, 1e-3)],
    &[(ColorMean, 1e-3)],
    &[(AlphaMax, 1e-2), (ColorMean, 1e-3)],
];

/// The figures above their limits, one line each.
fn differences(expected: &[Frame], frames: &[Frame], volume: &Volume) -> Vec<String> {
    let mut wrong = Vec::new();
    for ((expected, frame), limits) in expected.iter().zip(frames).zip(SAME) {
        for &(figure, limit) in limits {
            let measured = figure.of(expected, frame, volume);
            if measured > limit {
                wrong.push(format!("{figure:?} {measured:.2e} > {limit}"));
            }
        }
    }
    wrong
}

#[test]
fn volume_and_camera_turned_together_give_the_same_picture() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume_with(DIMS, geometry(), lettered);
    let camera = common::camera(&volume, common::OBLIQUE);
    let expected = on_device(&device, &volume, &scenes(&volume, camera, 1.0));
    for (axis, angle) in [
        (DVec3::new(1.0, 2.0, 3.0), 1.1),
        (DVec3::new(-3.0, 0.1, 1.0), 2.9),
    ] {
        let turn = DQuat::from_axis_angle(axis.normalize(), angle);
        let g = geometry();
        let turned = Geometry::new(
            turn * g.origin_mm(),
            DMat3::from_quat(turn) * g.direction(),
            g.spacing_mm(),
        );
        let turned = volume_with(DIMS, turned.unwrap(), lettered);
        let turned_camera = |turn: DQuat| {
            let eye = turn * camera.eye_world();
            Camera::look_at(
                eye,
                eye + turn * camera.forward(),
                turn * camera.up(),
                camera.lens(),
            )
            .unwrap()
        };
        let frames = on_device(&device, &turned, &scenes(&turned, turned_camera(turn), 1.0));
        // Normals turn along; color and depth stay.
        let back = DMat3::from_quat(turn).transpose();
        let mut upright = frames.clone();
        for normal in upright
            .iter_mut()
            .flat_map(|f| f.plane_mut(NORMAL).into_iter().flatten())
        {
            let n = back * DVec3::from_array(normal.map(f64::from));
            *normal = n.to_array().map(|c| c as f32);
        }
        let wrong = differences(&expected, &upright, &volume);
        assert!(wrong.is_empty(), "{wrong:?}");
        assert!(
            !differences(&expected, &frames, &volume).is_empty(),
            "normals not turned back"
        );
        let slightly = turn * DQuat::from_rotation_z(0.02);
        let frames = on_device(
            &device,
            &turned,
            &scenes(&turned, turned_camera(slightly), 1.0),
        );
        assert!(
            !differences(&expected, &frames, &volume).is_empty(),
            "1.1 degrees are not seen"
        );
    }
}

/// Powers of two are exact, so the pictures are the same to the last bit.
#[test]
fn twice_the_spacing_from_twice_as_far_is_the_same_picture() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume_with(DIMS, geometry(), lettered);
    let g = geometry();
    let doubled = Geometry::new(g.origin_mm() * 2.0, g.direction(), g.spacing_mm() * 2.0).unwrap();
    let doubled = volume_with(DIMS, doubled, lettered);
    let camera = common::camera(&volume, common::OBLIQUE);
    let eye = camera.eye_world() * 2.0;
    let far = Camera::look_at(eye, eye + camera.forward(), camera.up(), camera.lens()).unwrap();
    let near_frames = on_device(&device, &volume, &scenes(&volume, camera, 1.0));
    let far_frames = on_device(&device, &doubled, &scenes(&doubled, far, 2.0));
    let unit_unscaled = on_device(&device, &doubled, &scenes(&doubled, far, 1.0));
    for (near, far) in near_frames.iter().zip(&far_frames) {
        assert!(AlphaMax.of(near, far, &volume) < 1e-6);
        assert!(ColorMean.of(near, far, &volume) < 1e-6);
        assert_eq!(near.plane(KIND), far.plane(KIND));
        let depths = near
            .plane(DEPTH)
            .into_iter()
            .flatten()
            .zip(far.plane(DEPTH).into_iter().flatten());
        for (&a, &b) in depths.filter(|(a, _)| a.is_finite()) {
            assert!((b / a - 2.0).abs() < 1e-5, "{a} and {b}");
        }
    }
    assert!(AlphaMax.of(&near_frames[2], &unit_unscaled[2], &volume) > 0.05);
}

/// Where a world point is in the picture, in pixels.
fn pixel_of(camera: &Camera, p_world: DVec3, fov_deg: f64) -> (usize, usize) {
    let to = p_world - camera.eye_world();
    let per_px =
        (fov_deg.to_radians() / 2.0).tan() * to.dot(camera.forward()) * 2.0 / f64::from(SIZE_PX);
    let half = f64::from(SIZE_PX) / 2.0;
    let at = |v: f64| (half + v / per_px).floor() as usize;
    (at(to.dot(camera.right())), at(-to.dot(camera.up())))
}

#[test]
fn a_left_handed_volume_is_not_mirrored() {
    let Some(device) = common::device() else {
        return;
    };
    for mirrored in [false, true] {
        let x = if mirrored { DVec3::NEG_X } else { DVec3::X };
        let direction = DMat3::from_cols(x, DVec3::Y, DVec3::Z);
        let geometry = Geometry::new(DVec3::new(7.0, 1.0, -2.0), direction, DVec3::ONE).unwrap();
        let at = DVec3::new(12.0, 5.0, 14.0);
        let volume = volume_with(DIMS, geometry, |x, y, z| {
            if DVec3::new(x, y, z) == at { 255u8 } else { 0 }
        });
        let camera = common::camera(&volume, DVec3::NEG_Y);
        let frame = &on_device(&device, &volume, &scenes(&volume, camera, 1.0))[1];
        let (column, row) = pixel_of(
            &camera,
            geometry.world_from_index().transform_point3(at),
            30.0,
        );
        let width = SIZE_PX as usize;
        let value = |column: usize| frame.plane(VALUE).unwrap()[row * width + column];
        assert!(
            value(column) > 100.0,
            "mirrored {mirrored}: {}",
            value(column)
        );
        assert_eq!(value(width - 1 - column), 0.0, "mirrored {mirrored}");
    }
}

#[test]
fn a_whole_turn_changes_nothing() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume_with(DIMS, geometry(), lettered);
    let (center, radius_mm) = volume.bounding_sphere();
    let turned = |degrees: f64, times: usize| {
        let front = Orientation::of(View::Anterior).elevation(20.0);
        let o = (0..times).fold(front, |o, _| o.azimuth(degrees));
        let lens = Lens::Perspective { fov_deg: 30.0 };
        let eye = center + o.toward_eye * (4.0 * radius_mm);
        scenes(
            &volume,
            Camera::look_at(eye, center, o.up, lens).unwrap(),
            1.0,
        )
    };
    let expected = on_device(&device, &volume, &turned(0.0, 1));
    assert!(on_device(&device, &volume, &turned(360.0, 1)) == expected);
    assert!(on_device(&device, &volume, &turned(-720.0, 1)) == expected);
    let wrong = differences(
        &expected,
        &on_device(&device, &volume, &turned(22.5, 16)),
        &volume,
    );
    assert!(wrong.is_empty(), "{wrong:?}");
    let off = on_device(&device, &volume, &turned(361.0, 1));
    assert!(!differences(&expected, &off, &volume).is_empty());
}

/// One picture of one pixel, along a line through the volume's middle, and that pixel's opacity.
fn opacity_along(
    volume: &Volume,
    toward_eye: DVec3,
    transfer: &TransferFunction,
    steps: &[f64],
) -> Option<Vec<f64>> {
    let device = common::device()?;
    let (center, radius_mm) = volume.bounding_sphere();
    let up = toward_eye.any_orthonormal_vector();
    let lens = Lens::Orthographic { height_mm: 1e-3 };
    let eye = center + toward_eye * (2.0 * radius_mm);
    let scene = |&step_voxels: &f64| {
        let picture = Picture::Emission(Emission {
            termination: Termination::NEVER,
            ..Emission::of(transfer.clone())
        });
        let mut scene = common::scene(volume, 1, picture);
        scene.size = ImageSize::new(1, 1).unwrap();
        scene.camera = Camera::look_at(eye, center, up, lens).unwrap();
        scene.sampling.step = StepVoxels::new(step_voxels).unwrap();
        scene
    };
    let scenes: Vec<Scene> = steps.iter().map(scene).collect();
    let frames = on_device(&device, volume, &scenes);
    Some(frames.iter().map(|f| f64::from(f.color[0][3])).collect())
}

#[test]
fn opacity_depends_on_the_length_alone_whatever_spacing_direction_and_step() {
    let spacing = DVec3::new(1.0, 1.0, 10.0);
    let geometry = Geometry::new(DVec3::ZERO, DMat3::IDENTITY, spacing).unwrap();
    let dims = [41, 21, 5];
    let volume = volume_with(dims, geometry, |_, _, _| 100u8);
    let extent = DVec3::new(40.0, 20.0, 40.0);
    let transfer = knots(0.0, 200.0, 0.06, 2.0);
    let per_mm = -(1.0f64 - 0.03).ln() / 2.0;
    for along in [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        extent.normalize(),
        DVec3::new(1.0, 0.0, 0.5).normalize(),
    ] {
        // The domain is a box about the line's middle.
        let length_mm = (extent / along.abs()).min_element();
        let expected = -(-per_mm * length_mm).exp_m1();
        let Some(measured) = opacity_along(&volume, along, &transfer, &[0.13, 0.5, 1.0, 7.0])
        else {
            return;
        };
        for alpha in measured {
            assert!(
                (alpha - expected).abs() < 1e-6,
                "{along}: {alpha}, not {expected}"
            );
            let in_voxels = -(-per_mm * (extent / spacing / along.abs()).min_element()).exp_m1();
            let off = along.z.abs() > 0.9 && (alpha - in_voxels).abs() < 1e-6;
            assert!(!off, "lengths are counted in voxels");
        }
    }
}

#[test]
fn opacity_converges_at_second_order_or_better() {
    // A smooth field, sampled so finely that its trilinear kinks weigh nothing: one ramp.
    let dims = Dims::new([65, 2, 2]).unwrap();
    let ramp: Vec<f32> = (0..4).flat_map(|_| (0..65).map(|x| x as f32)).collect();
    let volume = Volume::new(
        dims,
        Voxels::from(ramp),
        Geometry::default(),
        Rescale::IDENTITY,
        NonFinite::Refuse,
    )
    .unwrap();
    let transfer = knots(0.0, 64.0, 0.95, 40.0);
    // ∫ −ln(1 − 0.95 x/64)/40 dx over 0..64, by u = 1 − 0.95 x/64: ∫ ln u du = u ln u − u.
    let f = |u: f64| u * u.ln() - u;
    let depth = (64.0 / 0.95) * (f(0.05) - f(1.0)) / 40.0;
    let expected = -(-depth).exp_m1();
    let steps = [32.0, 16.0, 8.0, 4.0];
    let Some(measured) = opacity_along(&volume, DVec3::NEG_X, &transfer, &steps) else {
        return;
    };
    let errors: Vec<f64> = measured
        .iter()
        .map(|alpha| (alpha - expected).abs())
        .collect();
    let orders: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
    println!("opacity {expected}: errors {errors:?}, orders {orders:.2?}");
    let [first, .., last] = errors[..] else {
        panic!("no errors");
    };
    assert!(first > 1e-5, "the steps are too fine to see an order");
    // Over three halvings: first order would give 8.
    assert!(first / last > 64.0, "errors {errors:?}, orders {orders:?}");
}

/// Thousands of faint samples, each a few units of single precision's last place of the sum.
#[test]
fn faint_opacities_add_up() {
    let volume = volume_with([1025, 2, 2], Geometry::default(), |_, _, _| 100u8);
    let per_mm = 1e-6;
    let transfer = knots(0.0, 200.0, 2.0 * per_mm, 1.0);
    let expected = -(1024.0 * (-per_mm).ln_1p()).exp_m1();
    let Some(measured) = opacity_along(&volume, DVec3::X, &transfer, &[0.25, 1.0]) else {
        return;
    };
    for alpha in measured {
        let error = (alpha / expected - 1.0).abs();
        println!("faint opacity {alpha}, relative error {error:.1e}");
        assert!(error < 1e-4, "{alpha}, not {expected}");
    }
}
