//! An orbit: where its cameras are, and that it closes.

use angioray::extent::Range;
use angioray::options::{Resolved, SceneOptions};
use angioray::scene::{FrameCount, Orbit, OrbitAxis};
use angioray::{Content, Sphere, Subject};
use glam::DVec3;

const SPHERE: Sphere = Sphere {
    center_world: DVec3::new(10.0, -4.0, 2.5),
    radius_mm: 60.0,
};

fn subject() -> Subject {
    Subject {
        sphere: SPHERE,
        content: Content::around(SPHERE),
        spacing_mm: DVec3::ONE,
        range: Range {
            min: 0.0,
            max: 255.0,
        },
        robust_range: Range {
            min: 0.0,
            max: 255.0,
        },
        otsu: 90.0,
        suggested_iso: 70.0,
    }
}

fn seen(options: &str) -> Resolved {
    let options = SceneOptions::parse(options, "test").unwrap();
    options.resolve(&subject()).unwrap()
}

/// What is seen first, and from where.
struct Frames {
    first: Resolved,
    orbit: Orbit,
}

impl Frames {
    fn at(&self, frame: u32) -> Resolved {
        self.first.seen_by(self.orbit.camera(frame))
    }
}

fn orbit(options: &str, axis: &str, degrees: f64, frames: u32) -> Frames {
    let frames = FrameCount::new(frames).unwrap();
    let first = seen(options);
    let axis = axis.parse().unwrap();
    let orbit = Orbit::new(first.scene.camera, axis, degrees, frames).unwrap();
    Frames { first, orbit }
}

/// How far two cameras are apart: their eyes in radii of the volume, and their directions.
fn apart(a: &Resolved, b: &Resolved) -> f64 {
    let (a, b) = (&a.scene.camera, &b.scene.camera);
    (a.eye_world().distance(b.eye_world()) / SPHERE.radius_mm)
        .max(a.forward().distance(b.forward()))
        .max(a.up().distance(b.up()))
        .max(a.right().distance(b.right()))
}

const VIEWS: [&str; 6] = [
    "",
    "elevation = 20",
    "view = 'superior'",
    "carm = 'LAO 30 CRA 20'",
    "eye = [100, -200, 90]\ntarget = [12, 0, 3]\nroll = 10",
    "ortho = 80\nview = 'left'\nzoom = 2",
];
const AXES: [&str; 6] = ["up", "right", "x", "y", "z", "1,-2,0.5"];

#[test]
fn an_orbit_closes_without_a_repeated_frame() {
    for view in VIEWS {
        for axis in AXES {
            for (degrees, frames) in [(360.0, 7), (-720.0, 12), (360.0, 1)] {
                let orbit = orbit(view, axis, degrees, frames);
                let first = orbit.at(0);
                // Exactly: rendering frame N gives the bytes of frame 0.
                let closing = orbit.at(frames);
                assert_eq!(closing.scene, first.scene, "{view} {axis}");
                assert_eq!(closing.options, first.options, "{view} {axis}");
                assert_eq!(first, seen(view), "{view} {axis}");
                assert!(orbit.orbit.degrees_at(frames) == degrees);
            }
            // No repeated frame, but where the axis is the line of sight the picture turns.
            let orbit = orbit(view, axis, 360.0, 8);
            let frames: Vec<Resolved> = (0..8).map(|k| orbit.at(k)).collect();
            for a in 0..8 {
                for b in 0..a {
                    assert!(apart(&frames[a], &frames[b]) > 0.1, "{view} {axis} {a} {b}");
                }
            }
        }
    }
}

#[test]
fn the_camera_keeps_its_distance_target_and_lens() {
    for view in VIEWS {
        for axis in AXES {
            let orbit = orbit(view, axis, 360.0, 11);
            let first = orbit.at(0);
            let target = first.scene.camera.target_world();
            for k in 0..11 {
                let seen = orbit.at(k);
                let camera = &seen.scene.camera;
                let distance = |seen: &Resolved| seen.scene.camera.eye_world().distance(target);
                assert!((distance(&seen) - distance(&first)).abs() < 1e-12 * distance(&first));
                let toward = (target - camera.eye_world()).normalize();
                assert!(camera.forward().distance(toward) < 1e-12);
                assert_eq!(camera.lens(), first.scene.camera.lens());
                // What lies on the axis stays where it is in the picture's depth.
                let along = |seen: &Resolved| {
                    let eye = seen.scene.camera.eye_world();
                    (eye - target).dot(orbit.orbit.axis())
                };
                assert!((along(&seen) - along(&first)).abs() < 1e-10);
                // Everything but the camera is as it was.
                let mut rest = seen.scene.clone();
                rest.camera = first.scene.camera;
                assert_eq!(rest, first.scene);
            }
        }
    }
}

#[test]
fn about_up_it_turns_as_azimuth_does_and_about_z_as_a_c_arm() {
    for k in 0..9 {
        let degrees = 40 * k;
        let about_up = orbit("elevation = 0", "up", 360.0, 9).at(k);
        let named = seen(&format!("azimuth = {degrees}"));
        assert!(apart(&about_up, &named) < 1e-12, "{degrees}");
        // Raised, the eye stays as high about z.
        let about_z = orbit("elevation = 20", "z", 360.0, 9).at(k);
        let named = seen(&format!("azimuth = {degrees}\nelevation = 20"));
        assert!(apart(&about_z, &named) < 1e-12, "{degrees}");
    }
    // The controls: the other way round, and about the raised camera's own up, it is elsewhere.
    let back = orbit("", "up", -360.0, 9).at(1);
    assert!(apart(&back, &seen("azimuth = 40")) > 0.1);
    let about_up = orbit("elevation = 20", "up", 360.0, 9).at(2);
    assert!(apart(&about_up, &seen("azimuth = 80\nelevation = 20")) > 0.1);
    // About right the eye goes down first: right-handed, too.
    let about_right = orbit("", "right", 360.0, 9).at(1);
    assert!(apart(&about_right, &seen("elevation = -40")) < 1e-12);
}

#[test]
fn axes_and_numbers_that_make_no_orbit_are_refused() {
    for axis in ["", "w", "0,0,0", "1,2", "nan,0,1", "upward", "1,2,3,4"] {
        let error = axis.parse::<OrbitAxis>().unwrap_err();
        assert!(error.to_string().contains("is not an axis"), "{error}");
        assert_eq!(error.exit_code(), 2);
    }
    for wrong in ["0", "1000001", "4000000000", "5000000000", "-1", "many"] {
        let error = wrong.parse::<FrameCount>().unwrap_err();
        assert!(error.to_string().contains("there must be 1 to"), "{error}");
        assert_eq!(error.exit_code(), 2);
    }
    let three = "3".parse().unwrap();
    let made = |degrees| Orbit::new(seen("").scene.camera, OrbitAxis::Up, degrees, three);
    for degrees in [f64::NAN, f64::INFINITY] {
        assert_eq!(made(degrees).unwrap_err().exit_code(), 2);
    }
    // The controls.
    assert_eq!("1000000".parse(), FrameCount::new(FrameCount::MAX));
    assert_eq!(made(360.0).unwrap().frames(), 3);
    // A direction of any length.
    assert_eq!("0,0,7".parse(), Ok(OrbitAxis::World(DVec3::Z)));
}
