//! Ambient occlusion by definition, against closed forms.

use angioray::reference::{RayResult, Tracer};
use angioray::scene::{Occlusion, Picture, Scene, Share};

use crate::occlusion_cases::{self, Case, balls, inside_edge, occlusion, planes, tubes};

fn seen(case: &Case, scene: &Scene) -> RayResult {
    let ray = scene.camera.ray(scene.size, 0.5, 0.5);
    Tracer::new(&case.volume, scene).unwrap().cast(ray)
}

/// How far a case's accessibility is from its closed form.
fn error(case: &Case) -> f64 {
    let seen = seen(case, &case.scene);
    assert!(seen.depth_mm.is_finite(), "{}: nothing is seen", case.name);
    (1.0 - seen.occlusion - case.accessibility).abs()
}

#[test]
fn accessibility_is_that_of_closed_forms() {
    for case in planes() {
        assert_eq!(error(&case), 0.0, "{}", case.name);
    }
    let curved = balls().into_iter().chain(inside_edge()).chain(tubes());
    for case in curved {
        let error = error(&case);
        assert!(error < 0.007, "{}: {error}", case.name);
    }
    // The control: another distance is another accessibility.
    let mut case = inside_edge().remove(2);
    case.scene.ambient_occlusion = Some(occlusion(1, 24.0));
    assert!(error(&case) > 0.1);
}

#[test]
fn only_the_light_from_everywhere_is_occluded() {
    let case = tubes().remove(0);
    let Picture::Surface {
        color,
        phong: Some(phong),
        ..
    } = &case.scene.picture
    else {
        panic!("a lit surface");
    };
    let color_with = |strength: f64| {
        let mut scene = case.scene.clone();
        let Some(Occlusion::Volume(asked)) = &mut scene.ambient_occlusion else {
            panic!("rays");
        };
        asked.strength = Share::new(strength).unwrap();
        seen(&case, &scene).color
    };
    let mut without = case.scene.clone();
    without.ambient_occlusion = None;
    let without = seen(&case, &without);
    assert_eq!(without.occlusion, 0.0);
    assert_eq!(color_with(0.0), without.color);
    let occluded = seen(&case, &case.scene).occlusion;
    for strength in [0.5, 1.0] {
        let color_here = color_with(strength);
        for ((lit, dimmed), base) in without.color.iter().zip(color_here).zip(color.0) {
            let kept = base * phong.ambient.get() * strength * occluded;
            assert!((lit - dimmed - kept).abs() < 1e-12 && kept > 0.001);
        }
        assert_eq!(color_here[3], 1.0);
    }
}

#[test]
fn a_cap_has_all_before_it() {
    // A solid block: its faces are caps.
    let block = occlusion_cases::volume([20; 3], |_| 1.0);
    let center = glam::DVec3::splat(9.5);
    let scene = occlusion_cases::scene(center + glam::DVec3::new(4.0, 30.0, 3.0), center, 30.0);
    let ray = scene.camera.ray(scene.size, 0.5, 0.5);
    let seen = Tracer::new(&block, &scene).unwrap().cast(ray);
    assert!(seen.depth_mm.is_finite());
    assert_eq!(seen.occlusion, 0.0);
}
