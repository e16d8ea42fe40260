//! Camera options against cameras worked out by hand.

use angioray::extent::Range;
use angioray::options::SceneOptions;
use angioray::scene::{Camera, Lens};
use angioray::{Content, Scene, Sphere, Subject};
use clap::Parser;
use glam::DVec3;

/// A ball of radius 10 mm about (1, 2, 3).
const SPHERE: Sphere = Sphere {
    center_world: DVec3::new(1.0, 2.0, 3.0),
    radius_mm: 10.0,
};

const SUBJECT: Subject = Subject {
    sphere: SPHERE,
    content: Content::around(SPHERE),
    spacing_mm: DVec3::ONE,
    range: Range { min: 0.0, max: 1.0 },
    robust_range: Range { min: 0.0, max: 1.0 },
    otsu: 0.5,
    suggested_iso: 0.5,
};

#[derive(Parser)]
struct Flags {
    #[command(flatten)]
    options: SceneOptions,
}

fn camera(line: &[&str]) -> Camera {
    resolved(line).scene.camera
}

fn resolved(line: &[&str]) -> angioray::options::Resolved {
    let words = std::iter::once("angioray").chain(line.iter().copied());
    let flags = Flags::try_parse_from(words).unwrap_or_else(|e| panic!("{line:?}: {e}"));
    let resolved = flags.options.resolve(&SUBJECT);
    resolved.unwrap_or_else(|e| panic!("{line:?}: {e}"))
}

/// Whether the eye lies in this direction from the volume's centre, with this up.
fn eye_is(line: &[&str], toward: [f64; 3], up: [f64; 3]) -> bool {
    let camera = camera(line);
    let toward_eye = (camera.eye_world() - SPHERE.center_world).normalize();
    toward_eye.distance(toward.into()) < 1e-9 && camera.up().distance(up.into()) < 1e-9
}

#[test]
fn named_views_look_from_the_named_side() {
    let z = [0.0, 0.0, 1.0];
    for (view, toward, up) in [
        ("anterior", [0.0, -1.0, 0.0], z),
        ("posterior", [0.0, 1.0, 0.0], z),
        ("left", [1.0, 0.0, 0.0], z),
        ("right", [-1.0, 0.0, 0.0], z),
        ("superior", [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        ("inferior", [0.0, 0.0, -1.0], [0.0, -1.0, 0.0]),
    ] {
        assert!(eye_is(&["--view", view], toward, up), "{view}");
        // The control: from the opposite side it is false.
        assert!(!eye_is(&["--view", view], toward.map(|c| -c), up), "{view}");
    }
    assert!(eye_is(&[], [0.0, -1.0, 0.0], z), "anterior is the default");
}

#[test]
fn azimuth_goes_to_the_left_and_elevation_to_the_head() {
    let (sin20, cos20) = 20f64.to_radians().sin_cos();
    let (sin30, cos30) = (0.5, 3f64.sqrt() / 2.0);
    let eye = [sin30 * cos20, -cos30 * cos20, sin20];
    let up = [-sin30 * sin20, cos30 * sin20, cos20];
    assert!(eye_is(&["--azimuth", "30", "--elevation", "20"], eye, up));
    for angulation in [
        "LAO 30 CRA 20",
        "cra 20 lao 30",
        "LAO30 CRAN20",
        "LAO 30°, CRA 20°",
    ] {
        assert!(eye_is(&["--carm", angulation], eye, up), "{angulation}");
    }
    let opposite = [-eye[0], eye[1], -eye[2]];
    let opposite_up = [-sin30 * sin20, -cos30 * sin20, cos20];
    assert!(eye_is(&["--carm", "RAO 30 CAU 20"], opposite, opposite_up));
    // The control.
    assert!(!eye_is(&["--carm", "RAO 30 CRA 20"], eye, up));
    for wrong in [
        "LAO",
        "30",
        "LAO 30 RAO 30",
        "LAO -30",
        "XYZ 3",
        "",
        "LAO 200",
    ] {
        let line = ["angioray", "--carm", wrong];
        assert!(Flags::try_parse_from(line).is_err(), "{wrong}");
    }
}

#[test]
fn over_the_pole_nothing_breaks() {
    let (above, back) = ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
    assert!(eye_is(&["--elevation", "90"], above, back));
    assert!(!eye_is(&["--elevation", "89"], above, back));
    assert!(eye_is(&["--elevation", "180"], back, [0.0, 0.0, -1.0]));
    assert!(eye_is(&["--roll", "90"], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]));
}

/// How far the bounding sphere's silhouette reaches, as a share of half the picture's smaller side.
fn extent(line: &[&str]) -> f64 {
    reach(&resolved(line).scene, SPHERE)
}

/// How far a sphere's silhouette about the picture's centre reaches, as a share of half the smaller side.
fn reach(scene: &Scene, sphere: Sphere) -> f64 {
    let smaller = scene.size.aspect().min(1.0);
    let distance = scene.camera.eye_world().distance(sphere.center_world);
    match scene.camera.lens() {
        Lens::Perspective { fov_deg } => {
            let silhouette = (sphere.radius_mm / distance).asin().tan();
            silhouette / ((fov_deg.to_radians() / 2.0).tan() * smaller)
        }
        Lens::Orthographic { height_mm } => sphere.radius_mm / (height_mm / 2.0 * smaller),
    }
}

#[test]
fn the_bounding_sphere_fits_the_smaller_side_at_zoom_1() {
    for line in [
        &["--size", "64x64"][..],
        &["--size", "64x128"],
        &["--size", "128x64", "--fov", "90"],
        &["--fov", "0.5", "--view", "left"],
    ] {
        assert!(
            (extent(line) - 1.0).abs() < 1e-9,
            "{line:?}: {}",
            extent(line)
        );
    }
    assert!((extent(&["--zoom", "2"]) - 2.0).abs() < 1e-9);
    assert!((extent(&["--ortho", "40"]) - 0.5).abs() < 1e-9);
    assert!((extent(&["--ortho", "40", "--zoom", "2"]) - 1.0).abs() < 1e-9);
    // The control.
    assert!((extent(&["--zoom", "1.01"]) - 1.0).abs() > 1e-3);
}

/// A small part of the ball, aside.
const CONTENT: Sphere = Sphere {
    center_world: DVec3::new(5.0, -1.0, 4.0),
    radius_mm: 2.0,
};

/// A scene of the ball of which that part is shown.
fn scene_of_part(line: &[&str]) -> Scene {
    let words = std::iter::once("angioray").chain(line.iter().copied());
    let options = Flags::try_parse_from(words).unwrap().options;
    let subject = Subject {
        content: Content::around(CONTENT),
        ..SUBJECT
    };
    let text = options.to_toml().unwrap();
    assert_eq!(SceneOptions::parse(&text, "again").unwrap(), options);
    options.resolve(&subject).unwrap().scene
}

#[test]
fn the_content_fits_unless_the_volume_is_named() {
    let forward_meets = |scene: &Scene, target: DVec3| {
        let toward = (target - scene.camera.eye_world()).normalize();
        toward.distance(scene.camera.forward()) < 1e-9
    };
    for (line, fitting, other) in [
        (&[][..], CONTENT, SPHERE),
        (&["--fit", "content", "--view", "left"], CONTENT, SPHERE),
        (&["--size", "60x90", "--fov", "70"], CONTENT, SPHERE),
        (&["--fit", "volume", "--roll", "7"], SPHERE, CONTENT),
    ] {
        let scene = scene_of_part(line);
        assert!((reach(&scene, fitting) - 1.0).abs() < 1e-9, "{line:?}");
        assert!(forward_meets(&scene, fitting.center_world), "{line:?}");
        // The control.
        assert!(!forward_meets(&scene, other.center_world), "{line:?}");
    }
    // About a target that is given a sphere as large fits.
    let aimed = scene_of_part(&["--target", "-3,0,0"]);
    let about_target = Sphere {
        center_world: DVec3::new(-3.0, 0.0, 0.0),
        ..CONTENT
    };
    assert!((reach(&aimed, about_target) - 1.0).abs() < 1e-9);
    assert!(forward_meets(&aimed, about_target.center_world));
    // A height is given by the user; the eye plane clears the whole volume.
    let flat = scene_of_part(&["--ortho", "3"]);
    let to_volume = SPHERE.center_world - flat.camera.eye_world();
    assert!(to_volume.dot(flat.camera.forward()) > SPHERE.radius_mm);
    assert!(forward_meets(&flat, CONTENT.center_world));
    assert_eq!(flat.camera.lens(), Lens::Orthographic { height_mm: 3.0 });
}

#[test]
fn a_fit_over_a_stored_scene_places_the_eye_anew_and_an_eye_takes_it_away() {
    let of = |text: &str| SceneOptions::parse(text, "scene").unwrap();
    let stored = resolved(&["--view", "left", "--fov", "40"]).options;
    let framed = of("fit = 'volume'\nview = 'posterior'").over(stored.clone());
    assert_eq!(
        framed.camera,
        of("fit = 'volume'\nview = 'posterior'\nfov = 40\nsize = [512, 512]").camera
    );
    // The control: without it the eye is where it was.
    let kept = of("zoom = 2").over(stored.clone());
    assert_eq!(kept.camera.eye, stored.camera.eye);
    let eye = of("eye = [1, 2, -90]").over(of("fit = 'volume'\nzoom = 2"));
    assert_eq!(eye.camera, of("eye = [1, 2, -90]\nzoom = 2").camera);
}

#[test]
fn an_eye_is_taken_as_it_is() {
    let line = [
        "--eye", "-5,6,-7", "--target", "1,2,3", "--up", "1,0,0", "--fov", "40",
    ];
    let c = camera(&line);
    assert_eq!(c.eye_world(), DVec3::new(-5.0, 6.0, -7.0));
    let forward = DVec3::new(6.0, -4.0, 10.0).normalize();
    assert!(c.forward().distance(forward) < 1e-12);
    assert!(c.right().distance(forward.cross(DVec3::X).normalize()) < 1e-12);
    assert_eq!(c.lens(), Lens::Perspective { fov_deg: 40.0 });
}

#[test]
fn straight_from_above_and_below_an_eye_is_as_the_view() {
    for (eye, view, other) in [
        ("1,2,50", "superior", "inferior"),
        ("1,2,-50", "inferior", "superior"),
    ] {
        let up = camera(&["--eye", eye]).up();
        assert!(
            up.distance(camera(&["--view", view]).up()) < 1e-12,
            "{view}"
        );
        // The control.
        assert!(up.distance(camera(&["--view", other]).up()) > 1.0);
    }
    // A little aside the head is up.
    assert!(camera(&["--eye", "1,2.1,50"]).up().z > 0.0);
}

fn close(a: &Camera, b: &Camera) -> bool {
    let (Lens::Perspective { fov_deg: a_deg }, Lens::Perspective { fov_deg: b_deg }) =
        (a.lens(), b.lens())
    else {
        return a.lens() == b.lens() && a.eye_world().distance(b.eye_world()) < 1e-9;
    };
    a.eye_world().distance(b.eye_world()) < 1e-9
        && a.up().distance(b.up()) < 1e-12
        && a.forward().distance(b.forward()) < 1e-12
        && (a_deg - b_deg).abs() < 1e-9
}

#[test]
fn an_eye_is_turned_and_zoomed_like_a_view() {
    // The anterior view's eye, 40 mm before the centre.
    let eye = ["--eye", "1,-38,3", "--fov", "40"];
    let with = |more: &[&str]| camera(&[&eye[..], more].concat());
    // Twice the magnification halves the half-angle's tangent.
    let halved = 2.0 * (20f64.to_radians().tan() / 2.0).atan().to_degrees();
    let zoomed = with(&["--zoom", "2"]);
    let narrow = camera(&["--eye", "1,-38,3", "--fov", &halved.to_string()]);
    assert!(close(&zoomed, &narrow));
    assert!(!close(&zoomed, &with(&[])));
    let ortho = camera(&["--eye", "1,-38,3", "--ortho", "30", "--zoom", "3"]);
    assert_eq!(ortho.lens(), Lens::Orthographic { height_mm: 10.0 });
    // A quarter clockwise: the patient's left is up.
    assert!(close(&with(&["--roll", "90"]), &with(&["--up", "1,0,0"])));
    assert!(!close(&with(&["--roll", "-90"]), &with(&["--up", "1,0,0"])));
    // The eye goes about the target, as from the view that it stands at.
    let left = camera(&["--eye", "41,2,3", "--fov", "40"]);
    assert!(close(&with(&["--azimuth", "90"]), &left));
    let above = camera(&["--eye", "1,2,43", "--up", "0,1,0", "--fov", "40"]);
    assert!(close(&with(&["--elevation", "90"]), &above));
    assert!(!close(&with(&["--elevation", "-90"]), &above));
    // An eye with an up of its own turns about that.
    let tilted = with(&["--up", "1,0,0", "--azimuth", "90"]);
    assert!(tilted.eye_world().distance(DVec3::new(1.0, 2.0, -37.0)) < 1e-9);
}

#[test]
fn a_flag_over_a_stored_scene_turns_and_zooms_its_eye() {
    let stored = resolved(&["--view", "left", "--azimuth", "20", "--fov", "40"]).options;
    let over = |line: &[&str]| {
        let words = std::iter::once("angioray").chain(line.iter().copied());
        let flags = Flags::try_parse_from(words).unwrap().options;
        flags
            .over(stored.clone())
            .resolve(&SUBJECT)
            .unwrap()
            .scene
            .camera
    };
    let fresh = |line: &[&str]| {
        let all = [&["--view", "left", "--azimuth", "20", "--fov", "40"], line].concat();
        camera(&all)
    };
    for line in [
        &["--zoom", "1.5"],
        &["--roll", "30"],
        &["--elevation", "25"],
    ] {
        assert!(close(&over(line), &fresh(line)), "{line:?}");
        // The control: the flag does something.
        assert!(!close(&over(line), &over(&[])), "{line:?}");
    }
    let further = camera(&["--view", "left", "--azimuth", "30", "--fov", "40"]);
    assert!(close(&over(&["--azimuth", "10"]), &further));
    // A view replaces the eye.
    for line in [&["--view", "right"], &["--carm", "LAO 40"]] {
        let replaced = camera(&[&["--fov", "40"], &line[..]].concat());
        assert!(close(&over(line), &replaced), "{line:?}");
    }
}

#[test]
fn an_orthographic_eye_plane_clears_the_volume_about_any_target() {
    let clearance = |target: DVec3| {
        let text = format!("{},{},{}", target.x, target.y, target.z);
        let c = camera(&["--ortho", "20", "--target", &text]);
        (SPHERE.center_world - c.eye_world()).dot(c.forward()) - SPHERE.radius_mm
    };
    for behind_mm in [0.0, 50.0, 1e6] {
        let target = SPHERE.center_world + DVec3::Y * behind_mm;
        assert!(clearance(target) > 0.0, "{behind_mm}");
        let before = SPHERE.center_world - DVec3::Y * behind_mm;
        assert!(clearance(before) > 0.0, "{behind_mm}");
    }
    // The control: an eye that is given may lie inside.
    let inside = camera(&["--ortho", "20", "--eye", "1,1,3"]);
    let depth = (SPHERE.center_world - inside.eye_world()).dot(inside.forward());
    assert!(depth < SPHERE.radius_mm);
}

#[test]
fn an_eye_too_far_for_its_volume_is_refused() {
    let outcome = |line: &[&str]| {
        let words = std::iter::once("angioray").chain(line.iter().copied());
        let flags = Flags::try_parse_from(words).unwrap();
        flags.options.resolve(&SUBJECT).map(|_| ())
    };
    for line in [
        &["--eye=1e200,0,0"][..],
        &["--eye=1e13,0,0"],
        &["--target=0,-1e150,0"],
        &["--eye=1.1e10,0,0"],
        &["--target=0,0,1e12", "--view", "left"],
    ] {
        let error = outcome(line).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{line:?}");
        let message = error.to_string();
        assert!(
            message.contains("the eye is") || message.contains("too far away"),
            "{message}"
        );
        assert!(message.len() < 160, "{message}");
    }
    // The control.
    assert_eq!(outcome(&["--eye=0.9e10,0,0"]), Ok(()));
    assert_eq!(outcome(&["--fov", "1e-6"]), Ok(()));
}
