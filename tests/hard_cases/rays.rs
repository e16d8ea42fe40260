//! Rays: cases 1 to 5. Case 6, that every loop ends, is `aimed::hostile_rays_end`.

use angioray::frame::{DEPTH, KIND};
use angioray::lab::hardcases::HardCase;
use angioray::scene::{Camera, Scene};
use angioray::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};
use glam::DVec3;

use crate::common::on_reference;
use crate::mutant::{Mutant, kernel};
use crate::trial::{Seen, check, is, near, resolved};

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
        "lib/ray/ray.clh",
        &[("#define MIN_DIR 1e-20f", "#define MIN_DIR 0.0f")],
    );
    check("rays::axis_rays", "axis-rays", something, &[no_guard]);
}

#[test]
fn grid_rays() {
    // The last cell along an axis forgotten.
    let last_cell = kernel(
        "lib/skip/cells.clh",
        &[(
            "a.count = axis_cells(voxels);",
            "a.count = axis_cells(voxels) - 1;",
        )],
    );
    check("rays::grid_rays", "grid-rays", something, &[last_cell]);
}

#[test]
fn face_rays() {
    // A face of the volume does not belong to it.
    let open = kernel(
        "lib/ray/interval.clh",
        &[(
            "above_low > 0.0f | above_high < 0.0f",
            "above_low >= 0.0f | above_high <= 0.0f",
        )],
    );
    fn outermost(seen: &Seen) -> Vec<String> {
        // Rays lie in the grid's planes: the picture's edge is the volume's.
        let all = seen.scene.picture.mode().name() != "mip" || seen.hits() == seen.pixels();
        is("every ray meets the volume", all)
    }
    check("rays::face_rays", "face-rays", outermost, &[open]);
}

#[test]
fn eye_on_grid() {
    // What lies behind the eye is seen.
    let behind = kernel(
        "lib/ray/interval.clh",
        &[(
            "interval.enter = ray.t_min;",
            "interval.enter = FLOATS(-INFINITY);",
        )],
    );
    check(
        "rays::eye_on_grid",
        "eye-on-grid",
        |_| Vec::new(),
        &[behind],
    );
}

#[test]
fn far_camera() {
    // Rays begin at the eye, in single precision.
    let from_the_eye = kernel(
        "lib/ray/camera.clh",
        &[(
            "ray.base_mm = grid.base_mm * len;",
            "ray.base_mm = grid.base_mm * len;
    ray.origin.x.high = (ray.origin.x.high - ray.dir.x.high * ray.base_mm) + ray.dir.x.high * ray.base_mm;
    ray.origin.y.high = (ray.origin.y.high - ray.dir.y.high * ray.base_mm) + ray.dir.y.high * ray.base_mm;
    ray.origin.z.high = (ray.origin.z.high - ray.dir.z.high * ray.base_mm) + ray.dir.z.high * ray.base_mm;",
        )],
    );
    check("rays::far_camera", "far-camera", something, &[from_the_eye]);
}

#[test]
fn lenses() {
    // Lengths along rays at the picture's edge are measured along the middle one.
    let not_unit = kernel("lib/ray/camera.clh", &[("1.0f / len", "FLOATS(1.0f)")]);
    check("rays::lenses", "lenses", something, &[not_unit]);
}

/// The bump's surface is that of the same voxels at the world's origin with a spacing of 1 mm, as
/// the reference sees it.
fn same_bump(seen: &Seen) -> Vec<String> {
    if !seen.name.starts_with("iso") {
        return something(seen);
    }
    let Voxels::U8(voxels) = seen.volume.voxels() else {
        return vec!["the bump is u8".into()];
    };
    let unit = Volume::new(
        seen.volume.dims(),
        Voxels::from(voxels.to_vec()),
        Geometry::default(),
        Rescale::IDENTITY,
        NonFinite::Refuse,
    )
    .unwrap();
    let (case, _) = HardCase::named("tiny-spacing").unwrap();
    let scenes = resolved(case, &unit);
    let (_, scene) = scenes.iter().find(|(name, _)| name == seen.name).unwrap();
    let expected = on_reference(&unit, scene);
    let (kind, depth) = (
        expected.plane(KIND).unwrap(),
        expected.plane(DEPTH).unwrap(),
    );
    let spacing = seen.volume.geometry().smallest_spacing_mm();
    let mut lines = Vec::new();
    for pixel in 0..seen.pixels() {
        lines.extend(is(
            "the pixel hits the same",
            kind[pixel] == seen.kind(pixel),
        ));
        if kind[pixel] != 0 {
            let depth = f64::from(depth[pixel]);
            lines.extend(near(
                "the depth in voxels",
                seen.depth_mm(pixel) / spacing,
                depth,
                1e-3,
            ));
        }
    }
    lines.truncate(3);
    lines
}

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
    check("rays::far_origin", "far-origin", same_bump, &[narrowed]);
}

#[test]
fn tiny_spacing() {
    // A length that is small in mm, not in voxels.
    let a_micron = kernel(
        "lib/ray/interval.clh",
        &[(
            "interval.enter = ray.t_min;",
            "interval.enter = FLOATS(1e-3f);",
        )],
    );
    check("rays::tiny_spacing", "tiny-spacing", same_bump, &[a_micron]);
}

#[test]
fn huge_spacing() {
    // A direction that is small in voxels a mm, not in a whole volume.
    let small = kernel(
        "lib/ray/ray.clh",
        &[("#define MIN_DIR 1e-20f", "#define MIN_DIR 1e-5f")],
    );
    check("rays::huge_spacing", "huge-spacing", same_bump, &[small]);
}
