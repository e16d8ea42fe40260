//! Emission and absorption: cases 16 to 21.

use angioray::scene::{Homogeneity, HomogeneityLimit, HomogeneityRule, Picture, Quadrature};
use angioray::volume::{NonFinite, Rescale, Volume, Voxels};

use crate::mutant::{Mutant, kernel};
use crate::trial::{Seen, check, is, near};

pub const CASES: &[&str] = &[
    "homogeneous",
    "slab",
    "ramp",
    "gaussian",
    "tf-spike",
    "tf-stairs",
    "tf-outside",
    "opaque-step",
    "faint-4096",
    "thin-bright-sheet",
    "false-homogeneous",
    "anisotropic-1-1-10",
];

/// How far an opacity may be from its closed form.
const CLOSED_FORM: f64 = 2e-4;

/// The length in mm of a pixel's path through the volume: by the slabs, in index space.
fn path_mm(seen: &Seen, pixel: usize) -> f64 {
    let ray = seen.ray(pixel);
    let index = seen.volume.geometry().index_from_world();
    let origin = index.transform_point3(ray.origin_world);
    let dir = index.matrix3 * ray.dir_world;
    let (mut enter, mut exit) = (0.0_f64, f64::INFINITY);
    for (axis, (low, high)) in seen.volume.dims().domain().into_iter().enumerate() {
        let (a, b) = (
            (low - origin[axis]) / dir[axis],
            (high - origin[axis]) / dir[axis],
        );
        enter = enter.max(a.min(b));
        exit = exit.min(a.max(b));
    }
    (exit - enter).max(0.0)
}

/// ∫ −ln(1 − a x) dx over x from 0 to 1: the optical depth of a mm in which the opacity rises from 0
/// to `a` a mm.
fn rising(a: f64) -> f64 {
    ((1.0 - a) * (-a).ln_1p() + a) / a
}

fn opacity(optical_depth: f64) -> f64 {
    -(-optical_depth).exp_m1()
}

/// Opacity along x, of scenes of one pixel.
fn along_x(seen: &Seen, optical_depth: f64) -> Vec<String> {
    if seen.pixels() > 1 {
        return Vec::new();
    }
    near(
        "the opacity",
        seen.alpha(0),
        opacity(optical_depth),
        CLOSED_FORM,
    )
}

/// Of a medium of opacity 0.03 each 2 mm.
fn constant_medium(seen: &Seen) -> Vec<String> {
    let mut lines = Vec::new();
    for pixel in 0..seen.pixels() {
        let expected = opacity(-(1.0_f64 - 0.03).ln() / 2.0 * path_mm(seen, pixel));
        lines.extend(near(
            &format!("the opacity of pixel {pixel}"),
            seen.alpha(pixel),
            expected,
            1e-5,
        ));
    }
    lines.truncate(3);
    lines
}

/// Opacities taken for those of another length.
const OTHER_LENGTH: Mutant = kernel(
    "lib/light/transfer.clh",
    &[("/ cast.unit_length_mm", "/ 2.5f")],
);

#[test]
fn homogeneous() {
    // The last panel of a ray, which is shorter, taken for a whole one.
    let whole_panels = kernel(
        "lib/ray/lattice.clh",
        &[(
            "return min_of(lattice->length_mm, steps * lattice->step_mm);",
            "return steps * lattice->step_mm;",
        )],
    );
    check(
        "emission::homogeneous",
        "homogeneous",
        constant_medium,
        &[whole_panels],
    );
}

#[test]
fn slab() {
    fn expected(seen: &Seen) -> Vec<String> {
        along_x(seen, -8.0 * 0.7_f64.ln() + 4.0 * rising(0.3))
    }
    // The nearer point's opacity between two points.
    let not_between = kernel(
        "lib/light/transfer.clh",
        &[(
            "    ColorOpacity seen;\n",
            "    f = f < 0.5f ? FLOATS(0.0f) : FLOATS(1.0f);\n    ColorOpacity seen;\n",
        )],
    );
    check("emission::slab", "slab", expected, &[not_between]);
}

#[test]
fn ramp() {
    fn expected(seen: &Seen) -> Vec<String> {
        along_x(seen, 64.0 * rising(0.95) / 40.0)
    }
    // Opacity for absorption: right for the faintest alone.
    let faint_alone = kernel(
        "lib/light/transfer.clh",
        &[("depth_of_opacity(clear)", "clear")],
    );
    check("emission::ramp", "ramp", expected, &[faint_alone]);
}

#[test]
fn gaussian() {
    // What lies behind is not hidden.
    let not_hidden = kernel(
        "lib/light/accumulate.clh",
        &[("weighted(light, accumulated->transmittance)", "light")],
    );
    check(
        "emission::gaussian",
        "gaussian",
        |_| Vec::new(),
        &[not_hidden],
    );
}

#[test]
fn tf_spike() {
    fn expected(seen: &Seen) -> Vec<String> {
        along_x(seen, 0.1 * rising(0.9))
    }
    // Whole intervals between the values of two samples left out; panels evaluated by their points
    // alone, whatever lies between.
    let left_out = kernel(
        "lib/light/preintegrated.clh",
        &[(
            "mean_sum(mean_sum(below, whole), above)",
            "mean_sum(below, above)",
        )],
    );
    let points_alone = kernel(
        "pass/adaptive_emission.cl",
        &[("which & near->after != far->after", "NO_LANE")],
    );
    check(
        "emission::tf_spike",
        "tf-spike",
        expected,
        &[left_out, points_alone],
    );
}

#[test]
fn tf_stairs() {
    // A fixed step, which sees stairs where its samples happen to lie.
    let stepped = Mutant::Scene(|scene| {
        let Picture::Emission(emission) = &mut scene.picture else {
            panic!("not an emission");
        };
        emission.quadrature = Quadrature::default();
    });
    check(
        "emission::tf_stairs",
        "tf-stairs",
        |_| Vec::new(),
        &[stepped],
    );
}

#[test]
fn tf_outside() {
    fn expected(seen: &Seen) -> Vec<String> {
        let max = (0..seen.pixels())
            .map(|pixel| seen.alpha(pixel))
            .fold(0.0, f64::max);
        match seen.name {
            "transparent" | "clear-point" | "above" => near("the largest opacity", max, 0.0, 0.0),
            "opaque" => near("the largest opacity", max, 1.0, 1e-6),
            // Of opacity 0.2 each 4 mm.
            _ => {
                let middle = seen.middle();
                let expected = opacity(-(0.8_f64).ln() / 4.0 * path_mm(seen, middle));
                near(
                    "the opacity in the middle",
                    seen.alpha(middle),
                    expected,
                    1e-5,
                )
            }
        }
    }
    check(
        "emission::tf_outside",
        "tf-outside",
        expected,
        &[OTHER_LENGTH],
    );
}

#[test]
fn opaque_step() {
    fn expected(seen: &Seen) -> Vec<String> {
        let mut lines = Vec::new();
        for pixel in 0..seen.pixels() {
            // But for rays that only touch the volume.
            if path_mm(seen, pixel) > 1e-3 {
                lines.extend(near("the opacity", seen.alpha(pixel), 1.0, 1e-6));
            }
        }
        lines.truncate(3);
        lines.extend(is("something is seen", seen.alpha(seen.middle()) > 0.9));
        lines
    }
    // Infinite absorption.
    let infinite = kernel(
        "lib/light/transfer.clh",
        &[(
            "return opacity > 0.0f ? absorption",
            "return opacity == 1.0f ? FLOATS(INFINITY) : opacity > 0.0f ? absorption",
        )],
    );
    check(
        "emission::opaque_step",
        "opaque-step",
        expected,
        &[infinite],
    );
}

#[test]
fn faint_4096() {
    fn expected(seen: &Seen) -> Vec<String> {
        let expected = opacity(-4096.0 * (-1e-6_f64).ln_1p());
        near(
            "the opacity over the exact one",
            seen.alpha(0) / expected,
            1.0,
            1e-4,
        )
    }
    // Opacities without log1p.
    let lost_digits = kernel(
        "lib/light/transfer.clh",
        &[(
            "depth_of_opacity(clear)",
            "depth_of_opacity(1.0f - (1.0f - clear))",
        )],
    );
    check(
        "emission::faint_4096",
        "faint-4096",
        expected,
        &[lost_digits],
    );
}

#[test]
fn thin_bright_sheet() {
    fn expected(seen: &Seen) -> Vec<String> {
        along_x(seen, 110.0 / 255.0 * rising(0.5))
    }
    // Leaves that do not know the voxels that they share with the next leaf: the sheet is the last
    // layer of one.
    let unshared = Mutant::Octree(|volume| {
        let dims = volume.dims();
        let [nx, ..] = dims.usize();
        let voxels = (0..volume.voxels().len()).map(|i| if i % nx == 17 { 255_u8 } else { 0 });
        let voxels = Voxels::from(voxels.collect::<Vec<u8>>());
        let geometry = *volume.geometry();
        Volume::new(dims, voxels, geometry, Rescale::IDENTITY, NonFinite::Refuse).unwrap()
    });
    check(
        "emission::thin_bright_sheet",
        "thin-bright-sheet",
        expected,
        &[unshared],
    );
}

#[test]
fn false_homogeneous() {
    fn expected(seen: &Seen) -> Vec<String> {
        along_x(seen, -14.4 * 0.5_f64.ln() + 3.2 * rising(0.5))
    }
    // The rule on value ranges, at a third of the volume's range: any leaf passes for homogeneous.
    let by_range = Mutant::Scene(|scene| {
        let Picture::Emission(emission) = &mut scene.picture else {
            panic!("not an emission");
        };
        emission.homogeneity = Some(Homogeneity {
            rule: HomogeneityRule::Range,
            limit: HomogeneityLimit::new(0.3).unwrap(),
        });
    });
    check(
        "emission::false_homogeneous",
        "false-homogeneous",
        expected,
        &[by_range],
    );
}

#[test]
fn anisotropic_1_1_10() {
    check(
        "emission::anisotropic_1_1_10",
        "anisotropic-1-1-10",
        constant_medium,
        &[OTHER_LENGTH],
    );
}
