//! Isosurfaces: cases 7 to 15.

use angioray::octree::Leaf;
use angioray::scene::{SamplingMethod, Scene, StepVoxels};
use angioray::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};
use glam::DVec3;

use crate::mutant::{Mutant, NEVER_ABOVE, kernel};
use crate::trial::{Seen, check, is, near};

pub const CASES: &[&str] = &[
    "tangent",
    "three-roots",
    "two-roots-in-a-step",
    "plateau",
    "iso-at-extremes",
    "saddle",
    "thin-vessels",
    "touching-vessels",
    "one-bright-voxel",
    "stenosis",
    "sheet",
    "step-edge",
    "corner-voxels",
    "zero-gradient",
    "mirrored-normals",
    "marschner-lobb-41",
    "marschner-lobb-32",
    "white-noise",
];

/// The turning points of the cubic forgotten: only the ends of a cell are tested.
const NO_TURNS: Mutant = kernel(
    "lib/volume/cubic.clh",
    &[(
        "Mask turns = discriminant > 0.0f;",
        "Mask turns = NO_LANE & discriminant > 0.0f;",
    )],
);

/// A corner of the cell forgotten in the test whether it matters.
const SEVEN_CORNERS: Mutant = kernel(
    "lib/volume/cubic.clh",
    &[(
        "for (uint i = 1u; i < 8u; i++)\n        max = max_of",
        "for (uint i = 1u; i < 7u; i++)\n        max = max_of",
    )],
);

/// Weights of eight bits, as texture units have them.
const TEXTURE_WEIGHTS: Mutant = kernel(
    "lib/volume/field.clh",
    &[(
        "Floats difference = b - a;",
        "Floats difference = b - a;\n    t = rint(t * 256.0f) / 256.0f;",
    )],
);

/// The field's highest term along the ray forgotten.
const NO_CUBE: Mutant = kernel(
    "lib/volume/cubic.clh",
    &[("cubic.c3 = f2 * d.z;", "cubic.c3 = 0.0f;")],
);

/// The root not looked for: the middle of its bracket.
const NO_ROOT: Mutant = kernel(
    "lib/volume/cubic.clh",
    &[
        (
            "#define CUBIC_MAX_ITERATIONS 32u",
            "#define CUBIC_MAX_ITERATIONS 0u",
        ),
        (
            "clamp_to(from + (to - from) * (f_from / (f_from - f_to)), from, to)",
            "0.5f * (from + to)",
        ),
    ],
);

/// A packet taken for the ray on its lower side.
const LOWEST_RAY: Mutant = kernel(
    "lib/skip/packet.clh",
    &[(
        "{cells.x, cells.y, cells.z, cells.w}",
        "{cells.x, cells.x, cells.z, cells.z}",
    )],
);

/// The steps of the papers.
fn fixed_steps(scene: &mut Scene) {
    scene.sampling.method = SamplingMethod::Fixed;
    scene.sampling.step = StepVoxels::new(0.5).unwrap();
    scene.sampling.probe = false;
}

/// The depth of a point, in the middle pixel.
fn depth_of(seen: &Seen, point: DVec3) -> f64 {
    let ray = seen.ray(seen.middle());
    (point - ray.origin_world).dot(ray.dir_world)
}

#[test]
fn tangent() {
    fn expected(seen: &Seen) -> Vec<String> {
        match seen.name {
            "diagonal-iso149.99-open" => {
                let s = 0.5 - (0.25_f64 - 149.99 / 600.0).sqrt();
                let depth = depth_of(seen, DVec3::splat(s));
                near("the depth", seen.depth_mm(0), depth, 1e-3)
            }
            "diagonal-iso150.01-open" => is("nothing is hit", seen.kind(0) == 0),
            _ => is("something is hit", seen.hits() > 0),
        }
    }
    check("isosurface::tangent", "tangent", expected, &[NO_TURNS]);
}

#[test]
fn three_roots() {
    fn expected(seen: &Seen) -> Vec<String> {
        if !seen.name.starts_with("diagonal") {
            return is("something is hit", seen.hits() > 0);
        }
        let depth = depth_of(seen, DVec3::splat(0.5 - 3_f64.sqrt() / 4.0));
        near("the depth", seen.depth_mm(0), depth, 1e-3)
    }
    // Any of the roots, not the first.
    let last_root = kernel(
        "lib/find/crossing.clh",
        &[(
            "Mask in_first = starts_in ^ a_in;",
            "Mask in_first = (starts_in ^ a_in) & !(a_in ^ b_in);",
        )],
    );
    check(
        "isosurface::three_roots",
        "three-roots",
        expected,
        &[last_root],
    );
}

#[test]
fn two_roots_in_a_step() {
    fn expected(seen: &Seen) -> Vec<String> {
        let through = seen.name.starts_with("oblique") || seen.hits() == seen.pixels();
        let mut lines = is("the layer has no hole", through);
        let off = 5.0 / 255.0;
        for (name, x) in [("x-iso250-open", 8.0 - off), ("-x-iso250-open", 8.0 + off)] {
            if seen.name == name {
                let depth = depth_of(seen, DVec3::new(x, 4.0, 4.0));
                lines.extend(near("the depth", seen.depth_mm(seen.middle()), depth, 1e-3));
            }
        }
        lines
    }
    check(
        "isosurface::two_roots_in_a_step",
        "two-roots-in-a-step",
        expected,
        &[Mutant::Scene(fixed_steps)],
    );
}

/// "Above" for "at or above", at the ends of a cell's pieces and of slices beyond them.
const ABOVE_ONLY: Mutant = kernel(
    "lib/find/crossing.clh",
    &[
        ("Mask a_in = f_a >= 0.0f;", "Mask a_in = f_a > 0.0f;"),
        ("Mask b_in = f_b >= 0.0f;", "Mask b_in = f_b > 0.0f;"),
        ("b_in ^ (f_end >= 0.0f)", "b_in ^ (f_end > 0.0f)"),
        (
            "skip.class == CLASS_ABOVE ? FLOATS(1.0f)",
            "skip.class == CLASS_ABOVE ? FLOATS(-1.0f)",
        ),
    ],
);

#[test]
fn plateau() {
    fn expected(seen: &Seen) -> Vec<String> {
        // The block of 100 begins at y = 8 as seen from +y.
        if seen.name == "front-iso100" {
            // Its neighbours are 20: 100 is reached at its own voxels.
            let depth = depth_of(seen, DVec3::new(5.5, 8.0, 5.0));
            return near("the depth", seen.depth_mm(seen.middle()), depth, 1e-3);
        }
        // Of the voxel of 200 itself hardly a point.
        is(
            "something is hit",
            seen.name.contains("199") || seen.hits() > 0,
        )
    }
    check("isosurface::plateau", "plateau", expected, &[ABOVE_ONLY]);
}

#[test]
fn iso_at_extremes() {
    fn expected(seen: &Seen) -> Vec<String> {
        let iso = seen.name.split_once("iso").map_or("", |(_, rest)| rest);
        let open = iso.ends_with("-open");
        let iso: f64 = iso.trim_end_matches("-open").parse().unwrap();
        let hits = seen.hits();
        if iso > 200.0 || (iso <= 20.0 && open) {
            is("nothing is hit", hits == 0)
        } else if iso <= 20.0 {
            is("the volume is closed by caps", hits > 100)
        } else {
            is("at most a point is hit", hits <= 1)
        }
    }
    let never_above = kernel("lib/find/crossing.clh", &NEVER_ABOVE);
    check(
        "isosurface::iso_at_extremes",
        "iso-at-extremes",
        expected,
        &[never_above],
    );
}

#[test]
fn saddle() {
    check("isosurface::saddle", "saddle", |_| Vec::new(), &[NO_CUBE]);
}

#[test]
fn thin_vessels() {
    fn expected(seen: &Seen) -> Vec<String> {
        is(
            "a twentieth of the pixels hits",
            seen.hits() > seen.pixels() / 20,
        )
    }
    check(
        "isosurface::thin_vessels",
        "thin-vessels",
        expected,
        &[NO_TURNS],
    );
}

#[test]
fn touching_vessels() {
    fn expected(seen: &Seen) -> Vec<String> {
        if !seen.name.starts_with("front") {
            return Vec::new();
        }
        // The dark voxels lie at x = 8: the volume's middle.
        let gap = seen.pixels() / 2 + seen.scene.size.width() as usize / 2;
        let row = gap - seen.scene.size.width() as usize / 2;
        let hits = (0..seen.scene.size.width() as usize).filter(|x| seen.kind(row + x) != 0);
        let mut lines = is("rays between them pass", seen.kind(gap) == 0);
        lines.extend(is("both are hit", hits.count() >= 12));
        lines
    }
    check(
        "isosurface::touching_vessels",
        "touching-vessels",
        expected,
        &[NO_ROOT],
    );
}

#[test]
fn one_bright_voxel() {
    fn expected(seen: &Seen) -> Vec<String> {
        if seen.name != "x-iso250-open" {
            return Vec::new();
        }
        let depth = depth_of(seen, DVec3::new(4.0 + 5.0 / 255.0, 4.0, 4.0));
        near("the depth", seen.depth_mm(0), depth, 1e-3)
    }
    check(
        "isosurface::one_bright_voxel",
        "one-bright-voxel",
        expected,
        &[SEVEN_CORNERS],
    );
}

#[test]
fn stenosis() {
    fn expected(seen: &Seen) -> Vec<String> {
        if !seen.name.starts_with("front") {
            return Vec::new();
        }
        let middle = seen.middle();
        let mut lines = is("the gap is open", seen.kind(middle) == 0);
        lines.extend(is(
            "the vessel is not",
            seen.kind(middle - 9) != 0 && seen.kind(middle + 9) != 0,
        ));
        lines
    }
    check(
        "isosurface::stenosis",
        "stenosis",
        expected,
        &[SEVEN_CORNERS],
    );
}

#[test]
fn sheet() {
    fn expected(seen: &Seen) -> Vec<String> {
        let mut lines = Vec::new();
        // Where the ray crosses the sheet's plane well inside the volume, it hits.
        for pixel in 0..seen.pixels() {
            let ray = seen.ray(pixel);
            let t = (16.0 - ray.origin_world.x) / ray.dir_world.x;
            let at = ray.origin_world + ray.dir_world * t;
            let inside = |c: f64| (0.5..31.5).contains(&c);
            if t.is_finite() && inside(at.y) && inside(at.z) && seen.kind(pixel) == 0 {
                lines.push(format!("a hole at {at}"));
            }
        }
        lines.truncate(3);
        lines
    }
    check(
        "isosurface::sheet",
        "sheet",
        expected,
        &[Mutant::Octree(without_border), LOWEST_RAY],
    );
}

#[test]
fn step_edge() {
    fn expected(seen: &Seen) -> Vec<String> {
        let Some(iso) = seen.name.strip_prefix("x-iso") else {
            return Vec::new();
        };
        let iso: f64 = iso.trim_end_matches("-open").parse().unwrap();
        let depth = depth_of(seen, DVec3::new(7.0 + iso / 255.0, 4.0, 4.0));
        near("the depth", seen.depth_mm(seen.middle()), depth, 1e-3)
    }
    check("isosurface::step_edge", "step-edge", expected, &[NO_ROOT]);
}

/// The volume as nodes see it that forget their border voxels: each leaf has the range of the voxels that
/// its cells begin at. A voxel on a node's border is moved into the node's inside.
fn without_border(volume: &Volume) -> Volume {
    let [nx, ny, nz] = volume.dims().usize();
    let Voxels::U8(voxels) = volume.voxels() else {
        panic!("made for u8");
    };
    let mut moved = vec![0u8; voxels.len()];
    let edge = Leaf::default().edge() as usize;
    let inward = |c: usize, n: usize| {
        if c.is_multiple_of(edge) && c + 1 < n {
            c + 1
        } else {
            c
        }
    };
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let to = inward(x, nx) + nx * (inward(y, ny) + ny * inward(z, nz));
                moved[to] = moved[to].max(voxels[x + nx * (y + ny * z)]);
            }
        }
    }
    Volume::new(
        volume.dims(),
        Voxels::from(moved),
        Geometry::default(),
        Rescale::IDENTITY,
        NonFinite::Refuse,
    )
    .unwrap()
}

#[test]
fn corner_voxels() {
    fn expected(seen: &Seen) -> Vec<String> {
        if !seen.name.contains("mip") {
            return Vec::new();
        }
        let bright = (0..seen.pixels())
            .filter(|&pixel| seen.value(pixel) > 254.9)
            .count();
        is("twelve voxels are found", bright == 12)
    }
    check(
        "isosurface::corner_voxels",
        "corner-voxels",
        expected,
        &[Mutant::Octree(without_border), LOWEST_RAY],
    );
}

#[test]
fn zero_gradient() {
    fn expected(seen: &Seen) -> Vec<String> {
        let mut lines = is("every ray hits", seen.hits() == seen.pixels());
        for pixel in 0..seen.pixels() {
            let off = seen.normal(pixel).distance(-seen.ray(pixel).dir_world);
            lines.extend(near("the normal's distance from the eye", off, 0.0, 1e-3));
        }
        lines.truncate(3);
        lines
    }
    let no_normal = kernel(
        "lib/math/unit.clh",
        &[(
            "Mask vanishes = ",
            "fallback.x = fallback.y = fallback.z = FLOATS(0.0f);\n    Mask vanishes = ",
        )],
    );
    check(
        "isosurface::zero_gradient",
        "zero-gradient",
        expected,
        &[no_normal],
    );
}

#[test]
fn mirrored_normals() {
    fn expected(seen: &Seen) -> Vec<String> {
        let mut worst: f64 = 0.0;
        let mut farthest: f64 = 0.0;
        for pixel in (0..seen.pixels()).filter(|&pixel| seen.kind(pixel) == 1) {
            let ray = seen.ray(pixel);
            let at = ray.origin_world + ray.dir_world * seen.depth_mm(pixel);
            farthest = farthest.max((at.length() - 8.0).abs());
            worst = worst.max(at.angle_between(seen.normal(pixel)).to_degrees());
        }
        let mut lines = near("the normals' largest angle from radial", worst, 0.0, 2.0);
        lines.extend(near("the sphere's largest error in mm", farthest, 0.0, 0.1));
        lines.extend(is("something is hit", seen.hits() > 100));
        lines
    }
    let index_space = kernel(
        "lib/volume/normal.clh",
        &[(
            "return turned_by_rows(volume.gradient_row_x, volume.gradient_row_y, volume.gradient_row_z, covector);",
            "return covector;",
        )],
    );
    check(
        "isosurface::mirrored_normals",
        "mirrored-normals",
        expected,
        &[index_space],
    );
}

#[test]
fn marschner_lobb_41() {
    check(
        "isosurface::marschner_lobb_41",
        "marschner-lobb-41",
        |_| Vec::new(),
        &[TEXTURE_WEIGHTS],
    );
}

#[test]
fn marschner_lobb_32() {
    check(
        "isosurface::marschner_lobb_32",
        "marschner-lobb-32",
        |_| Vec::new(),
        &[NO_TURNS],
    );
}

#[test]
fn white_noise() {
    fn expected(seen: &Seen) -> Vec<String> {
        is("most rays hit", seen.hits() > seen.pixels() / 4)
    }
    check(
        "isosurface::white_noise",
        "white-noise",
        expected,
        &[TEXTURE_WEIGHTS],
    );
}
