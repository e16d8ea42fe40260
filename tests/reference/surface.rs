//! Isosurfaces, caps and normals.

use angioray::frame::Kind;
use angioray::scene::Filter;
use angioray::volume::{Geometry, Volume};
use glam::DVec3;

use crate::common::*;

/// The largest depth error over random rays against the plane `coefficients · p_index = iso − a`.
fn plane_error(volume: &Volume, a: f64, b: DVec3, iso_value: f64) -> f64 {
    let mut random = Random(7);
    let (mut worst, mut hits) = (0.0_f64, 0);
    for _ in 0..400 {
        let (eye, toward) = random_ray(&mut random, volume);
        let hit = cast(volume, iso(iso_value, false), eye, toward);
        if hit.kind == Kind::Nothing {
            continue;
        }
        hits += 1;
        let dir = (toward - eye).normalize();
        let index = volume.geometry().index_from_world();
        let (o, d) = (index.transform_point3(eye), index.transform_vector3(dir));
        let t = (iso_value - a - b.dot(o)) / b.dot(d);
        // A grazing ray turns a rounding error of Φ into a long distance.
        let graze = b.dot(d).abs() / (b.length() * d.length());
        worst = worst.max((hit.depth_mm - t).abs() * graze);
    }
    assert!(hits > 100);
    worst
}

#[test]
fn the_plane_of_a_linear_field_is_hit_exactly() {
    let b = DVec3::new(3.0, -2.0, 0.5);
    for geometry in [Geometry::default(), oblique(false), oblique(true)] {
        for b in [DVec3::X * 3.0, b] {
            let ramp = volume([9, 7, 5], geometry, |p| b.dot(p) - 5.0);
            assert!(plane_error(&ramp, -5.0, b, 6.25) < 1e-12);
            assert!(plane_error(&ramp, -5.0 + 1e-9, b, 6.25) > 1e-12);
        }
    }
}

#[test]
fn the_normal_of_a_linear_field_is_its_planes_normal() {
    let b = DVec3::new(3.0, -2.0, 0.5);
    for geometry in [oblique(false), oblique(true)] {
        let ramp = volume([9, 7, 5], geometry, |p| b.dot(p));
        let linear = geometry.world_from_index().matrix3;
        let expected = -(linear.inverse().transpose() * b).normalize();
        let mut random = Random(3);
        let mut hits = 0;
        for _ in 0..300 {
            let (eye, toward) = random_ray(&mut random, &ramp);
            let hit = cast(&ramp, iso(6.25, false), eye, toward);
            let p = eye + (toward - eye).normalize() * hit.depth_mm;
            let p = geometry.index_from_world().transform_point3(p);
            // At the border the differences are one-sided.
            if p.cmpge(DVec3::ONE).all() && p.cmple(last(&ramp) - 1.0).all() {
                hits += 1;
                assert!(hit.normal_world.distance(expected) < 1e-12);
                assert!(hit.normal_world.distance((linear * -b).normalize()) > 0.01);
            }
        }
        assert!(hits > 20);
    }
}

#[test]
fn the_normal_at_the_border_clamps_positions_and_still_divides_by_two() {
    let b = DVec3::new(4.0, 2.0, 1.0);
    let ramp = volume([5, 5, 5], Geometry::default(), |p| b.dot(p));
    // In the cell 0.25 from the low x face: Φ(x+1) − Φ(0) spans 1.25 voxels.
    let hit = cast(
        &ramp,
        iso(7.0, false),
        DVec3::new(0.25, 2.0, -3.0),
        DVec3::new(0.25, 2.0, 9.0),
    );
    assert!((hit.depth_mm - 5.0).abs() < 1e-12);
    let clamped = -DVec3::new(4.0 * 1.25 / 2.0, 2.0, 1.0).normalize();
    assert!(hit.normal_world.distance(clamped) < 1e-12);
    assert!(hit.normal_world.distance(-b.normalize()) > 0.01);
}

/// How many of the ray's samples before `depth` disagree with the first one's side of iso, and the
/// distance of Φ from iso at the hit.
fn brute_force(
    volume: &Volume,
    eye: DVec3,
    toward: DVec3,
    iso_value: f64,
    depth: f64,
) -> (u32, f64) {
    let index = volume.geometry().index_from_world();
    let dir = (toward - eye).normalize();
    let at = |t: f64| {
        let p = index.transform_point3(eye + dir * t);
        phi(volume, p.clamp(DVec3::ZERO, last(volume)))
    };
    let (enter, leave) = path(volume, eye, toward, toward);
    let end = depth.min(leave);
    let mut changes = 0;
    let first = at(enter) >= iso_value;
    const SAMPLES: u32 = 400;
    for i in 0..SAMPLES {
        let t = enter + (end - enter) * (f64::from(i) + 0.5) / f64::from(SAMPLES);
        let value = at(t);
        changes += u32::from((value >= iso_value) != first && (value - iso_value).abs() > 1e-11);
    }
    (changes, (at(end) - iso_value).abs())
}

#[test]
fn in_noise_nothing_changes_sign_before_the_hit() {
    let mut random = Random(11);
    let (mut hits, mut late) = (0, 0);
    for case in 0..400 {
        let n = [2, 3, 5][case % 3];
        let noise = random.noise(n, oblique(case % 2 == 0), 1.0);
        let (eye, toward) = random_ray(&mut random, &noise);
        let level = random.between(0.3, 0.7);
        let hit = cast(&noise, iso(level, false), eye, toward);
        let (changes, off) = brute_force(&noise, eye, toward, level, hit.depth_mm);
        assert_eq!(changes, 0);
        if hit.kind == Kind::Surface {
            assert!(off < 1e-12 && (hit.value - level).abs() < 1e-13);
            let p = eye + (toward - eye).normalize() * hit.depth_mm;
            let p = noise.geometry().index_from_world().transform_point3(p);
            let n = normal(gradient(&noise, p), DVec3::ZERO);
            assert!(hit.normal_world.distance(n) < 1e-8);
            hits += 1;
            // A hit reported later is caught.
            let later = hit.depth_mm + 0.05;
            late += u32::from(brute_force(&noise, eye, toward, level, later).0 > 0);
        }
    }
    assert!(
        hits > 200 && late > hits / 2,
        "{hits} hits, {late} later ones caught"
    );
}

#[test]
fn three_roots_in_one_cell_are_taken_in_order() {
    // 96 (s − 1/4)(s − 1/2)(s − 3/4) along the diagonal.
    let cell = diagonal([-9.0, 13.0, -13.0, 9.0]);
    let far = DVec3::splat(9.0);
    for (start, root) in [(-2.0, 0.25), (0.0, 0.25), (0.26, 0.5), (0.6, 0.75)] {
        let eye = DVec3::splat(start);
        let hit = cast(&cell, iso(0.0, true), eye, far);
        let off = |root: f64| (hit.depth_mm - (root - start) * DIAGONAL_MM).abs();
        assert!(off(root) < 1e-14, "{start}: {}", off(root));
        assert!(off(root + 0.25) > 1e-14);
        let back = cast(&cell, iso(0.0, false), DVec3::splat(1.0 - start), -far);
        assert!((back.depth_mm - (root - start) * DIAGONAL_MM).abs() < 1e-14);
    }
    assert_eq!(
        cast(&cell, iso(0.0, true), DVec3::splat(0.8), far).kind,
        Kind::Nothing
    );
}

#[test]
fn a_tangent_is_missed_or_hit_by_a_billionth() {
    // 12 s (1 − s): at most 3, at s = 1/2.
    let cell = diagonal([0.0, 4.0, 4.0, 0.0]);
    let seen = |level: f64| cast(&cell, iso(level, true), DVec3::splat(-1.0), DVec3::ONE);
    assert_eq!(seen(3.0 + 1e-9).kind, Kind::Nothing);
    let hit = seen(3.0 - 1e-9);
    assert_eq!(hit.kind, Kind::Surface);
    let s = 0.5 - (1e-9_f64 / 12.0).sqrt();
    assert!((hit.depth_mm - (1.0 + s) * DIAGONAL_MM).abs() < 1e-10);
    assert!((hit.depth_mm - 1.5 * DIAGONAL_MM).abs() > 1e-10);
}

#[test]
fn one_bright_voxel_is_a_tent() {
    let tent = volume([3, 3, 3], Geometry::default(), |p| {
        f64::from(u8::from(p == DVec3::ONE))
    });
    // Along an axis, a face's diagonal and the main one: (1 − s), its square, its cube.
    for (dir, power) in [
        (DVec3::X, 1),
        (DVec3::new(1.0, -1.0, 0.0), 2),
        (DVec3::ONE, 3),
    ] {
        let eye = DVec3::ONE - dir * 4.0;
        let hit = cast(&tent, iso(0.5, true), eye, DVec3::ONE);
        let depth = |level: f64| (3.0 + level.powf(1.0 / f64::from(power))) * dir.length();
        assert!((hit.depth_mm - depth(0.5)).abs() < 1e-14);
        assert!((hit.depth_mm - depth(0.5 + 1e-9)).abs() > 1e-14);
        assert!(hit.normal_world.dot(-dir.normalize()) > 0.999_999);
    }
}

/// The largest depth error of a sphere of radius 0.6 in a cube of side 2 with n voxels an axis.
fn sphere_error(n: u64, filter: Filter) -> f64 {
    let h = 2.0 / (n - 1) as f64;
    let geometry = Geometry::new(DVec3::NEG_ONE, glam::DMat3::IDENTITY, DVec3::splat(h)).unwrap();
    let ball = volume([n; 3], geometry, |p| 0.6 - (p * h - 1.0).length());
    let mut random = Random(5);
    let mut worst = 0.0_f64;
    for _ in 0..300 {
        let eye = random.direction() * 5.0;
        let toward = random.direction() * random.between(0.0, 0.3);
        let dir = (toward - eye).normalize();
        let along = -eye.dot(dir);
        let across = (eye + dir * along).length_squared();
        let mut scene = scene(iso(0.0, true));
        scene.sampling.filter = filter;
        let hit = cast_scene(&ball, &scene, eye, toward);
        worst = worst.max((hit.depth_mm - (along - (0.36 - across).sqrt())).abs());
    }
    worst
}

#[test]
fn a_spheres_depth_converges_with_the_square_of_the_spacing() {
    let errors = [17, 33, 65].map(|n| sphere_error(n, Filter::Linear));
    for pair in errors.windows(2) {
        assert!(pair[0] / pair[1] > 3.0, "{errors:?}");
    }
    assert!(errors[2] < 1e-3);
    let errors = [17, 33, 65].map(|n| sphere_error(n, Filter::Nearest));
    assert!(
        errors[0] / errors[2] < 9.0 && errors[2] > 1e-3,
        "{errors:?}"
    );
}

#[test]
fn caps_close_the_volume_with_its_faces_normals() {
    for geometry in [Geometry::default(), oblique(false), oblique(true)] {
        let full = volume([5, 6, 7], geometry, |p| {
            10.0 - p.distance(DVec3::new(2.0, 2.0, 3.0))
        });
        let world = geometry.world_from_index();
        let middle = last(&full) / 2.0;
        for axis in 0..3 {
            for low in [true, false] {
                let mut on_face = middle;
                on_face[axis] = if low { 0.0 } else { last(&full)[axis] };
                let eye = world.transform_point3(on_face + (on_face - middle) * 3.0);
                let target = world.transform_point3(on_face);
                let hit = cast(&full, iso(1.0, true), eye, target);
                assert_eq!(hit.kind, Kind::Cap);
                assert!((hit.depth_mm - eye.distance(target)).abs() < 1e-12);
                assert!((hit.value - phi(&full, on_face)).abs() < 1e-12);
                // Perpendicular to the face's edges, and outward.
                for other in (0..3).filter(|&a| a != axis) {
                    let edge = world.matrix3.col(other).normalize();
                    assert!(hit.normal_world.dot(edge).abs() < 1e-12);
                }
                assert!(hit.normal_world.dot(eye - target) > 0.0);
                assert!((hit.normal_world.length() - 1.0).abs() < 1e-12);
                // Above the field there is no cap, and no surface.
                assert_eq!(
                    cast(&full, iso(11.0, true), eye, target).kind,
                    Kind::Nothing
                );
            }
        }
    }
}

#[test]
fn without_caps_or_from_inside_the_hit_is_where_the_field_falls() {
    let fall = profile(&[9.0, 7.0, 5.0, 3.0, 1.0]);
    let at = |x: f64| DVec3::new(x, 0.5, 0.5);
    let capped = cast(&fall, iso(4.0, true), at(-2.0), at(9.0));
    assert_eq!(
        (capped.kind, capped.depth_mm, capped.value),
        (Kind::Cap, 2.0, 9.0)
    );
    assert_eq!(capped.normal_world, DVec3::NEG_X);
    let open = cast(&fall, iso(4.0, false), at(-2.0), at(9.0));
    assert_eq!((open.kind, open.depth_mm), (Kind::Surface, 4.5));
    assert_eq!(open.normal_world, DVec3::X);
    for start in [0.0, 0.3, 1.0] {
        let inside = cast(&fall, iso(4.0, true), at(start), at(9.0));
        assert_eq!(inside.kind, Kind::Surface);
        assert!((inside.depth_mm - (2.5 - start)).abs() < 1e-14);
    }
    assert_eq!(
        cast(&fall, iso(0.5, true), at(0.5), at(9.0)).kind,
        Kind::Nothing
    );
}

#[test]
fn an_iso_value_equal_to_a_plateau_is_hit_at_its_edge() {
    let block = volume([7, 7, 7], Geometry::default(), |p| {
        f64::from(u8::from((p - 3.0).abs().max_element() <= 1.0))
    });
    let mut random = Random(2);
    for _ in 0..100 {
        let target = random.point(DVec3::new(2.0, 2.2, 2.2), DVec3::new(2.0, 3.8, 3.8));
        let eye = target - DVec3::X * random.between(5.0, 9.0);
        let hit = cast(&block, iso(1.0, true), eye, target);
        assert!((hit.depth_mm - (target.x - eye.x)).abs() < 1e-12);
        assert_eq!(hit.kind, Kind::Surface);
        let above = cast(&block, iso(1.0_f64.next_up(), true), eye, target);
        assert_eq!(above.kind, Kind::Nothing);
        // At the minimum everything is inside: only a cap is left.
        assert_eq!(cast(&block, iso(0.0, true), eye, target).kind, Kind::Cap);
        assert_eq!(
            cast(&block, iso(0.0, false), eye, target).kind,
            Kind::Nothing
        );
    }
}

#[test]
fn where_the_gradient_vanishes_the_normal_faces_the_eye() {
    let zigzag = profile(&[0.0, 1.0, 0.0, 1.0, 0.0, 1.0]);
    let (eye, toward) = (DVec3::new(2.125, 0.5, 0.25), DVec3::new(9.0, 0.75, 0.5));
    let hit = cast(&zigzag, iso(0.5, true), eye, toward);
    let dir = (toward - eye).normalize();
    assert!((hit.depth_mm * dir.x - 0.375).abs() < 1e-14);
    assert!(hit.normal_world.distance(-dir) < 1e-15);
    // One voxel from the border the clamped difference does not vanish.
    let hit = cast(
        &zigzag,
        iso(0.5, true),
        eye - DVec3::X * 2.0,
        toward - DVec3::X * 2.0,
    );
    assert!(hit.normal_world.distance(-dir) > 0.01);
}

#[test]
fn the_nearest_filter_hits_the_voxels_boxes() {
    let steps = profile(&[0.0, 0.0, 5.0, 9.0, 1.0]);
    let at = |x: f64| DVec3::new(x, 0.5, 0.25);
    let hit = cast_nearest(&steps, iso(4.0, true), at(-2.0), at(9.0));
    assert_eq!((hit.depth_mm, hit.value), (3.5, 5.0));
    assert_eq!(hit.normal_world, DVec3::NEG_X);
    let back = cast_nearest(&steps, iso(4.0, true), at(6.0), at(-9.0));
    assert_eq!((back.depth_mm, back.value), (2.5, 9.0));
    // Halfway belongs to the higher voxel.
    let side = |x: f64| {
        cast_nearest(
            &steps,
            iso(4.0, true),
            DVec3::new(x, -1.0, 0.5),
            DVec3::new(x, 9.0, 0.5),
        )
    };
    assert_eq!(side(1.5).kind, Kind::Cap);
    assert_eq!(side(1.5).value, 5.0);
    assert_eq!(side(1.5_f64.next_down()).kind, Kind::Nothing);
}
