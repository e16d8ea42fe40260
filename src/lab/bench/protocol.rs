//! What the camera does while frames are timed.

use glam::DVec3;

use crate::error::{Error, Result};
use crate::options::text_form::readable;
use crate::scene::Scene;

use super::Preset;

/// How the camera moves while frames are timed (`--protocol`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Protocol {
    /// The camera stays where it is.
    #[default]
    Static,
    /// The camera goes once around the volume, a frame a place.
    Orbit,
}

impl Protocol {
    /// Both protocols.
    pub const ALL: [Self; 2] = [Self::Static, Self::Orbit];

    /// The protocol's name, as users write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Static => "static",
            Self::Orbit => "orbit",
        }
    }

    /// How often each setting is timed.
    pub fn frames(self, preset: Preset) -> usize {
        match (self, preset) {
            (Self::Static, _) => preset.repeats(),
            (Self::Orbit, Preset::Quick) => 12,
            (Self::Orbit, Preset::Usual | Preset::Full) => 36,
        }
    }

    /// A description of times under this protocol, for the findings.
    pub(super) fn description(self, preset: Preset) -> String {
        let frames = self.frames(preset);
        let of = match self {
            Self::Static => format!("{frames} repeats in turn"),
            Self::Orbit => {
                format!("an orbit of {frames} frames, all settings in turn at each place")
            }
        };
        format!("the minimum, the median and the 95th percentile of {of}")
    }

    /// The angle by which the camera has turned in a frame, degrees.
    pub(super) fn azimuth_deg(self, preset: Preset, frame: usize) -> f64 {
        match self {
            Self::Static => 0.0,
            Self::Orbit => 360.0 * frame as f64 / self.frames(preset) as f64,
        }
    }
}

impl std::str::FromStr for Protocol {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let is_it = |one: &Self| one.name().eq_ignore_ascii_case(text.trim());
        let found = Self::ALL.into_iter().find(is_it);
        found.ok_or_else(|| {
            Error::usage(format!("'{text}' is not a protocol: write static or orbit"))
        })
    }
}

impl std::fmt::Display for Protocol {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

readable!(Protocol);

/// The scene with its camera turned about the axis through `center_world` toward the head: as
/// `--azimuth` does from the named views.
pub(super) fn turned(scene: &Scene, center_world: DVec3, degrees: f64) -> Scene {
    Scene {
        camera: scene.camera.turned(DVec3::Z, center_world, degrees),
        ..scene.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Dataset;
    use super::*;
    use crate::scene::Camera;
    use crate::volume::PhantomKind;

    #[test]
    fn an_orbit_turns_as_azimuth_does_and_closes() {
        let dataset = Dataset::phantom(PhantomKind::MarschnerLobb).unwrap();
        let (center_world, _) = dataset.volume.bounding_sphere();
        let scene = dataset.surface(16).unwrap();
        let text = "mode = 'iso'\nsize = '16x16'\nazimuth = 70\nelevation = 20\n";
        let by_flag = dataset.resolved(text).unwrap().camera;
        let eye = |degrees| turned(&scene, center_world, degrees).camera;
        let apart = |a: Camera, b: Camera| {
            let eyes = a.eye_world().distance(b.eye_world());
            eyes + a.up().distance(b.up()) + a.forward().distance(b.forward())
        };
        assert!(apart(eye(40.0), by_flag) < 1e-9);
        // The control: the other way round it is elsewhere.
        assert!(apart(eye(-40.0), by_flag) > 1.0);
        assert!(apart(eye(360.0), scene.camera) < 1e-9);
        for preset in [Preset::Quick, Preset::Usual] {
            let frames = Protocol::Orbit.frames(preset);
            assert_eq!(Protocol::Orbit.azimuth_deg(preset, frames), 360.0);
        }
    }
}
