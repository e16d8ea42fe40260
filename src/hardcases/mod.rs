//! The scenes of the hard cases: the views, iso values and transfer functions that make a volume
//! of [`HardCase`] hard, as the texts of scene files.

mod emission;
mod isosurface;
mod rays;
mod view;
mod volumes;

use crate::volume::{HardCase, Volume};

/// One view of a hard case.
#[derive(Debug, Clone, PartialEq)]
pub struct HardScene {
    /// Tells the scenes of one case apart; may be part of a file's name.
    pub name: String,
    /// The text of a scene file: camera and picture, without the volume.
    pub toml: String,
}

/// The scenes of a case's volume, at least one. `volume` is number `member` of the case's.
pub fn scenes(case: &HardCase, member: usize, volume: &Volume) -> Vec<HardScene> {
    match case.number {
        ..=6 => rays::scenes(case.name, volume),
        7..=15 => isosurface::scenes(case.name, volume),
        16..=21 => emission::scenes(case.name, volume),
        _ => volumes::scenes(case.name, member, volume),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::SceneOptions;

    #[test]
    fn every_scene_is_a_scene_file_and_has_a_name_of_its_own() {
        for case in HardCase::all() {
            let made = case.volume(0).unwrap();
            let scenes = scenes(case, 0, &made.volume);
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
