//! Volumes on which renderers fail, each with a known answer: what a naive kernel, or a program of
//! the field, gets wrong. Some are hard by their voxels, others only in a certain view or with a
//! certain transfer function, which the scenes that go with them (`hardcases`) give.

mod emission;
mod grid;
mod isosurface;
mod rays;
mod volumes;

use std::path::Path;

use crate::error::{Error, Result};
use crate::volume::write_nrrd::{write_nrrd, write_nrrd_of};
use crate::volume::{Geometry, Volume};

pub use volumes::orientation_of;

/// A hard case: one volume, or several of one kind.
#[derive(Debug)]
pub struct HardCase {
    /// What the user types.
    pub name: &'static str,
    /// The kind of difficulty that it belongs to, 1 to 26: rays to 6, isosurface to 15,
    /// emission and absorption to 21, volumes to 26.
    pub number: u32,
    /// One sentence: what is hard.
    pub about: &'static str,
    /// One sentence: the right answer.
    pub truth: &'static str,
    /// The names of its volumes, where it has several; else empty.
    pub members: &'static [&'static str],
    make: fn(usize) -> Result<HardVolume>,
}

/// A hard case's volume.
#[derive(Debug)]
pub struct HardVolume {
    pub volume: Volume,
    /// NRRD's name of the voxel type and little-endian voxels, where a [`Volume`] cannot hold them
    /// as they stand in the file: `volume` is then what reading that file gives.
    stored: Option<(&'static str, Vec<u8>)>,
}

impl From<Volume> for HardVolume {
    fn from(volume: Volume) -> Self {
        Self {
            volume,
            stored: None,
        }
    }
}

impl HardVolume {
    /// Writes an attached NRRD file, as [`write_nrrd`] does.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path, gzip: bool) -> Result<()> {
        match &self.stored {
            Some((type_name, voxels)) => {
                write_nrrd_of(&self.volume, type_name, "little", voxels, path, gzip)
            }
            None => write_nrrd(&self.volume, path, gzip),
        }
    }
}

impl HardCase {
    /// All of them, by number.
    pub fn all() -> impl Iterator<Item = &'static Self> {
        [
            rays::CASES,
            isosurface::CASES,
            emission::CASES,
            volumes::CASES,
        ]
        .into_iter()
        .flatten()
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

    /// How many volumes it has.
    pub fn count(&self) -> usize {
        self.members.len().max(1)
    }

    /// Its volume number `member`, from 0 to [`HardCase::count`].
    ///
    /// # Errors
    /// Usage: there is no such member. Failed: there is not enough memory.
    pub fn volume(&self, member: usize) -> Result<HardVolume> {
        if member >= self.count() {
            return Err(Error::usage(format!(
                "the hard case {} has {} volumes, there is no number {member}",
                self.name,
                self.count()
            )));
        }
        (self.make)(member)
    }
}

/// Spacing 1 mm, origin 0, the world's axes: world and index space are one.
fn unit() -> Geometry {
    Geometry::default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_is_made_and_all_numbers_but_the_loops_have_one() {
        let mut numbers = Vec::new();
        let mut names = Vec::new();
        for case in HardCase::all() {
            names.push(case.name);
            numbers.push(case.number);
            assert!(
                case.about.ends_with('.') && case.truth.ends_with('.'),
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
        // Number 6, that every loop ends, is about all rays and all volumes.
        let expected: Vec<u32> = (1..=26).filter(|&n| n != 6).collect();
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
}
