//! The hard cases: every scene on the device and on the reference, the answer known in closed form
//! where there is one, and for each case the small wrong change that it must catch.

#[path = "../common/mod.rs"]
mod common;

mod aimed;
mod effects;
mod emission;
mod isosurface;
mod limits;
mod mutant;
#[path = "../common/mutated.rs"]
mod mutated;
mod pixels;
mod rays;
mod trial;
mod volumes;

use angioray::lab::hardcases::HardCase;

/// The tests of this program by the case that they are of.
const TESTS: &[&[&str]] = &[
    rays::CASES,
    isosurface::CASES,
    emission::CASES,
    volumes::CASES,
    pixels::CASES,
    effects::CASES,
];

#[test]
fn every_case_has_a_test() {
    let mut tested: Vec<&str> = TESTS.concat();
    let mut cases: Vec<&str> = HardCase::all().map(|case| case.name).collect();
    tested.sort_unstable();
    cases.sort_unstable();
    assert_eq!(tested, cases);
}
