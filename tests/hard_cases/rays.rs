//! Rays: cases 1 to 5. Case 6, that every loop ends, is `aimed::hostile_rays_end`.

use angioray::scene::{Camera, Scene};
use glam::DVec3;

use crate::mutant::{Mutant, kernel};
use crate::trial::{Seen, is, judge, near};

pub const CASES: &[&str] = &[
    "axis-rays",
    "grid-rays",
    "face-rays",
    "eye-on-grid",
    "far-camera",
    "lenses",
    "far-origin",
    "tiny-spacing",
    "huge-spacing",
];

/// A volume's picture is not empty, nor is all of it hit.
fn something(seen: &Seen) -> Vec<String> {
    let hits = seen.hits();
    is("something is hit", hits > 0)
}

#[test]
fn axis_rays() {
    // No guard on directions without a component.
    let no_guard = kernel(
        "lib/ray.clh",
        &[("#define LEAST_DIR 1e-20f", "#define LEAST_DIR 0.0f")],
    );
    judge("rays::axis_rays", "axis-rays", something, &[no_guard]);
}

#[test]
fn grid_rays() {
    // The last cell along an axis forgotten.
    let last_cell = kernel(
        "lib/cells.clh",
        &[("dir > 0.0f ? cell + 1u < count", "dir > 0.0f ? cell + 2u < count")],
    );
    judge("rays::grid_rays", "grid-rays", something, &[last_cell]);
}

#[test]
fn face_rays() {
    // A face of the volume does not belong to it.
    let open = kernel(
        "lib/ray.clh",
        &[(
            "if (above_low > 0.0f || above_high < 0.0f)",
            "if (above_low >= 0.0f || above_high <= 0.0f)",
        )],
    );
    fn outermost(seen: &Seen) -> Vec<String> {
        // Rays lie in the grid's planes: the picture's edge is the volume's.
        let all = seen.scene.picture.mode().to_string() != "mip" || seen.hits() == seen.pixels();
        is("every ray meets the volume", all)
    }
    judge("rays::face_rays", "face-rays", outermost, &[open]);
}

#[test]
fn eye_on_grid() {
    // What lies behind the eye is seen.
    let behind = kernel(
        "lib/ray.clh",
        &[("interval.enter = 0.0f;", "interval.enter = -INFINITY;")],
    );
    judge("rays::eye_on_grid", "eye-on-grid", |_| Vec::new(), &[behind]);
}

#[test]
fn far_camera() {
    // Rays begin at the eye, in single precision.
    let from_the_eye = kernel(
        "lib/ray.clh",
        &[(
            "ray.origin = origin.high;",
            "ray.origin = (origin.high - dir.high * (grid.base_mm * len)) + dir.high * (grid.base_mm * len);",
        )],
    );
    judge("rays::far_camera", "far-camera", something, &[from_the_eye]);
}

#[test]
fn lenses() {
    // Lengths along rays at the picture's edge are measured along the middle one.
    let not_unit = kernel("lib/ray.clh", &[("1.0f / len", "1.0f")]);
    judge("rays::lenses", "lenses", something, &[not_unit]);
}

/// The ball's picture is the same wherever and however large it is: pixels hit, counted at the
/// world's origin with voxels of 1 mm.
fn same_ball(seen: &Seen) -> Vec<String> {
    match &*seen.name {
        "mip" => near("the maximum in the middle", seen.value(seen.middle()), 250.0, 12.0),
        name if name.starts_with("iso") => {
            let hits = seen.hits() as f64;
            near("pixels hit", hits, BALL_PIXELS, 2.0)
        }
        _ => Vec::new(),
    }
}

const BALL_PIXELS: f64 = 441.0;

#[test]
fn far_origin() {
    // World coordinates in single precision.
    let narrowed = Mutant::Scene(|scene: &mut Scene| {
        let narrow = |v: DVec3| DVec3::from_array(v.to_array().map(|c| f64::from(c as f32)));
        let camera = &scene.camera;
        let eye = narrow(camera.eye_world());
        scene.camera =
            Camera::look_at(eye, eye + camera.forward(), camera.up(), camera.lens()).unwrap();
    });
    judge("rays::far_origin", "far-origin", same_ball, &[narrowed]);
}

#[test]
fn tiny_spacing() {
    // A length that is small in mm, not in voxels.
    let a_micron = kernel(
        "lib/ray.clh",
        &[("interval.enter = 0.0f;", "interval.enter = 1e-3f;")],
    );
    judge("rays::tiny_spacing", "tiny-spacing", same_ball, &[a_micron]);
}

#[test]
fn huge_spacing() {
    // A direction that is small in voxels a mm, not in a whole volume.
    let small = kernel(
        "lib/ray.clh",
        &[("#define LEAST_DIR 1e-20f", "#define LEAST_DIR 1e-5f")],
    );
    judge("rays::huge_spacing", "huge-spacing", same_ball, &[small]);
}
