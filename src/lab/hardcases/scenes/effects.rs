//! The scenes of light and lens.

use glam::DVec3;

use super::super::HardScene;
use super::view::View;
use crate::volume::Volume;

/// The column of voxels' places at which the sheet of the hard cases `focused-edge` and `blurred-edge` ends, in mm.
pub const NEAR_EDGE_X: f64 = 39.5;

/// The unit normal of the plate behind it, away from the eye: 60 degrees from the view axis.
pub const FAR_SLOPE: DVec3 = DVec3::new(0.0, 0.5, 0.866_025_403_784_438_6);

/// Where the plane of the hard case `ball-before-plane` lies along y, in mm.
pub const PLANE_Y: f64 = 40.0;

/// Half a pixel a voxel where the sheet is, 50 mm away; the edge lies between the two middle columns.
fn at_edge(name: &str, dof: &str) -> HardScene {
    let edge = DVec3::new(NEAR_EDGE_X, 0.0, 8.0);
    let fov_deg = 2.0 * (2.0_f64 / 50.0).atan().to_degrees();
    let view = View::perspective(name, edge - DVec3::Y * 50.0, edge, fov_deg).size(64, 8);
    // From the eye's side whatever the ray, and without highlights: sheet and plate have each one brightness.
    let view = view.with("light = [0, -1, 0]\nspecular = 0.0");
    view.with(&format!("dof = \"{dof}\"")).lit(0.0, true)
}

pub fn focused_edge(_: &Volume) -> Vec<HardScene> {
    vec![at_edge("near", "focus=50,aperture=8")]
}

pub fn blurred_edge(_: &Volume) -> Vec<HardScene> {
    vec![
        at_edge("far", "focus=90,aperture=8"),
        at_edge("infinity", "focus=1e9,aperture=8"),
        at_edge("narrow", "focus=90,aperture=1e-3"),
    ]
}

pub fn ball_before_plane(_: &Volume) -> Vec<HardScene> {
    let ball = DVec3::new(24.0, 10.0, 24.0);
    let eye = DVec3::new(24.0, -50.0, 24.0);
    let near = View::perspective("near", eye, ball, 26.0).size(40, 40);
    let across = View::ortho("across", ball, DVec3::NEG_Y, 60.0, 32.0).size(40, 40);
    let occluded = |view: View| view.with("ssao = \"radius=8\"").lit(0.0, false);
    vec![occluded(near), occluded(across)]
}

/// Toward the side from which the tilted plane is seen.
pub fn plane_normal() -> DVec3 {
    DVec3::new(0.3, -0.8, 0.5).normalize()
}

pub fn tilted_plane(_: &Volume) -> Vec<HardScene> {
    let (center, normal) = (DVec3::splat(16.2), plane_normal());
    let aside = normal.any_orthonormal_vector();
    let at = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let toward = cos * normal + sin * aside;
        let occluded = |view: View| {
            view.size(16, 16)
                .with("ssao = \"radius=6\"")
                .lit(0.0, false)
        };
        let eye = center + 20.0 * toward;
        [
            occluded(View::ortho(
                format!("across-{degrees}"),
                center,
                toward,
                60.0,
                16.0,
            )),
            occluded(View::perspective(
                format!("near-{degrees}"),
                eye,
                center,
                40.0,
            )),
        ]
    };
    [0.0, 30.0, 60.0, 80.0].into_iter().flat_map(at).collect()
}
