//! Hard cases: volumes on which renderers fail, the views, iso values and transfer functions that make
//! them hard, and the right answers. What a naive kernel, or a program of the field, gets wrong.
//!
//! A case's volumes and its scenes are joined in the tables of `volumes`.

mod case;
mod scenes;
mod volumes;

pub use case::{HardCase, HardScene, HardVolume};
pub use scenes::effects::{FAR_SLOPE, NEAR_EDGE_X, PLANE_Y};
pub use scenes::pixels::LINE_RADIUS_MM;
pub use volumes::{line_axes, orientation_of};

use crate::error::{Error, Result};

impl HardCase {
    /// All hard cases, by number.
    pub fn all() -> impl Iterator<Item = &'static Self> {
        volumes::CASES.into_iter().flatten()
    }

    /// The case called `name`, and the number of its member: `NAME`, or `NAME.MEMBER`; without a
    /// member the first.
    ///
    /// # Errors
    /// Usage: there is no such case, or no such member; the hint lists those that there are.
    pub fn named(name: &str) -> Result<(&'static Self, usize)> {
        let (case, member) = match name.split_once('.') {
            Some((case, member)) => (case, Some(member)),
            None => (name, None),
        };
        let Some(case) = Self::all().find(|each| each.name.eq_ignore_ascii_case(case)) else {
            let names: Vec<&str> = Self::all().map(|each| each.name).collect();
            return Err(Error::usage(format!("there is no hard case '{case}'"))
                .hint(format!("the hard cases are {}", names.join(", "))));
        };
        let Some(member) = member else {
            return Ok((case, 0));
        };
        let found = case.members.iter().position(|&each| each == member);
        let found = found.ok_or_else(|| {
            let error = Error::usage(format!("the hard case {} has no '{member}'", case.name));
            if case.members.is_empty() {
                error.hint(format!("it is one volume: write {}", case.name))
            } else {
                error.hint(format!("it has {}", case.members.join(", ")))
            }
        })?;
        Ok((case, found))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::SceneOptions;

    #[test]
    fn every_case_is_made_and_all_numbers_but_the_loops_have_one() {
        let mut numbers = Vec::new();
        let mut names = Vec::new();
        for case in HardCase::all() {
            names.push(case.name);
            numbers.push(case.number);
            assert!(
                case.about.ends_with('.') && case.answer.ends_with('.'),
                "{}",
                case.name
            );
            for member in 0..case.count() {
                assert!(case.volume(member).is_ok(), "{} {member}", case.name);
            }
            assert!(case.volume(case.count()).is_err());
        }
        assert!(numbers.is_sorted());
        numbers.dedup();
        // Number 6, that every loop ends, is about all rays and all volumes; of sizes, orbits and closed forms of light (29 to 32)
        // there are tests without a case.
        let expected: Vec<u32> = (1..=28).filter(|&n| n != 6).chain([33]).collect();
        assert_eq!(numbers, expected);
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
    }

    #[test]
    fn cases_and_members_are_found_by_name() {
        assert_eq!(HardCase::named("tangent").unwrap().0.name, "tangent");
        assert_eq!(HardCase::named("types.i8").unwrap().1, 3);
        for wrong in ["", "tangents", "tangent.1", "types.u64", "types."] {
            let error = HardCase::named(wrong).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{wrong}");
            assert!(error.hint_text().is_some(), "{wrong}");
        }
    }

    #[test]
    fn every_scene_is_a_scene_file_and_has_a_name_of_its_own() {
        for case in HardCase::all() {
            let made = case.volume(0).unwrap();
            let scenes = case.scenes(&made.volume);
            assert!(!scenes.is_empty(), "{}", case.name);
            let mut names: Vec<&str> = scenes.iter().map(|scene| &*scene.name).collect();
            for scene in &scenes {
                let place = format!("{} {}", case.name, scene.name);
                let read = SceneOptions::parse(&scene.toml, &place);
                assert!(read.is_ok(), "{:?}: {}", read.err(), scene.toml);
                let is_plain = |c: char| c.is_ascii_alphanumeric() || "-._".contains(c);
                assert!(scene.name.chars().all(is_plain), "{place}");
            }
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), scenes.len(), "{}", case.name);
        }
    }
}
