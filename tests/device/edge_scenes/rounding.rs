//! Values so far apart that the rounding of the greater is more than the smaller: rounding neither makes
//! a surface nor loses one, and no projection leaves the range of the voxels.

use std::path::Path;

use angioray::extent::ImageSize;
use angioray::frame::{DEPTH, Frame, KIND, Kind, VALUE};
use angioray::progress::Silent;
use angioray::reference::Tracer;
use angioray::scene::{Camera, Lens, Picture, Projection, SamplingMethod, Scene, Window};
use angioray::volume::{ReadOptions, Volume, read};
use glam::DVec3;

use super::surface;
use crate::common::{self, hash, on_device, on_reference, volume_of};

/// Voxels of 1e30 and 1e-30, at random.
fn extremes() -> Volume {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/cases/ref-extremes.nrrd");
    read(&path, &ReadOptions::default(), &Silent).unwrap()
}

/// The same with 0 for the smaller and 1 for the greater: numbers whose rounding is no matter.
fn plain(volume: &Volume) -> Volume {
    let [nx, ny, _] = volume.dims().usize();
    volume_of(volume.dims().array().map(u64::from), |x, y, z| {
        let index = x as usize + nx * (y as usize + ny * z as usize);
        u8::from(volume.voxels().stored(index) > volume.voxels().stored(0) * 0.5)
    })
}

/// From inside in six directions, and from outside.
fn cameras(volume: &Volume) -> Vec<Camera> {
    let eye = DVec3::new(5.0, 4.5, 4.0);
    let wide = Lens::Perspective { fov_deg: 120.0 };
    let mut cameras: Vec<Camera> = DVec3::AXES
        .into_iter()
        .flat_map(|axis| [axis, -axis])
        .map(|axis| {
            Camera::look_at(eye, eye + axis, DVec3::new(axis.z, axis.x, axis.y), wide).unwrap()
        })
        .collect();
    cameras.push(common::camera(volume, common::OBLIQUE));
    cameras
}

fn scene(volume: &Volume, camera: Camera, picture: Picture, method: SamplingMethod) -> Scene {
    let mut scene = common::scene(volume, 1, picture);
    scene.size = ImageSize::new(24, 21).unwrap();
    scene.camera = camera;
    scene.sampling.method = method;
    scene
}

fn hits(frame: &Frame) -> usize {
    let kinds = frame.plane(KIND).unwrap();
    kinds
        .iter()
        .filter(|kind| **kind != Kind::Nothing as u32)
        .count()
}

#[test]
fn at_the_minimum_there_is_no_surface() {
    let volume = extremes();
    let range = volume.range();
    let device = common::device();
    let mut seen = 0;
    let inside = &cameras(&volume)[..6];
    for (n, &camera) in inside.iter().enumerate() {
        for method in [SamplingMethod::Exact, SamplingMethod::Fixed] {
            // Twice at the minimum, then the control.
            let isos = [(range.min, true), (range.min, false), (1e20, true)];
            let scenes = isos.map(|(iso, caps)| scene(&volume, camera, surface(iso, caps), method));
            let by_reference = scenes.iter().map(|scene| on_reference(&volume, scene));
            let mut frames: Vec<(&str, Frame)> =
                by_reference.map(|frame| ("reference", frame)).collect();
            if let Some(device) = &device {
                let by_device = on_device(device, &volume, &scenes).into_iter();
                frames.extend(by_device.map(|frame| ("device", frame)));
            }
            for three in frames.chunks(3) {
                let found: Vec<usize> = three.iter().map(|(_, frame)| hits(frame)).collect();
                assert_eq!(found[..2], [0, 0], "{n} {method:?} {}", three[0].0);
                seen += found[2];
            }
        }
    }
    assert!(seen > 1000, "{seen}");
}

/// What the reference sees of two volumes, of which the second has the plain numbers.
#[test]
fn rounding_changes_no_answer_of_the_reference() {
    let volume = extremes();
    let other = plain(&volume);
    let range = volume.range();
    let mut hit_count = 0;
    for (iso, like) in [
        (range.min, 0.0),
        (range.min.next_up(), f64::MIN_POSITIVE),
        (2e-30, 1e-60),
        (1.0, 1e-30),
        (0.5 * range.max, 0.5),
        (range.max.next_down(), 1f64.next_down()),
        (range.max, 1.0),
        (range.max.next_up(), 1f64.next_up()),
    ] {
        for camera in cameras(&volume) {
            for caps in [true, false] {
                let of = |volume: &Volume, iso| {
                    let exact = SamplingMethod::Exact;
                    let scene = scene(volume, camera, surface(iso, caps), exact);
                    on_reference(volume, &scene)
                };
                let (found, right) = (of(&volume, iso), of(&other, like));
                assert_eq!(found.plane(KIND), right.plane(KIND), "{iso:e} {caps}");
                let depths = |frame: &Frame| frame.plane(DEPTH).unwrap().to_vec();
                for (found, right) in depths(&found).into_iter().zip(depths(&right)) {
                    let near = found == right || (found - right).abs() < 1e-5;
                    assert!(near, "{iso:e}: {found} {right}");
                }
                hit_count += hits(&found);
            }
        }
    }
    assert!(hit_count > 5000, "{hit_count}");
}

#[test]
fn projections_stay_within_the_voxels_range() {
    let mixed = |dims| {
        let values = [1e30_f32, -1e30, 1e-30, 5.0, 0.1];
        volume_of(dims, move |x, y, z| values[(5.0 * hash(x, y, z)) as usize])
    };
    let device = common::device();
    for volume in [extremes(), mixed([11, 10, 9]), mixed([4, 30, 5])] {
        let range = volume.range();
        let window = Window::new(range.min, range.max).unwrap();
        let mut at_ends = 0;
        for of in [
            Projection::Maximum,
            Projection::Minimum,
            Projection::Mean,
            Projection::LocalMaximum { threshold: 1.0 },
        ] {
            for camera in cameras(&volume) {
                let picture = Picture::Projection { of, window };
                let scene = scene(&volume, camera, picture, SamplingMethod::Exact);
                let mut frames = vec![on_reference(&volume, &scene)];
                if let Some(device) = &device {
                    frames.extend(on_device(device, &volume, std::slice::from_ref(&scene)));
                }
                for frame in frames {
                    let kinds = frame.plane(KIND).unwrap();
                    for (&value, &kind) in frame.plane(VALUE).unwrap().iter().zip(kinds) {
                        let value = f64::from(value);
                        let inside = kind == Kind::Nothing as u32
                            || (range.min..=range.max).contains(&value);
                        assert!(inside, "{of:?}: {value:e} outside {range:?}");
                        at_ends += usize::from(value == range.min || value == range.max);
                    }
                }
            }
        }
        // Rays through plateaus reach the ends themselves.
        assert!(at_ends > 0);
    }
}

/// The smallest value on a ray through voxels of the smaller value alone is that value, not what rounding
/// leaves of the greater.
#[test]
fn a_minimum_on_a_face_of_small_values_is_small() {
    let volume = volume_of([4, 4, 4], |x, _, _| if x < 1.0 { 1e-30_f32 } else { 1e30 });
    let window = Window::new(0.0, 1.0).unwrap();
    let of = Projection::Minimum;
    let picture = Picture::Projection { of, window };
    // In the face itself, and through its cells to it: the origin is on the far side.
    for (origin, dir) in [
        (DVec3::new(0.0, -3.0, 1.3), DVec3::Y),
        (
            DVec3::new(5.0, 0.2, 1.1),
            DVec3::new(-0.9, 0.3, 0.1).normalize(),
        ),
    ] {
        let eye = Camera::look_at(
            origin,
            origin + dir,
            DVec3::Z,
            Lens::Orthographic { height_mm: 1.0 },
        );
        let scene = scene(
            &volume,
            eye.unwrap(),
            picture.clone(),
            SamplingMethod::Exact,
        );
        let tracer = Tracer::new(&volume, &scene).unwrap();
        let ray = angioray::scene::Ray {
            origin_world: origin,
            dir_world: dir,
        };
        let seen = tracer.cast(ray);
        assert_eq!(seen.value, f64::from(1e-30_f32), "{origin}");
        // The control: a ray beside the face has the greater value's share.
        let beside = angioray::scene::Ray {
            origin_world: DVec3::new(0.5, -3.0, 1.3),
            dir_world: DVec3::Y,
        };
        assert!(tracer.cast(beside).value > 4e29);
    }
}
