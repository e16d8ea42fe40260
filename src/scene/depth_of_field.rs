//! Depth of field: a lens that is no point.

use std::fmt;
use std::str::FromStr;

use super::keyed_text::KeyedText;
use super::quantities::{DistanceMm, RayCount, Share};
use super::{Camera, Lens, LensPoint};
use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::number_text::number;

/// A thin lens at the eye (`--dof`): the colour of a pixel is the mean over the lens of premultiplied linear light along
/// the rays through the point of the focal plane that the pinhole's ray meets. Layers are the pinhole's (Cook, Porter and
/// Carpenter 1984).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthOfField {
    /// Where the focal plane is.
    pub focus: Focus,
    /// How wide the lens is.
    pub aperture: Aperture,
    /// What is out of focus is darkened: by this share where its circle of confusion is 32 pixels wide or wider, by less
    /// where it is smaller.
    pub darken: Share,
}

/// How depth of field is made on a device (`--dof-method`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DofMethod {
    /// Each pixel gathers what reaches it of the circles of confusion of the pinhole's picture, and of what that shows
    /// behind its first surfaces, the nearer before the farther.
    #[default]
    Gather,
    /// The pinhole's picture is mixed with a blurred one by the circles of confusion (Lesar et al. 2015, §III-G).
    Mix,
    /// The whole picture is cast through so many points of the lens; all pixels share them.
    Lens(RayCount),
}

impl FromStr for DofMethod {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text.split_once(':') {
            None if text.eq_ignore_ascii_case("gather") => Ok(Self::Gather),
            None if text.eq_ignore_ascii_case("mix") => Ok(Self::Mix),
            Some((name, rays)) if name.eq_ignore_ascii_case("lens") => {
                Ok(Self::Lens(rays.parse()?))
            }
            _ => Err(Error::usage(format!(
                "'{text}' is no way to make depth of field: write gather, mix or lens:N, N the number of rays of a pixel"
            ))),
        }
    }
}

impl fmt::Display for DofMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gather => f.write_str("gather"),
            Self::Mix => f.write_str("mix"),
            Self::Lens(rays) => write!(f, "lens:{rays}"),
        }
    }
}

/// Where the focal plane is, across the view axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Focus {
    /// So far from the eye along the view axis.
    Distance(DistanceMm),
    /// At the median depth of what is seen.
    Auto,
    /// At what is seen in a pixel, counted from the picture's upper left.
    Pixel {
        /// The column.
        x: u32,
        /// The row.
        y: u32,
    },
    /// At a percentile of the depths of what is seen, nearest rank.
    Percentile(f64),
}

/// How wide a lens is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Aperture {
    /// The diameter of a perspective camera's lens.
    Diameter(DistanceMm),
    /// The half-angle of an orthographic camera's telecentric cones, degrees.
    HalfAngle(f64),
}

impl DepthOfField {
    /// The diameter of the circles of confusion, in pixels, from which on darkening grows no more.
    pub const DARKEST_PX: f64 = 32.0;

    /// The diameter of the widest circles of confusion that are gathered and mixed, in pixels: wider ones blur as these.
    pub const WIDEST_PX: f64 = 64.0;

    const FORM: &'static str = "focus=MM|auto|pixel:X:Y|percentile:P,aperture=MM[,darken=S], with \
                                aperture=…deg for an orthographic camera";

    /// Checks that the aperture is one of the camera's lens, and that the pixel in focus is one of the picture.
    ///
    /// # Errors
    /// Usage: it is not.
    pub fn check(self, lens: Lens, size: ImageSize) -> Result<()> {
        match (self.aperture, lens) {
            (Aperture::Diameter(_), Lens::Orthographic { .. }) => Err(Error::usage(
                "the aperture in mm is for a perspective camera: an orthographic one has a cone's half-angle",
            )
            .hint("write aperture=1deg, or another angle")),
            (Aperture::HalfAngle(_), Lens::Perspective { .. }) => Err(Error::usage(
                "the aperture in degrees is for an orthographic camera: a perspective one has a lens",
            )
            .hint("write aperture=2, or another diameter in mm")),
            _ => match self.focus {
                Focus::Pixel { x, y } if x >= size.width() || y >= size.height() => {
                    Err(Error::usage(format!("no pixel {x}:{y} to focus on in a picture of {size}")))
                }
                _ => Ok(()),
            },
        }
    }

    /// So many points of the lens, spread evenly over it: a spiral from its middle to its rim (Vogel 1979), turned by a
    /// share of a turn.
    pub fn lens_points(
        self,
        count: RayCount,
        focus_mm: f64,
        turn: f64,
    ) -> impl Iterator<Item = LensPoint> {
        /// The golden ratio's fractional part.
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let slope = match self.aperture {
            Aperture::Diameter(mm) => mm.get() / 2.0 / focus_mm,
            Aperture::HalfAngle(degrees) => degrees.to_radians().tan(),
        };
        (0..count.get()).map(move |n| {
            let radius = slope * ((f64::from(n) + 0.5) / f64::from(count.get())).sqrt();
            let (sin, cos) =
                (std::f64::consts::TAU * (f64::from(n) * GOLDEN + turn).fract()).sin_cos();
            LensPoint {
                slope: [radius * cos, radius * sin],
                focus_mm,
            }
        })
    }

    /// The diameter of the circle of confusion of a point at an axial depth, +∞ where nothing is seen: in pixels, above 0
    /// behind the focal plane and below 0 before it.
    pub fn circle_px(self, camera: &Camera, size: ImageSize, focus_mm: f64, axial_mm: f64) -> f64 {
        let [from_inverse, from_depth] = self.growth_px(camera, size);
        if from_depth == 0.0 {
            return from_inverse / focus_mm - from_inverse / axial_mm;
        }
        from_depth * (axial_mm - focus_mm)
    }

    /// What circles of confusion grow by: with 1/s − 1/z, s and z the axial depths of the focal plane and of a point, and with
    /// z − s; one of the two is 0.
    pub fn growth_px(self, camera: &Camera, size: ImageSize) -> [f64; 2] {
        let height = f64::from(size.height());
        match (self.aperture, camera.lens()) {
            (Aperture::Diameter(mm), Lens::Perspective { fov_deg }) => [
                mm.get() * height / (2.0 * (fov_deg.to_radians() / 2.0).tan()),
                0.0,
            ],
            (Aperture::HalfAngle(degrees), Lens::Orthographic { height_mm }) => {
                [0.0, 2.0 * degrees.to_radians().tan() * height / height_mm]
            }
            _ => [0.0; 2],
        }
    }

    /// The diameter of the widest circle of confusion of anything between two axial depths, above 0, pixels: at most
    /// [`DepthOfField::WIDEST_PX`].
    pub fn widest_px(
        self,
        camera: &Camera,
        size: ImageSize,
        focus_mm: f64,
        axial_mm: [f64; 2],
    ) -> f64 {
        let circles = axial_mm.map(|mm| self.circle_px(camera, size, focus_mm, mm).abs());
        circles[0].max(circles[1]).min(Self::WIDEST_PX)
    }

    /// The factor of the light of a pixel with a circle of confusion of this diameter.
    pub fn kept(self, circle_px: f64) -> f64 {
        1.0 - self.darken.get() * (circle_px.abs() / Self::DARKEST_PX).min(1.0)
    }
}

impl Focus {
    /// Whether the depths of the picture decide it.
    pub fn is_seen(self) -> bool {
        !matches!(self, Self::Distance(_))
    }

    /// How far from the eye the focal plane is along the view axis, mm, by the axial depths of all pixels, row by row, +∞
    /// where nothing is seen; they are not read where the distance is given. In a picture of nothing any plane is as good.
    ///
    /// # Errors
    /// Usage: nothing is seen in the pixel that is to be in focus, or it lies at the eye.
    pub fn distance_mm(self, axial_mm: &[f64], size: ImageSize) -> Result<f64> {
        let share = match self {
            Self::Distance(mm) => return Ok(mm.get()),
            Self::Pixel { x, y } => {
                let pixel = (y * size.width() + x) as usize;
                let depth = axial_mm.get(pixel).copied();
                let depth = depth.filter(|mm| mm.is_finite() && *mm > 0.0);
                return depth.ok_or_else(|| {
                    Error::usage(format!(
                        "nothing is seen in pixel {x}:{y}, which is to be in focus"
                    ))
                    .hint("name another pixel, or focus=auto")
                });
            }
            Self::Auto => 0.5,
            Self::Percentile(percent) => percent / 100.0,
        };
        let mut seen: Vec<f64> = axial_mm
            .iter()
            .copied()
            .filter(|mm| mm.is_finite())
            .collect();
        if seen.is_empty() {
            return Ok(1.0);
        }
        let rank = (share * seen.len() as f64).ceil().max(1.0) as usize;
        let (_, depth, _) = seen.select_nth_unstable_by(rank - 1, f64::total_cmp);
        Ok(depth.max(f64::MIN_POSITIVE))
    }
}

impl FromStr for Focus {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "'{text}' is no focus: write a distance in mm, auto, pixel:X:Y or percentile:P"
            ))
        };
        let lower = text.to_ascii_lowercase();
        if lower == "auto" {
            return Ok(Self::Auto);
        }
        match lower.split_once(':') {
            None => Ok(Self::Distance(text.parse()?)),
            Some(("percentile", percent)) => {
                let percent = number(percent)?;
                if !(0.0..=100.0).contains(&percent) {
                    return Err(wrong());
                }
                Ok(Self::Percentile(percent))
            }
            Some(("pixel", place)) => {
                let (x, y) = place.split_once(':').ok_or_else(wrong)?;
                Ok(Self::Pixel {
                    x: x.parse().map_err(|_| wrong())?,
                    y: y.parse().map_err(|_| wrong())?,
                })
            }
            Some(_) => Err(wrong()),
        }
    }
}

impl fmt::Display for Focus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Distance(mm) => write!(f, "{mm}"),
            Self::Auto => f.write_str("auto"),
            Self::Pixel { x, y } => write!(f, "pixel:{x}:{y}"),
            Self::Percentile(percent) => write!(f, "percentile:{percent}"),
        }
    }
}

impl FromStr for Aperture {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let Some(degrees) = text.strip_suffix("deg") else {
            return Ok(Self::Diameter(text.parse()?));
        };
        let degrees = number(degrees)?;
        if !(degrees > 0.0 && degrees < 90.0) {
            return Err(Error::usage(format!(
                "an aperture's half-angle of {degrees} degrees is out of its domain: it must be above 0 and below 90"
            )));
        }
        Ok(Self::HalfAngle(degrees))
    }
}

impl fmt::Display for Aperture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Diameter(mm) => write!(f, "{mm}"),
            Self::HalfAngle(degrees) => write!(f, "{degrees}deg"),
        }
    }
}

impl FromStr for DepthOfField {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut keys = KeyedText::read(text, "depth of field", Self::FORM)?;
        let darken: Option<Share> = keys.take("darken")?;
        let (focus, aperture) = (keys.need("focus")?, keys.need("aperture")?);
        keys.end()?;
        Ok(Self {
            focus,
            aperture,
            darken: darken.unwrap_or(Share::NONE),
        })
    }
}

impl fmt::Display for DepthOfField {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            focus,
            aperture,
            darken,
        } = self;
        write!(f, "focus={focus},aperture={aperture},darken={darken}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn what_is_written_is_read_and_nothing_else() {
        for text in [
            "focus=120,aperture=2.5,darken=0",
            "focus=auto,aperture=1,darken=0.5",
            "focus=pixel:3:40,aperture=0.5deg,darken=1",
            "focus=percentile:25,aperture=3,darken=0",
        ] {
            assert_eq!(text.parse::<DepthOfField>().unwrap().to_string(), text);
        }
        let short: DepthOfField = "aperture=2,focus=AUTO".parse().unwrap();
        assert_eq!(short.to_string(), "focus=auto,aperture=2,darken=0");
        for (wrong, why) in [
            ("focus=auto", "'aperture' is missing"),
            ("aperture=2", "'focus' is missing"),
            ("focus=near,aperture=2", "'near' is not a number"),
            ("focus=pixel:3,aperture=2", "'pixel:3' is no focus"),
            (
                "focus=percentile:101,aperture=2",
                "'percentile:101' is no focus",
            ),
            ("focus=0,aperture=2", "a distance of 0 is out of its domain"),
            (
                "focus=auto,aperture=90deg",
                "half-angle of 90 degrees is out of its domain",
            ),
            ("focus=auto,aperture=2,blur=3", "'blur' is none of its keys"),
        ] {
            let refused = wrong.parse::<DepthOfField>().unwrap_err().to_string();
            assert!(refused.contains(why), "{wrong}: {refused}");
        }
    }

    #[test]
    fn methods_are_named() {
        for text in ["gather", "mix", "lens:16"] {
            assert_eq!(text.parse::<DofMethod>().unwrap().to_string(), text);
        }
        assert_eq!("GATHER".parse::<DofMethod>(), Ok(DofMethod::default()));
        for wrong in ["lens", "lens:0", "mix:3", "gather:2", "blur"] {
            assert!(wrong.parse::<DofMethod>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_focus_is_found_by_nearest_rank() {
        let size = ImageSize::new(3, 2).unwrap();
        let depths = [4.0, f64::INFINITY, 1.0, 3.0, 2.0, f64::INFINITY];
        let at = |text: &str| text.parse::<Focus>().unwrap().distance_mm(&depths, size);
        assert_eq!(at("auto").unwrap(), 2.0);
        assert_eq!(at("percentile:75").unwrap(), 3.0);
        assert_eq!(at("percentile:0").unwrap(), 1.0);
        assert_eq!(at("percentile:100").unwrap(), 4.0);
        assert_eq!(at("pixel:0:1").unwrap(), 3.0);
        assert_eq!(at("7.5").unwrap(), 7.5);
        assert!(at("pixel:1:0").is_err());
    }

    /// A point beside the view axis, seen through all points of the lens, draws a circle of the diameter that is said.
    #[test]
    fn circles_of_confusion_are_those_that_the_rays_draw() {
        let size = ImageSize::new(300, 200).unwrap();
        let perspective = Lens::Perspective { fov_deg: 40.0 };
        let parallel = Lens::Orthographic { height_mm: 80.0 };
        for (lens, aperture) in [(perspective, "6"), (parallel, "2deg")] {
            let camera = Camera::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z, lens).unwrap();
            let text = format!("focus=100,aperture={aperture}");
            let dof: DepthOfField = text.parse().unwrap();
            for depth in [60.0, 100.0, 170.0] {
                // Where the rays of a pixel meet the plane at that depth, in pixels of that plane.
                let pixel_mm = (camera.ray(size, 151.0, 100.0).at_depth(&camera, depth)
                    - camera.ray(size, 150.0, 100.0).at_depth(&camera, depth))
                .length();
                let points = dof.lens_points(RayCount::new(1000).unwrap(), 100.0, 0.0);
                let center = camera.ray(size, 80.0, 60.0).at_depth(&camera, depth);
                let radius_mm = points
                    .map(|point| camera.ray_through(size, 80.0, 60.0, point))
                    .map(|ray| ray.at_depth(&camera, depth).distance(center))
                    .fold(0.0, f64::max);
                let said = dof.circle_px(&camera, size, 100.0, depth);
                assert!(
                    (2.0 * radius_mm / pixel_mm - said.abs()).abs() < 0.01,
                    "{aperture} {depth}: {said}"
                );
                assert_eq!(said > 0.0, depth > 100.0);
            }
        }
    }
}
