//! `--screen-error`: pixels that are not cast are within the error of the whole picture's, none is lost, and what is cast
//! is the whole picture's to the last bit.

use angioray::extent::ImageSize;
use angioray::frame::{CAST, CERTIFICATE, Certificate, DEPTH, Frame, KIND, NORMAL, VALUE, Wanted};
use angioray::render::{Lanes, Options, Renderer, Rendering};
use angioray::scene::{
    Camera, ClipPlane, Filter, Lens, Mode, Picture, Quadrature, Refill, SamplingMethod, Scene,
    ScreenError, Sparse, SparseGrid, Traverse,
};
use angioray::volume::{Geometry, Volume};
use glam::{DMat3, DVec3};

use super::invariance::{pictures, tubes};
use crate::common;

/// No multiple of any block.
const SIZE_PX: u32 = 203;

fn within(error: f64, spacing: Option<u32>, mode: Mode) -> Sparse {
    let grid = spacing.map(|spacing| SparseGrid::new(spacing, None).unwrap());
    let error = ScreenError::new(error).unwrap();
    Sparse::new(grid, None, Some(error), mode).unwrap()
}

fn with(scene: &Scene, sparse: Sparse) -> Scene {
    Scene {
        sparse: Some(sparse),
        ..scene.clone()
    }
}

fn render(renderer: &mut Renderer, scene: &Scene) -> Rendering {
    renderer.render(scene, Wanted::ALL).unwrap()
}

fn was_cast(frame: &Frame) -> Vec<bool> {
    let marks = frame.plane(CAST).expect("a sparse picture has the layer");
    assert!(marks.iter().all(|&mark| mark <= 1));
    marks.iter().map(|&mark| mark == 1).collect()
}

/// Bent smooth surfaces: a ball with a dent beside a plate; mm, x at other distances than y and z.
fn smooth() -> Volume {
    let spacing_mm = DVec3::new(1.4, 1.0, 0.9);
    let geometry = Geometry::new(DVec3::ZERO, DMat3::IDENTITY, spacing_mm).unwrap();
    common::volume_with([41, 60, 52], geometry, |x, y, z| {
        let p = DVec3::new(1.4 * x, y, 0.9 * z);
        let ball = 20.0 - p.distance(DVec3::new(28.0, 30.0, 22.0));
        let dent = p.distance(DVec3::new(28.0, 12.0, 22.0)) - 9.0;
        let plate = 3.0 - (p.z - 43.0 + 0.05 * p.x).abs();
        (10.0 * ball.min(dent).max(plate).clamp(-8.0, 8.0)) as f32
    })
}

/// Perspective and parallel, from aside and near, from inside, cut.
fn views(scene: &Scene, volume: &Volume) -> Vec<Scene> {
    let (center, radius_mm) = volume.bounding_sphere();
    let seen = |camera| Scene {
        camera,
        ..scene.clone()
    };
    let toward = DVec3::new(0.3, -1.0, 0.2).normalize();
    let height_mm = 1.2 * radius_mm;
    let parallel = Lens::Orthographic { height_mm };
    let near = Lens::Perspective { fov_deg: 70.0 };
    let at = |distance: f64, lens| {
        Camera::look_at(
            center + distance * radius_mm * toward,
            center,
            DVec3::Z,
            lens,
        )
        .unwrap()
    };
    let cut = Scene {
        clip_planes: vec![ClipPlane::new(DVec3::new(0.2, 1.0, 0.1), -0.45 * radius_mm).unwrap()],
        ..scene.clone()
    };
    vec![
        scene.clone(),
        seen(at(3.0, parallel)),
        seen(at(1.05, near)),
        seen(at(0.3, near)),
        cut,
    ]
}

fn exact(volume: &Volume, picture: Picture) -> Scene {
    let mut scene = common::scene(volume, SIZE_PX, picture);
    if !matches!(scene.picture, Picture::Emission(_)) {
        scene.sampling.method = SamplingMethod::Exact;
    }
    scene
}

fn surface(volume: &Volume) -> Scene {
    let mut picture = pictures(volume.range().max).swap_remove(0);
    if let Picture::Surface { iso, .. } = &mut picture {
        *iso = 0.0;
    }
    exact(volume, picture)
}

/// The greatest difference of depths in mm; panics where one met something else than the other.
fn depth_apart(frame: &Frame, whole: &Frame) -> f64 {
    assert_eq!(frame.plane(KIND), whole.plane(KIND));
    let depths = frame.plane(DEPTH).unwrap().iter();
    let pairs = depths.zip(whole.plane(DEPTH).unwrap());
    let apart = pairs.map(|(&a, &b)| {
        if a == b {
            0.0
        } else {
            f64::from((a - b).abs())
        }
    });
    apart.fold(0.0, f64::max)
}

/// Pixels that hit, but were not cast.
fn interpolated(frame: &Frame) -> Vec<usize> {
    let kinds = frame.plane(KIND).unwrap();
    let cast = was_cast(frame);
    let pixels = (0..cast.len()).filter(|&pixel| !cast[pixel] && kinds[pixel] != 0);
    pixels.collect()
}

#[test]
fn smooth_pieces_of_a_surface_are_interpolated_within_the_error() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = smooth();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let smallest_mm = 0.9;
    let (mut filled, mut worst) = (0, 0.0f64);
    for scene in views(&surface(&volume), &volume) {
        let whole = render(&mut renderer, &scene).frame;
        for (spacing, error) in [(3, 0.02), (4, 0.05), (8, 0.05), (8, 0.5)] {
            let rule = within(error, Some(spacing), Mode::Iso);
            let frame = render(&mut renderer, &with(&scene, rule)).frame;
            let apart = depth_apart(&frame, &whole);
            // Beside the interpolation's error that of the hits themselves.
            assert!(
                apart <= error * smallest_mm + 2e-4,
                "{spacing} {error}: {apart}"
            );
            worst = worst.max(apart / (error * smallest_mm));
            let pixels = interpolated(&frame);
            filled += pixels.len();
            assert_interpolated(&frame, &whole, &pixels, error);
        }
    }
    assert!(filled > 20_000, "{filled}");
    // The bound is not out of proportion.
    assert!(worst > 0.2, "{worst}");
    // The control: a grid without proof is wrong by more, where it does not miss.
    let scene = surface(&volume);
    let whole = render(&mut renderer, &scene).frame;
    let grid = SparseGrid::new(8, None).unwrap();
    let unproven = Sparse::new(Some(grid), Some(Refill::None), None, Mode::Iso).unwrap();
    let frame = render(&mut renderer, &with(&scene, unproven)).frame;
    assert_ne!(frame.plane(KIND), whole.plane(KIND));
}

/// Holds what interpolated pixels show beside their depth against the whole picture.
fn assert_interpolated(frame: &Frame, whole: &Frame, pixels: &[usize], error: f64) {
    let normals = |frame: &Frame, pixel: usize| {
        DVec3::from(frame.plane(NORMAL).unwrap()[pixel].map(f64::from))
    };
    let mut turned = 0.0;
    for &pixel in pixels {
        assert_eq!(
            frame.plane(CERTIFICATE).unwrap()[pixel],
            Certificate::Hit as u32
        );
        assert_eq!(frame.plane(VALUE).unwrap()[pixel], 0.0);
        turned += 1.0 - normals(frame, pixel).dot(normals(whole, pixel));
    }
    // Gradients are continuous, so that near points have near normals, but for a few at kinks.
    assert!(
        turned <= 0.02 * error.max(0.1) * pixels.len() as f64,
        "{turned}"
    );
}

#[test]
fn what_one_voxel_hides_or_a_plane_cuts_is_not_interpolated_over() {
    let Some(device) = common::device() else {
        return;
    };
    // A spike of one voxel before a smooth wall: blocks over it are cast.
    let volume = common::volume_of([40, 40, 40], |x, y, z| {
        let spike = x == 20.0 && y == 6.0 && z == 20.0;
        if spike {
            200.0
        } else {
            (10.0 * (y - 25.0)).clamp(-50.0, 50.0) as f32
        }
    });
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    for scene in views(&surface(&volume), &volume) {
        let whole = render(&mut renderer, &scene).frame;
        let frame = render(
            &mut renderer,
            &with(&scene, within(0.05, Some(8), Mode::Iso)),
        )
        .frame;
        assert!(depth_apart(&frame, &whole) <= 0.05 + 2e-4);
    }
    // The control: the wall alone is interpolated.
    let frame = render(
        &mut renderer,
        &with(&surface(&volume), within(0.05, Some(8), Mode::Iso)),
    );
    let filled = interpolated(&frame.frame).len();
    assert!(filled > 300, "{filled}");
}

#[test]
fn fixed_steps_and_nearest_voxels_are_left_out_only_where_they_show_nothing() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = smooth();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut nearest = surface(&volume);
    nearest.sampling.filter = Filter::Nearest;
    let mut fixed = surface(&volume);
    fixed.sampling.method = SamplingMethod::Fixed;
    for scene in [nearest, fixed] {
        let whole = render(&mut renderer, &scene).frame;
        let frame = render(
            &mut renderer,
            &with(&scene, within(0.5, Some(8), Mode::Iso)),
        )
        .frame;
        assert_eq!(frame.color, whole.color);
        assert_eq!(frame.plane(DEPTH), whole.plane(DEPTH));
        assert!(interpolated(&frame).is_empty());
        assert!(was_cast(&frame).contains(&false));
    }
}

/// A thick fog that hardly changes.
fn fog() -> Volume {
    common::volume_of([48, 44, 40], |x, y, _| {
        (110.0 + 1.4 * x + 8.0 * (0.1 * y).sin()) as f32
    })
}

/// The pixels that were not cast within an error, and the greatest difference: of values as a share of their range, of a
/// medium in a channel of linear light.
fn apart_within(renderer: &mut Renderer, scene: &Scene, whole: &Frame, error: f64) -> (usize, f64) {
    let mode = scene.picture.mode();
    let range = renderer.volume().range();
    let frame = render(renderer, &with(scene, within(error, None, mode))).frame;
    let filled = was_cast(&frame).iter().filter(|&&cast| !cast).count();
    let apart = if mode == Mode::Dvr {
        color_apart(&frame, whole)
    } else {
        assert_eq!(frame.plane(KIND), whole.plane(KIND));
        value_apart(&frame, whole) / range.width()
    };
    (filled, apart)
}

#[test]
fn values_and_light_are_within_the_error() {
    let Some(device) = common::device() else {
        return;
    };
    for n in 1..pictures(1.0).len() {
        let is_medium = n >= 5;
        let volume = if is_medium { fog() } else { tubes() };
        let octree = common::octree(&volume);
        let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
        let mut base = exact(&volume, pictures(volume.range().max).swap_remove(n));
        if let Picture::Emission(emission) = &mut base.picture {
            emission.quadrature = Quadrature::adaptive(1e-4).unwrap();
        }
        // Beside the error the quadrature's own.
        let own = if is_medium { 2e-4 } else { 1e-6 };
        let (mut filled, mut worst) = (0, 0.0f64);
        for scene in views(&base, &volume) {
            let whole = render(&mut renderer, &scene).frame;
            for error in [0.01, 0.2] {
                let (left_out, apart) = apart_within(&mut renderer, &scene, &whole, error);
                assert!(apart <= error + own, "{n} {error}: {apart}");
                filled += left_out;
                worst = worst.max(apart / error);
            }
        }
        assert!(filled > 10_000, "{n}: {filled}");
        // The bound is not out of proportion, but for light that may come from anywhere.
        assert!(worst > 0.02 || n == 6, "{n}: {worst}");
    }
}

fn color_apart(a: &Frame, b: &Frame) -> f64 {
    let channels = a.color.iter().flatten().zip(b.color.iter().flatten());
    channels
        .map(|(a, b)| f64::from((a - b).abs()))
        .fold(0.0, f64::max)
}

fn value_apart(a: &Frame, b: &Frame) -> f64 {
    let values = a.plane(VALUE).unwrap().iter().zip(b.plane(VALUE).unwrap());
    values
        .map(|(a, b)| f64::from((a - b).abs()))
        .fold(0.0, f64::max)
}

#[test]
fn a_grid_without_proof_is_wrong_by_more() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let width = volume.range().max - volume.range().min;
    for n in [1, 5] {
        let scene = exact(&volume, pictures(volume.range().max).swap_remove(n));
        let whole = render(&mut renderer, &scene).frame;
        let grid = SparseGrid::new(8, None).unwrap();
        let unproven =
            Sparse::new(Some(grid), Some(Refill::None), None, scene.picture.mode()).unwrap();
        let frame = render(&mut renderer, &with(&scene, unproven)).frame;
        let apart = if n == 1 {
            value_apart(&frame, &whole) / width
        } else {
            color_apart(&frame, &whole)
        };
        assert!(apart > 0.2, "{n}: {apart}");
    }
}

#[test]
fn nothing_else_changes_a_bit() {
    let Some(device) = common::device() else {
        return;
    };
    let picture = |volume: &Volume, options: Options, scene: &Scene| {
        let octree = common::octree(volume);
        let mut renderer = Renderer::new(&device, volume, &octree, options).unwrap();
        let mut frame = render(&mut renderer, scene).frame;
        for key in [angioray::frame::STEPS, angioray::frame::NODES] {
            frame.layers.take(key);
        }
        frame
    };
    for (n, volume) in [(0, smooth()), (1, tubes()), (5, fog())] {
        let base = match n {
            0 => surface(&volume),
            _ => exact(&volume, pictures(volume.range().max).swap_remove(n)),
        };
        let scene = with(&base, within(0.05, None, base.picture.mode()));
        let base = picture(&volume, Options::default(), &scene);
        let others = Options {
            lanes: Some(Lanes::ONE),
            work_group: Some([2, 3]),
        };
        assert!(base.bit_equal(&picture(&volume, others, &scene)), "{n}");
        let mut walked = scene.clone();
        walked.sampling.traverse = Traverse::Hierarchical;
        assert!(
            base.bit_equal(&picture(&volume, Options::default(), &walked)),
            "{n}"
        );
        // The control: another error is another picture.
        let other = with(&scene, within(0.6, None, scene.picture.mode()));
        assert!(
            !base.bit_equal(&picture(&volume, Options::default(), &other)),
            "{n}"
        );
    }
}

#[test]
fn pictures_narrower_than_a_block_are_whole() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = smooth();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    for (width, height) in [(1, 1), (1, 9), (7, 2), (33, 5), (9, 8)] {
        let scene = Scene {
            size: ImageSize::new(width, height).unwrap(),
            ..surface(&volume)
        };
        let whole = render(&mut renderer, &scene).frame;
        let frame = render(&mut renderer, &with(&scene, within(0.05, None, Mode::Iso))).frame;
        assert!(depth_apart(&frame, &whole) <= 0.05);
    }
}
