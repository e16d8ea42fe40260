//! Rays aimed at corners, edges, faces and tangents of random cells: none is lost.

use angioray::bench::aimed::{Target, run, target};
use angioray::frame::Kind;
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::render::RayCaster;

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
    assert!(total.borderline * 20 < total.rays, "most rays are nobody's");
    assert!(total.wrong() == 0, "{CAUGHT}: {report}");
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
            "lib/cubic.clh",
            "Mask turns = discriminant > 0.0f;",
            "Mask turns = NO_LANE & discriminant > 0.0f;",
        ),
        // A crossing in the gap between two cells' cubics lost.
        (
            "lib/crossing.clh",
            "which & search->begun & (inside ^ search->inside)",
            "NO_LANE & (inside ^ search->inside)",
        ),
        // A certificate that ignores rounding.
        (
            "lib/crossing.clh",
            "return spread * 4e-6f + iso_error;",
            "return FLOATS(1e-30f);",
        ),
    ] {
        assert_caught(test, file, &[(right, wrong)]);
    }
}

/// Rays of any numbers at all: every loop ends, and what is told is a hit or none.
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
        .map(|_| ([any(), any(), any()], [any(), any(), any()]))
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
