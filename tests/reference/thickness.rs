//! How far rays go on behind their hits, against closed forms.

use angioray::frame::{Layer, Wanted};
use angioray::reference::Tracer;
use glam::DVec3;

use crate::occlusion_cases::{scene, volume};
use crate::slab::thick_cases;

#[test]
fn slabs_are_as_thick_as_they_are_along_the_ray() {
    for case in thick_cases() {
        let ray = case.scene.camera.ray(case.scene.size, 0.5, 0.5);
        let tracer = Tracer::new(&case.volume, &case.scene).unwrap();
        // What is not wanted is not found.
        assert_eq!(tracer.cast(ray).thick_mm, 0.0);
        let seen = tracer.wanting(Wanted::NONE.with([Layer::Thick])).cast(ray);
        assert!(seen.depth_mm.is_finite(), "{}", case.name);
        let off = seen.thick_mm - case.thick_mm;
        assert!(off.abs() < 1e-5, "{}: {off}", case.name);
    }
}

#[test]
fn a_balls_chords_are_those_of_a_ball() {
    let (center, radius) = (DVec3::splat(20.2), 14.0);
    let ball = volume([41; 3], |p| radius - p.distance(center));
    for aside in [0.0, 3.0, 7.0, 12.0] {
        let toward = DVec3::new(0.3, 0.5, -0.8).normalize();
        let target = center + aside * toward.any_orthonormal_vector();
        let scene = scene(target + 60.0 * toward, target, 30.0);
        let tracer = Tracer::new(&ball, &scene).unwrap();
        let ray = scene.camera.ray(scene.size, 0.5, 0.5);
        let seen = tracer.wanting(Wanted::NONE.with([Layer::Thick])).cast(ray);
        let chord = 2.0 * (radius * radius - aside * aside).sqrt();
        // The field between voxels is no ball's to the last tenth of a voxel.
        assert!(
            (seen.thick_mm - chord).abs() < 0.1,
            "{aside}: {}",
            seen.thick_mm
        );
    }
}
