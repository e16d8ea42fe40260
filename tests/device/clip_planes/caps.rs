//! Caps on clip planes: a solid volume's surface is where a plane opens it.

use angioray::frame::{KIND, Kind, NORMAL};

use super::*;

/// Rays along +y, cut by a plane of any direction through a point near the middle.
#[test]
fn a_cap_lies_on_its_plane_and_has_its_normal() {
    let volume = oblique(DVec3::ZERO);
    let (camera, size) = straight(DVec3::ZERO, 12, 4.0);
    let point = DVec3::new(0.3, 0.1, -0.2);
    for normal in [
        DVec3::new(0.3, 1.0, 0.2),
        DVec3::new(-0.5, 0.7, 0.6) * 1e-3,
        DVec3::Y * 40.0,
    ] {
        let planes = [plane_at(point, normal)];
        let [capped, open] =
            [true, false].map(|caps| scene(&volume, surface(caps), (camera, size), &planes));
        for engine in engines() {
            let frames = engine.frames(&volume, &[capped.clone(), open.clone()]);
            let kinds = frames[0].plane(KIND).unwrap();
            let normals = frames[0].plane(NORMAL).unwrap();
            let caps = kinds.iter().filter(|&&k| k == Kind::Cap as u32).count();
            assert_eq!(caps, kinds.len(), "{}", engine.name);
            let outward = -normal.normalize();
            for (pixel, depth_mm) in depths_mm(&frames[0]).into_iter().enumerate() {
                let (i, j) = (pixel as u32 % 12, pixel as u32 / 12);
                let ray = camera.ray(size, f64::from(i) + 0.5, f64::from(j) + 0.5);
                let expected_mm =
                    (point - ray.origin_world).dot(normal) / ray.dir_world.dot(normal);
                assert!(
                    (depth_mm - expected_mm).abs() < engine.depth_voxels,
                    "{}: {depth_mm}, not {expected_mm}",
                    engine.name
                );
                let seen = DVec3::from_array(normals[pixel].map(f64::from));
                assert!(seen.distance(outward) < 2e-6, "{}: {seen}", engine.name);
                // The control: the face's normal, and the plane's own side.
                assert!(seen.distance(-outward) > 1.0);
            }
            let open = frames[1].plane(KIND).unwrap();
            assert!(open.iter().all(|&k| k == Kind::Nothing as u32));
        }
    }
}

/// From inside: no cap at the eye, one where a plane opens the volume ahead, none where a plane
/// lies behind.
#[test]
fn from_inside_only_a_plane_ahead_is_capped() {
    let volume = oblique(DVec3::ZERO);
    let eye = DVec3::new(0.2, -1.0, 0.1);
    let lens = Lens::Perspective { fov_deg: 50.0 };
    let camera = Camera::look_at(eye, eye + DVec3::Y, DVec3::Z, lens).unwrap();
    let view = (camera, ImageSize::new(9, 9).unwrap());
    let at = |ahead_mm: f64| plane_at(eye + DVec3::Y * ahead_mm, DVec3::new(0.1, 1.0, -0.1));
    let cases: [(Vec<ClipPlane>, Kind); 5] = [
        (vec![], Kind::Nothing),
        (vec![at(-0.5)], Kind::Nothing),
        (vec![at(0.0)], Kind::Nothing),
        (vec![at(1e-2)], Kind::Cap),
        (vec![at(1.0)], Kind::Cap),
    ];
    let scenes: Vec<Scene> = (cases.iter())
        .map(|(planes, _)| scene(&volume, surface(true), view, planes))
        .collect();
    for engine in engines() {
        let frames = engine.frames(&volume, &scenes);
        for ((planes, kind), frame) in cases.iter().zip(&frames) {
            let kinds = frame.plane(KIND).unwrap();
            let all = kinds.iter().all(|&k| k == *kind as u32);
            assert!(all, "{}: {planes:?}: {kinds:?}", engine.name);
        }
    }
}

/// The eye moves through a plane: what it sees changes no more than it moves.
#[test]
fn crossing_a_plane_leaves_no_hole() {
    let volume = oblique(DVec3::ZERO);
    let lens = Lens::Perspective { fov_deg: 60.0 };
    let size = ImageSize::new(9, 9).unwrap();
    let cut = plane(DVec3::new(0.05, 1.0, 0.02), 0.0);
    let scenes: Vec<Scene> = (-10..=10)
        .map(|k| {
            let eye = DVec3::new(0.1, f64::from(k) * 0.01, 0.1);
            let camera = Camera::look_at(eye, eye + DVec3::Y, DVec3::Z, lens).unwrap();
            scene(&volume, medium(), (camera, size), &[cut])
        })
        .collect();
    for engine in engines() {
        let frames = engine.frames(&volume, &scenes);
        let lengths: Vec<Vec<f64>> = frames.iter().map(|f| lengths_mm(f).collect()).collect();
        let apart = |a: &[f64], b: &[f64]| {
            let pairs = a.iter().zip(b);
            pairs.fold(0.0, |max, (a, b)| f64::max(max, (a - b).abs()))
        };
        for pair in lengths.windows(2) {
            assert!(apart(&pair[0], &pair[1]) < 0.05, "{}", engine.name);
        }
        // The control: over the whole distance it changes more.
        assert!(apart(&lengths[0], &lengths[20]) > 0.05, "{}", engine.name);
    }
}
