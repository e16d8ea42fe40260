//! How much of a uniform medium planes leave, against closed forms.

use super::*;

const SIDE_MM: f64 = 8.0;
const SIZE_PX: u32 = 160;
const HEIGHT_MM: f64 = 15.0;

/// A cube from 0 to 8 mm along each axis.
fn cube() -> Volume {
    uniform([9, 9, 9], Geometry::default())
}

/// Seen obliquely, so that no face and no plane lies along the rays.
fn oblique_view() -> (Camera, ImageSize) {
    let center = DVec3::splat(SIDE_MM / 2.0);
    let eye = center + DVec3::new(1.0, -2.0, 0.7).normalize() * 50.0;
    let lens = Lens::Orthographic {
        height_mm: HEIGHT_MM,
    };
    let camera = Camera::look_at(eye, center, DVec3::Z, lens).unwrap();
    (camera, ImageSize::new(SIZE_PX, SIZE_PX).unwrap())
}

/// The sets of planes, and what each leaves of the cube's 512 mm³.
fn sets() -> Vec<(Vec<ClipPlane>, f64)> {
    let center = DVec3::splat(SIDE_MM / 2.0);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let corner = |sum: f64| plane(DVec3::NEG_ONE, sum);
    vec![
        (vec![], 512.0),
        // Any plane through the centre.
        (
            vec![plane_at(center, DVec3::new(0.3, -0.7, 0.45) * 1e3)],
            256.0,
        ),
        // A corner's tetrahedron: a³/6; beyond the cube's own corners, less three of (a − 8).
        (vec![corner(6.0)], 36.0),
        (vec![corner(10.0)], (1000.0 - 3.0 * 8.0) / 6.0),
        (vec![plane_at(center, DVec3::NEG_ONE), corner(-1.0)], 0.0),
        // A slab 2 mm thick, and an octant.
        (
            vec![plane(DVec3::X, -3.0), plane(DVec3::NEG_X * 0.01, 0.05)],
            128.0,
        ),
        (axes.map(|axis| plane_at(center, axis)).to_vec(), 64.0),
        // A smaller cube by six planes, as the volume's box is one.
        (
            axes.iter()
                .flat_map(|&axis| [plane(axis, -1.0), plane(-axis, 5.5)])
                .collect(),
            91.125,
        ),
    ]
}

#[test]
fn planes_keep_their_share_of_a_uniform_medium() {
    let volume = cube();
    let sets = sets();
    let view = oblique_view();
    let scenes: Vec<Scene> = (sets.iter())
        .map(|(planes, _)| scene(&volume, medium(), view, planes))
        .collect();
    let pixel_mm2 = (HEIGHT_MM / f64::from(SIZE_PX)).powi(2);
    for engine in engines() {
        let frames = engine.frames(&volume, &scenes);
        let measured: Vec<f64> = (frames.iter())
            .map(|frame| lengths_mm(frame).sum::<f64>() * pixel_mm2)
            .collect();
        for ((planes, reference), measured) in sets.iter().zip(&measured) {
            assert!(
                (measured - reference).abs() <= 0.002 * 512.0,
                "{}: {planes:?} keep {measured} mm³ of {reference}",
                engine.name
            );
        }
        // The control: no set keeps what another does.
        let mut sorted = measured.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(
            sorted
                .windows(2)
                .all(|pair| pair[1] - pair[0] > 0.01 * 512.0)
        );
    }
}
