//! Thin volumes, rays along axes, in faces, through edges and corners.

use angioray::frame::Kind;
use angioray::reference::RayResult;
use angioray::scene::{Filter, Knot, Phong, Picture, Projection, Rgb, TransferFunction};
use angioray::volume::{Geometry, Volume};
use glam::DVec3;

use crate::common::*;

fn fog() -> Picture {
    let knot = Knot {
        value: 0.0,
        color: Rgb([1.0; 3]),
        opacity: 0.5,
    };
    dvr(
        TransferFunction::new(vec![knot], 1.0).unwrap(),
        Some(Phong::default()),
    )
}

fn is_sane(result: &RayResult) -> bool {
    let lit = result.color.iter().all(|c| (0.0..=1.3).contains(c));
    let unit = (result.normal_world.length() - 1.0).abs() < 1e-12;
    lit && result.value.is_finite()
        && !result.depth_mm.is_nan()
        && (unit || result.normal_world == DVec3::ZERO)
}

#[test]
fn a_single_voxel_is_a_cube_of_one_value() {
    let voxel = volume([1, 1, 1], Geometry::default(), |_| 7.0);
    let (eye, toward) = (
        DVec3::new(-3.0, 0.25, -0.125),
        DVec3::new(9.0, 0.25, -0.125),
    );
    for filter in [Filter::Nearest, Filter::Linear] {
        let seen = |picture, toward| {
            let mut scene = scene(picture);
            scene.sampling.filter = filter;
            cast_scene(&voxel, &scene, eye, toward)
        };
        assert_eq!(seen(projection(Projection::Maximum), toward).value, 7.0);
        assert_eq!(seen(projection(Projection::Mean), toward).value, 7.0);
        let cap = seen(iso(5.0, true), toward);
        assert_eq!(
            (cap.kind, cap.depth_mm, cap.normal_world),
            (Kind::Cap, 2.5, DVec3::NEG_X)
        );
        assert_eq!(seen(iso(5.0, false), toward).kind, Kind::Nothing);
        assert!((seen(fog(), toward).color[3] - 0.5).abs() < 1e-12);
        let beside = DVec3::new(-1.0, 0.25, -0.125 + 2.0);
        assert_eq!(
            seen(projection(Projection::Maximum), beside).kind,
            Kind::Nothing
        );
    }
}

#[test]
fn a_sheet_is_one_voxel_thick_and_constant_through() {
    let sheet = volume([1, 9, 9], Geometry::default(), |p| p.y);
    let through = |y: f64, picture| {
        cast(
            &sheet,
            picture,
            DVec3::new(-3.0, y, 4.0),
            DVec3::new(9.0, y, 4.0),
        )
    };
    let mean = through(3.25, projection(Projection::Mean));
    assert!((mean.value - 3.25).abs() < 1e-14);
    assert!((through(3.25, fog()).color[3] - 0.5).abs() < 1e-12);
    // Edge on: a linear ramp; its gradient has no part across the sheet.
    let hit = cast(
        &sheet,
        iso(2.5, true),
        DVec3::new(0.3, -5.0, 4.0),
        DVec3::new(0.3, 5.0, 4.0),
    );
    assert!((hit.depth_mm - 7.5).abs() < 1e-14);
    assert_eq!(hit.normal_world, DVec3::NEG_Y);
    let beside = DVec3::new(0.51, -5.0, 4.0);
    assert_eq!(
        cast(&sheet, iso(2.5, true), beside, beside + DVec3::Y).kind,
        Kind::Nothing
    );
}

#[test]
fn rays_in_faces_and_edges_see_the_field_there() {
    let b = DVec3::new(1.0, 2.0, 4.0);
    let ramp = volume([5, 6, 7], Geometry::default(), |p| b.dot(p));
    // In the y faces, an inner cell face, the volume's edges: the mean is the middle's value.
    for y in [0.0, 2.0, 5.0] {
        for z in [0.0, 3.0, 6.0] {
            for flip in [1.0, -1.0] {
                let at = |x: f64| DVec3::new(2.0 + flip * x, y, z);
                let seen = cast(&ramp, projection(Projection::Mean), at(-9.0), at(9.0));
                assert!((seen.value - b.dot(DVec3::new(2.0, y, z))).abs() < 1e-13);
                assert!((seen.value - b.dot(DVec3::new(2.0, y, z)) - 1e-9).abs() > 1e-13);
                let hit = cast(&ramp, iso(b.dot(at(0.5)), false), at(-9.0), at(9.0));
                assert!((hit.depth_mm - 9.5).abs() < 1e-12);
            }
        }
    }
    let outside = DVec3::new(-9.0, 5.0_f64.next_up(), 0.0);
    let seen = cast(
        &ramp,
        projection(Projection::Mean),
        outside,
        outside + DVec3::X,
    );
    assert_eq!(seen.kind, Kind::Nothing);
    // An edge is touched in one point: its value, no opacity.
    let (eye, toward) = (DVec3::new(-1.0, 1.0, 3.0), DVec3::new(0.0, 0.0, 3.0));
    let touch = |picture| cast(&ramp, picture, eye, toward);
    for of in [Projection::Maximum, Projection::Minimum, Projection::Mean] {
        assert_eq!(touch(projection(of)).value, 12.0);
    }
    assert_eq!(touch(iso(12.0, true)).kind, Kind::Cap);
    assert_eq!(touch(iso(12.5, true)).kind, Kind::Nothing);
    assert_eq!(touch(fog()).color, [0.0; 4]);
    let past = DVec3::new(-1.0, 0.999, 3.0);
    let missed = cast(
        &ramp,
        projection(Projection::Mean),
        past,
        past + toward - eye,
    );
    assert_eq!(missed.kind, Kind::Nothing);
}

/// Volumes of awkward sizes.
fn awkward(random: &mut Random) -> Vec<Volume> {
    [
        [1, 1, 1],
        [2, 2, 2],
        [1, 5, 5],
        [5, 1, 2],
        [3, 4, 5],
        [1, 1, 6],
    ]
    .map(|dims| {
        let values: Vec<f64> = (0..512).map(|_| (random.unit() * 4.0).floor()).collect();
        volume(dims, Geometry::default(), |p| {
            values[p.x as usize + 8 * (p.y as usize + 8 * p.z as usize)]
        })
    })
    .into()
}

#[test]
fn special_rays_agree_with_their_neighbours() {
    let mut random = Random(77);
    let specials = [0.0, -0.0, 5e-324, -1e-310, 1e-17];
    let mut compared = 0;
    for _ in 0..300 {
        for volume in awkward(&mut random) {
            let length = last(&volume).max_element() + 3.0;
            // From a lattice point or between, along a direction with vanishing components.
            let mut eye = random.point(DVec3::splat(-2.0), last(&volume) + 2.0);
            let mut dir = random.direction();
            for axis in 0..3 {
                if random.unit() < 0.5 {
                    eye[axis] = (eye[axis] * 2.0).round() / 2.0;
                }
                if random.unit() < 0.4 {
                    dir[axis] = specials[(random.unit() * 5.0) as usize];
                }
                if random.unit() < 0.2 {
                    dir[axis] = 1.0;
                }
            }
            if dir.length() < 0.1 {
                continue;
            }
            // Inside, and as seen from the neighbouring ray that is moved by 1e-9.
            let nudge = random.direction() * 1e-9;
            let pictures = [
                projection(Projection::Maximum),
                projection(Projection::Minimum),
                projection(Projection::Mean),
                projection(Projection::LocalMaximum { threshold: 1.5 }),
                iso(1.0, true),
                iso(1.5, false),
                fog(),
            ];
            for (i, picture) in pictures.into_iter().enumerate() {
                let a = cast(&volume, picture.clone(), eye, eye + dir * length);
                let near = cast_nearest(&volume, picture.clone(), eye, eye + dir * length);
                let b = cast(&volume, picture, eye + nudge, eye + nudge + dir * length);
                assert!(is_sane(&a) && is_sane(&near), "{eye} {dir} {a:?} {near:?}");
                // Where both rays run well inside, extrema and mean are continuous.
                if i < 3 && a.kind == b.kind && a.kind == Kind::Surface {
                    let length = |s: &RayResult| s.cells > 0;
                    if length(&a) && a.cells.abs_diff(b.cells) == 0 {
                        compared += 1;
                        assert!((a.value - b.value).abs() < 1e-5, "{eye} {dir} {a:?} {b:?}");
                    }
                }
            }
        }
    }
    assert!(compared > 300, "{compared}");
}
