//! Rays aimed at corners, edges, faces and tangents of random cells: none is lost.

use angioray::frame::{Certificate, Kind};
use angioray::lab::bench::aimed::{Aim, AimedRay, Report, Target, answers, run, target};
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::render::{FirstCrossing, IndexRay, RayCaster};

use crate::common;
use crate::mutant::{CAUGHT, assert_caught, is_mutant};

const SEED: u64 = 20_261_122;

/// How many rays: `ANGIORAY_RAYS`, or ten million; of a mutant, which shows itself soon, fewer.
fn count() -> u64 {
    if is_mutant() {
        return 200_000;
    }
    match std::env::var("ANGIORAY_RAYS") {
        Ok(text) => text.parse().expect("ANGIORAY_RAYS is a number of rays"),
        Err(_) => 10_000_000,
    }
}

#[test]
fn no_aimed_ray_is_lost() {
    let Some(device) = common::device() else {
        return;
    };
    let report = run(&device, SEED, count(), &Silent).unwrap();
    println!("{report}");
    let total = report.total();
    assert_eq!(total.rays, count());
    assert!(total.hits * 5 > total.rays, "few rays hit");
    assert!(
        total.borderline * 20 < total.rays,
        "most rays are borderline"
    );
    assert!(total.wrong() == 0, "{CAUGHT}: {report}");
}

/// Answers of the device to some rays at a target, and what the reference makes of them.
fn answered(
    target: &Target,
    rays: &[([f32; 3], [f32; 3])],
) -> Option<(Report, Vec<FirstCrossing>)> {
    let device = common::device()?;
    let aimed: Vec<AimedRay> = rays
        .iter()
        .map(|&(origin, dir)| AimedRay {
            aim: Aim::Corner,
            origin,
            dir,
        })
        .collect();
    let mut caster = RayCaster::new(&device, None);
    Some(answers(&mut caster, target, 0, &aimed).unwrap())
}

/// Rays of which a hundred million were answered wrong, at targets of seed 4: two pass by the volume's
/// own corner at 2e-6 voxel, and one enters so near to the face between two cells that single precision
/// puts it in the next, which is inside.
#[test]
fn rays_a_hair_beside_a_corner_are_distinguished() {
    let passing = [
        (
            911,
            [41.984375, -3.593_749_8, -28.453125],
            [-0.734375, 0.09375, 0.703125],
        ),
        (1791, [40.5, 4.0, -31.999_998], [-0.6875, 0.0, 0.75]),
    ];
    for (number, origin, dir) in passing {
        let target = target(4, number).unwrap();
        let Some((report, found)) = answered(&target, &[(origin, dir)]) else {
            return;
        };
        let total = report.total();
        assert_eq!((total.hits, total.borderline), (0, 0), "{number}: {report}");
        let nothing = total.wrong() == 0 && found[0].kind == Kind::Nothing;
        assert!(nothing, "{CAUGHT}: {number}: {found:?} {report}");
        // The control: moved by a hair it touches the corner, which is at the iso value.
        let touching = [nudged(origin, 0), nudged(origin, 1), nudged(origin, 2)];
        let touching: Vec<_> = touching.into_iter().flatten().map(|o| (o, dir)).collect();
        let (report, found) = answered(&target, &touching).unwrap();
        assert!(report.total().wrong() == 0, "{CAUGHT}: {report}");
        assert!(
            found.iter().any(|found| found.kind == Kind::Cap),
            "{found:?}"
        );
    }
    let target = target(4, 907).unwrap();
    let ray = ([-2.281_250_2, 26.953125, -19.5], [0.21875, -0.296875, 0.5]);
    let (report, found) = answered(&target, &[ray]).unwrap();
    let total = report.total();
    assert_eq!((total.hits, total.borderline), (1, 0), "{CAUGHT}: {report}");
    let hit = found[0];
    let right = total.wrong() == 0 && hit.kind == Kind::Surface && hit.t == 47.0;
    assert!(
        right && hit.certificate != Certificate::Miss,
        "{CAUGHT}: {hit:?}"
    );
}

/// An origin whose coordinate on an axis is the next few numbers of single precision.
fn nudged(origin: [f32; 3], axis: usize) -> Vec<[f32; 3]> {
    let moved = |bits: i32| {
        let mut moved = origin;
        let steps = (origin[axis].to_bits() as i32 + bits) as u32;
        moved[axis] = f32::from_bits(steps);
        moved
    };
    (-8..=8).filter(|&bits| bits != 0).map(moved).collect()
}

/// Rays through and beside every corner and edge of a volume that is solid: one is capped exactly when it
/// meets the volume, whatever hair it passes by.
#[test]
fn a_ray_meets_a_solid_volume_exactly_when_it_does() {
    let dims = [5.0, 3.0, 9.0];
    let target = Target {
        volume: common::volume_of([5, 3, 9], |_, _, _| 7u8),
        iso: 3.0,
        caps: true,
    };
    let mut rays = Vec::new();
    for k in 0..4096_u32 {
        let pick = |shift: u32, n: u32| (k.wrapping_mul(2_654_435_761) >> shift) % n;
        let corner: [f32; 3] =
            std::array::from_fn(|a| if k >> a & 1 == 1 { dims[a] - 1.0 } else { 0.0 });
        let mut dir: [f32; 3] =
            std::array::from_fn(|a| (pick(3 + 5 * a as u32, 127) as f32 - 63.0) / 64.0);
        if k % 5 == 0 {
            dir[pick(9, 3) as usize] = 0.0;
        }
        let steps = 40.0 + pick(7, 60) as f32;
        let mut origin: [f32; 3] = std::array::from_fn(|a| corner[a] - steps * dir[a]);
        let hair = (-14.0 - pick(11, 9) as f32).exp2();
        origin[pick(17, 3) as usize] += if k & 8 == 0 { hair } else { -hair };
        rays.push((origin, dir));
    }
    let Some((report, found)) = answered(&target, &rays) else {
        return;
    };
    let total = report.total();
    let caps = found.iter().filter(|hit| hit.kind == Kind::Cap).count();
    assert!((1000..3500).contains(&caps), "{caps}");
    // Not even borderline: the reference's own answer to every ray.
    let exact = total.wrong() == 0 && total.borderline == 0 && total.hits == caps as u64;
    assert!(exact, "{CAUGHT}: {report}");
}

/// Rays that enter by a face within a hair of the face between two cells, one of which is solid.
#[test]
fn a_ray_begins_in_the_cell_in_which_it_enters() {
    // Inside from x = 2 on, and there on the iso value itself.
    let target = Target {
        volume: common::volume_of([5, 4, 4], |x, _, _| if x < 2.0 { 0u8 } else { 3 }),
        iso: 3.0,
        caps: false,
    };
    let enters = |x: f32, dir_x: f32| ([x, 9.0, 1.5], [dir_x, -1.0, 0.0]);
    let rays = [
        // By the face y = 3 at x = 2 - 2^-24, which single precision takes for 2, and at 2 + 2^-24.
        enters(0.5 - (-24_f32).exp2(), 0.25),
        enters(0.5 + (-24_f32).exp2(), 0.25),
        // Beside the face, in it, and from it on.
        enters(2.0 - (-23_f32).exp2(), 0.0),
        enters(2.0, 0.0),
        enters(3.5, -0.25),
    ];
    let Some((report, found)) = answered(&target, &rays) else {
        return;
    };
    let kinds: Vec<Kind> = found.iter().map(|hit| hit.kind).collect();
    let right = [
        Kind::Surface,
        Kind::Nothing,
        Kind::Nothing,
        Kind::Nothing,
        Kind::Surface,
    ];
    let is_right = kinds == right && report.total().wrong() == 0;
    assert!(is_right, "{CAUGHT}: {found:?} {report}");
}

/// The wrong changes that the rays beside corners must see.
#[test]
fn a_cast_that_begins_by_single_precision_is_caught() {
    if common::device().is_none() {
        return;
    }
    let by_high = (
        "lib/math/pair.clh",
        "place.high & place.low < 0.0f ?",
        "place.high & NO_LANE ?",
    );
    let no_pairs = ("lib/ray/interval.clh", "if (!ANY(unsure))", "if (true)");
    for (test, (file, right, wrong)) in [
        (
            "aimed::rays_a_hair_beside_a_corner_are_distinguished",
            by_high,
        ),
        (
            "aimed::rays_a_hair_beside_a_corner_are_distinguished",
            no_pairs,
        ),
        (
            "aimed::a_ray_meets_a_solid_volume_exactly_when_it_does",
            no_pairs,
        ),
        (
            "aimed::a_ray_begins_in_the_cell_in_which_it_enters",
            by_high,
        ),
    ] {
        assert_caught(test, file, &[(right, wrong)]);
    }
}

/// The wrong changes that the aimed rays must see.
#[test]
fn a_cast_that_loses_rays_is_caught() {
    if common::device().is_none() {
        return;
    }
    let test = "aimed::no_aimed_ray_is_lost";
    for (file, right, wrong) in [
        // The turning points of the cubic forgotten.
        (
            "lib/volume/cubic.clh",
            "Mask turns = discriminant > 0.0f;",
            "Mask turns = NO_LANE & discriminant > 0.0f;",
        ),
        // A crossing in the gap between two cells' cubics lost.
        (
            "lib/find/crossing.clh",
            "which & state->begun & (inside ^ state->inside)",
            "NO_LANE & (inside ^ state->inside)",
        ),
        // A certificate that ignores rounding.
        (
            "lib/find/crossing.clh",
            "return spread * FIELD_ROUNDING + iso_error;",
            "return FLOATS(1e-30f);",
        ),
    ] {
        assert_caught(test, file, &[(right, wrong)]);
    }
}

/// Rays of any numbers at all: every loop ends, and what is reported is a hit or none.
#[test]
fn hostile_rays_end() {
    let Some(device) = common::device() else {
        return;
    };
    let numbers = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.5,
        3.0,
        1e-30,
        -1e-20,
        1e-45,
        1e-7,
        1e30,
        -1e38,
        f32::MAX,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];
    let mut state = SEED;
    let mut any = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        numbers[(state >> 40) as usize % numbers.len()]
    };
    let rays: Vec<_> = (0..200_000)
        .map(|n| {
            let (origin, dir) = ([any(), any(), any()], [any(), any(), any()]);
            let whole = IndexRay::forward(origin, dir);
            let part = [any().abs(), any()];
            if n % 2 == 0 {
                whole
            } else {
                IndexRay { t: part, ..whole }
            }
        })
        .collect();
    let mut caster = RayCaster::new(&device, None);
    let mut hits = 0;
    for n in 0..5 {
        let Target { volume, iso, caps } = target(SEED, n).unwrap();
        let octree = Octree::build(&volume, Leaf::new(4).unwrap(), &Silent).unwrap();
        for found in caster.cast(&volume, &octree, iso, caps, &rays).unwrap() {
            let nothing = found.kind == Kind::Nothing;
            hits += usize::from(!nothing);
            assert!(nothing || found.t >= 0.0, "{found:?}");
        }
    }
    assert!(hits > 1000, "{hits}");
}
