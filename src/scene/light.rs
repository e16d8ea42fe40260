//! The lights of a scene: where each is, its colour and its intensity.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use super::{Camera, Intensity, Rgb, SrgbColor};
use crate::error::{Error, Result};
use crate::number_text::{number, numbers};

/// A direction, as it was given: of any length but 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction(DVec3);

impl Direction {
    /// Constructs a direction from a vector along it.
    ///
    /// # Errors
    /// Usage: a vector without direction: 0, NaN or infinite.
    pub fn new(vector: DVec3) -> Result<Self> {
        match vector.try_normalize() {
            Some(_) => Ok(Self(vector)),
            None => Err(Error::usage(format!(
                "the vector {vector} has no direction"
            ))),
        }
    }

    /// Returns the unit vector.
    pub fn unit(self) -> DVec3 {
        self.0.normalize()
    }
}

/// Where a light is, and what it is fixed to.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum LightPlace {
    /// `headlight`: at the eye, so that every ray is lit along itself.
    #[default]
    Headlight,
    /// `x,y,z`: far away and fixed to the patient.
    Distant {
        /// Points from the scene toward the light, world space.
        toward_light: Direction,
    },
    /// `camera:x,y,z`: far away and fixed to the camera, with which it turns.
    Camera {
        /// Points from the scene toward the light, camera space: right, up, toward the viewer.
        toward_light: Direction,
    },
    /// `camera-point:x,y,z`: a point, fixed to the camera. Its light does not get less with the distance.
    CameraPoint {
        /// Where it is from the eye, camera space: right, up, toward the viewer, mm.
        at_camera: DVec3,
    },
    /// `point:x,y,z`: a point, fixed to the patient. Its light does not get less with the distance.
    Point {
        /// Where it is, world space, mm.
        at_world: DVec3,
    },
}

/// From where a light shines on a picture, in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightFrom {
    /// From the eye: along each ray.
    Eye,
    /// From far away: the unit vector toward the light.
    Direction(DVec3),
    /// From a point, mm.
    Point(DVec3),
}

impl LightFrom {
    /// Returns the unit vector from a point of the scene toward the light; `to_viewer` is the one toward the
    /// viewer, which a light at the point itself has too. All in world space.
    pub fn toward(self, at_world: DVec3, to_viewer: DVec3) -> DVec3 {
        match self {
            Self::Eye => to_viewer,
            Self::Direction(toward_light) => toward_light,
            Self::Point(light_world) => {
                let away = light_world - at_world;
                let largest = away.abs().max_element();
                // Scaled first: the squares of tiny components would vanish.
                (away / largest).try_normalize().unwrap_or(to_viewer)
            }
        }
    }

    /// Returns how far the light is from a point of the scene, mm; +∞ where it shines from far away, or from the eye.
    pub fn distance_mm(self, at_world: DVec3) -> f64 {
        match self {
            Self::Eye | Self::Direction(_) => f64::INFINITY,
            Self::Point(light_world) => light_world.distance(at_world),
        }
    }
}

/// A light of a scene (`--light`): a place, a colour and an intensity, in one text
/// `PLACE[@COLOR][@INTENSITY]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Where it is.
    pub place: LightPlace,
    /// Its colour.
    pub color: SrgbColor,
    /// The factor of its colour, in linear light.
    pub intensity: Intensity,
}

impl Light {
    /// The maximum number of lights of a scene.
    pub const MAX_COUNT: usize = 4;

    /// Checks how many lights a scene has.
    ///
    /// # Errors
    /// Usage: more than [`Self::MAX_COUNT`].
    pub fn check_count(lights: &[Self]) -> Result<()> {
        let (count, max) = (lights.len(), Self::MAX_COUNT);
        if count > max {
            return Err(Error::usage(format!(
                "{count} lights: there may be at most {max}"
            )));
        }
        Ok(())
    }

    /// A white light at the eye.
    pub const HEADLIGHT: Self = Self::white(LightPlace::Headlight);

    /// Constructs a white light of intensity 1.
    pub const fn white(place: LightPlace) -> Self {
        Self {
            place,
            color: SrgbColor::WHITE,
            intensity: Intensity::ONE,
        }
    }

    /// Constructs a white light far away that is fixed to the patient; `toward_light` points from the scene
    /// toward it, in world space.
    ///
    /// # Errors
    /// As [`Direction::new`].
    pub fn distant(toward_light: DVec3) -> Result<Self> {
        let toward_light = Direction::new(toward_light)?;
        Ok(Self::white(LightPlace::Distant { toward_light }))
    }

    /// Constructs a white light far away that is fixed to the camera; `toward_light` points from the scene
    /// toward it, in camera space: right, up, toward the viewer.
    ///
    /// # Errors
    /// As [`Direction::new`].
    pub fn of_camera(toward_light: DVec3) -> Result<Self> {
        let toward_light = Direction::new(toward_light)?;
        Ok(Self::white(LightPlace::Camera { toward_light }))
    }

    /// Constructs a white light at a point in world space, mm.
    ///
    /// # Errors
    /// Usage: a point that is not finite.
    pub fn point(at_world: DVec3) -> Result<Self> {
        if !at_world.is_finite() {
            return Err(Error::usage("a light's point x,y,z must be finite"));
        }
        Ok(Self::white(LightPlace::Point { at_world }))
    }

    /// Constructs a white light at a point that is fixed to the camera, from its eye in camera space: right, up, toward the
    /// viewer, mm.
    ///
    /// # Errors
    /// Usage: a point that is not finite.
    pub fn camera_point(at_camera: DVec3) -> Result<Self> {
        if !at_camera.is_finite() {
            return Err(Error::usage("a light's point x,y,z must be finite"));
        }
        Ok(Self::white(LightPlace::CameraPoint { at_camera }))
    }

    /// Returns what the light gives, linear light: 1 is the white light of intensity 1.
    pub fn linear(self) -> Rgb {
        let Rgb(color) = self.color.linear();
        Rgb(color.map(|channel| channel * self.intensity.get()))
    }

    /// Returns from where the light shines on a camera's picture.
    pub fn shines_from(self, camera: &Camera) -> LightFrom {
        match self.place {
            LightPlace::Headlight => LightFrom::Eye,
            LightPlace::Distant { toward_light } => LightFrom::Direction(toward_light.unit()),
            LightPlace::Camera { toward_light } => {
                LightFrom::Direction(from_camera(camera, toward_light.unit()).normalize())
            }
            LightPlace::CameraPoint { at_camera } => {
                LightFrom::Point(camera.eye_world() + from_camera(camera, at_camera))
            }
            LightPlace::Point { at_world } => LightFrom::Point(at_world),
        }
    }
}

/// A vector of camera space (right, up, toward the viewer) in world space.
fn from_camera(camera: &Camera, DVec3 { x, y, z }: DVec3) -> DVec3 {
    camera.right() * x + camera.up() * y - camera.forward() * z
}

impl Default for Light {
    fn default() -> Self {
        Self::HEADLIGHT
    }
}

impl FromStr for LightPlace {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "'{text}' is no place of a light: write headlight, the direction x,y,z toward it, \
                 camera:x,y,z for one fixed to the camera (right, up, toward the viewer), \
                 point:x,y,z for a point in mm, or camera-point:x,y,z for one in mm from the eye"
            ))
        };
        let three = |text: &str| numbers(text).map(DVec3::from_array).ok_or_else(wrong);
        let direction = |text: &str| {
            let vector = three(text)?;
            Direction::new(vector).map_err(|_| {
                let DVec3 { x, y, z } = vector;
                Error::usage(format!(
                    "a light at {x},{y},{z} has no direction: write a vector of any length but 0 toward it"
                ))
            })
        };
        let text = text.trim();
        match text.split_once(':') {
            None if text.eq_ignore_ascii_case("headlight") => Ok(Self::Headlight),
            None => Ok(Self::Distant {
                toward_light: direction(text)?,
            }),
            Some((fixed, vector)) if fixed.eq_ignore_ascii_case("camera") => Ok(Self::Camera {
                toward_light: direction(vector)?,
            }),
            Some((fixed, point)) if fixed.eq_ignore_ascii_case("camera-point") => {
                Ok(Self::CameraPoint {
                    at_camera: three(point)?,
                })
            }
            Some((fixed, point)) if fixed.eq_ignore_ascii_case("point") => Ok(Self::Point {
                at_world: three(point)?,
            }),
            Some(_) => Err(wrong()),
        }
    }
}

impl fmt::Display for LightPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (fixed, DVec3 { x, y, z }) = match self {
            Self::Headlight => return f.write_str("headlight"),
            Self::Distant { toward_light } => ("", toward_light.0),
            Self::Camera { toward_light } => ("camera:", toward_light.0),
            Self::CameraPoint { at_camera } => ("camera-point:", *at_camera),
            Self::Point { at_world } => ("point:", *at_world),
        };
        write!(f, "{fixed}{x},{y},{z}")
    }
}

impl FromStr for Light {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut parts = text.split('@');
        let mut light = Self::white(parts.next().unwrap_or_default().parse()?);
        let parts: Vec<&str> = parts.collect();
        let intensity = parts.last().filter(|last| number(last).is_ok());
        light.intensity = intensity.map_or(Ok(Intensity::ONE), |text| text.parse())?;
        match parts[..parts.len() - usize::from(intensity.is_some())] {
            [] => {}
            [color] => light.color = color.parse()?,
            _ => {
                return Err(Error::usage(format!(
                    "'{text}' is not a light: behind its place there may be a colour and an intensity, \
                     such as headlight@ivory@0.8"
                )));
            }
        }
        Ok(light)
    }
}

impl fmt::Display for Light {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.place)?;
        if self.color != SrgbColor::WHITE {
            write!(f, "@{}", self.color)?;
        }
        if self.intensity != Intensity::ONE {
            write!(f, "@{}", self.intensity)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Lens;

    #[test]
    fn a_light_is_written_as_it_is_read() {
        for text in [
            "headlight",
            "1,-2.5,0",
            "camera:0.5,1,1",
            "point:10,-20,3e20",
            "headlight@0.8",
            "point:1,2,3@1,0.5,0.25",
            "camera:0,0,1@1,0.5,0.25@2",
            "camera-point:-80,0.5,-20@0.5",
        ] {
            let light: Light = text.parse().unwrap();
            assert_eq!(light.to_string().parse::<Light>().unwrap(), light, "{text}");
        }
        let warm: Light = " HEADLIGHT@#ff8000@0.5".parse().unwrap();
        assert_eq!(warm.place, LightPlace::Headlight);
        assert_eq!(warm.color, "#ff8000".parse().unwrap());
        assert_eq!(warm.linear().0[0], 0.5);
        // The control: a light of another intensity is another light.
        assert_ne!(warm, "headlight@#ff8000".parse().unwrap());
        assert_eq!(
            "headlight@white@1".parse::<Light>().unwrap(),
            Light::HEADLIGHT
        );
    }

    #[test]
    fn what_is_no_light_is_refused_by_what_is_wrong_with_it() {
        for (text, says) in [
            ("moon", "'moon' is no place of a light"),
            ("point:1,2", "no place of a light"),
            ("camera-point:1,2", "no place of a light"),
            ("sun:1,2,3", "no place of a light"),
            ("0,0,0", "a light at 0,0,0 has no direction"),
            ("camera:0,0,0", "a light at 0,0,0 has no direction"),
            ("headlight@plaid", "'plaid' is not a colour"),
            ("headlight@-1", "an intensity of -1 is out"),
            ("headlight@red@1@2", "a colour and an intensity"),
            ("headlight@1@red", "a colour and an intensity"),
        ] {
            let refused = text.parse::<Light>().unwrap_err().to_string();
            assert!(refused.contains(says), "{text}: {refused}");
        }
    }

    #[test]
    fn a_light_of_the_camera_turns_with_it_and_the_patients_does_not() {
        let looking = |eye| {
            let lens = Lens::Orthographic { height_mm: 10.0 };
            Camera::look_at(eye, DVec3::ZERO, DVec3::Z, lens).unwrap()
        };
        let (front, side) = (looking(DVec3::NEG_Y * 9.0), looking(DVec3::X * 9.0));
        let of_camera = Light::of_camera(DVec3::new(2.0, 0.0, 0.0)).unwrap();
        assert_eq!(
            of_camera.shines_from(&front),
            LightFrom::Direction(front.right())
        );
        assert_eq!(
            of_camera.shines_from(&side),
            LightFrom::Direction(side.right())
        );
        assert_ne!(front.right(), side.right());
        let viewer = Light::of_camera(DVec3::Z).unwrap();
        assert_eq!(
            viewer.shines_from(&side),
            LightFrom::Direction(-side.forward())
        );
        let lamp = Light::camera_point(DVec3::new(2.0, 3.0, -4.0)).unwrap();
        for camera in [front, side] {
            let at = camera.eye_world() + 2.0 * camera.right() + 3.0 * camera.up();
            let LightFrom::Point(found) = lamp.shines_from(&camera) else {
                panic!("a point");
            };
            assert!(found.distance(at + 4.0 * camera.forward()) < 1e-12);
        }
        let patient = Light::distant(DVec3::X * 3.0).unwrap();
        assert_eq!(patient.shines_from(&front), patient.shines_from(&side));
    }

    #[test]
    fn a_point_in_the_hit_shines_from_the_viewer() {
        let at = DVec3::new(1.0, 2.0, 3.0);
        let from = Light::point(at).unwrap();
        let from = from.shines_from(
            &Camera::look_at(
                DVec3::X,
                DVec3::ZERO,
                DVec3::Z,
                Lens::Orthographic { height_mm: 1.0 },
            )
            .unwrap(),
        );
        assert_eq!(from.toward(at, DVec3::Z), DVec3::Z);
        let beside = at - DVec3::X * 1e-200;
        assert_eq!(from.toward(DVec3::new(0.0, 2.0, 3.0), DVec3::Z), DVec3::X);
        assert!(from.toward(beside, DVec3::Z).is_finite());
    }
}
