//! Writing a scene file.

use glam::DVec3;

use super::super::HardScene;
use crate::volume::Volume;

/// A camera: the lines of a scene file that place it.
#[derive(Clone)]
pub struct View {
    name: String,
    lines: String,
}

fn list(v: DVec3) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

/// The direction that is up in the picture for an eye in this direction.
fn up(toward_eye: DVec3) -> DVec3 {
    if toward_eye.x == 0.0 && toward_eye.y == 0.0 {
        DVec3::Y
    } else {
        DVec3::Z
    }
}

impl View {
    fn new(name: impl Into<String>, eye: DVec3, target: DVec3, lens: &str) -> Self {
        let lines = format!(
            "eye = {}\ntarget = {}\nup = {}\n{lens}\n",
            list(eye),
            list(target),
            list(up(eye - target))
        );
        Self {
            name: name.into(),
            lines,
        }
    }

    /// Orthographic, `height_mm` of the world about `target`, from `distance_mm` away.
    pub fn ortho(
        name: impl Into<String>,
        target: DVec3,
        toward_eye: DVec3,
        distance_mm: f64,
        height_mm: f64,
    ) -> Self {
        let eye = target + toward_eye * distance_mm;
        Self::new(name, eye, target, &format!("ortho = {height_mm:?}"))
    }

    pub fn perspective(name: impl Into<String>, eye: DVec3, target: DVec3, fov_deg: f64) -> Self {
        Self::new(name, eye, target, &format!("fov = {fov_deg:?}"))
    }

    /// The whole volume from four radii away, through 30 degrees.
    pub fn whole(name: impl Into<String>, volume: &Volume, toward_eye: DVec3) -> Self {
        let (center, radius_mm) = volume.bounding_sphere();
        let eye = center + toward_eye.normalize() * (4.0 * radius_mm);
        Self::perspective(name, eye, center, 30.0)
    }

    pub fn named(mut self, name: &str) -> Self {
        self.name = name.to_owned();
        self
    }

    pub fn size(mut self, width: u32, height: u32) -> Self {
        self.lines
            .push_str(&format!("size = \"{width}x{height}\"\n"));
        self
    }

    /// Adds one line.
    pub fn with(mut self, line: &str) -> Self {
        self.lines.push_str(line);
        self.lines.push('\n');
        self
    }

    fn show(&self, what: &str, lines: &str) -> HardScene {
        let name = match (&*self.name, what) {
            ("", what) => what.to_owned(),
            (name, "") => name.to_owned(),
            (name, what) => format!("{name}-{what}"),
        };
        HardScene {
            name,
            toml: format!("{}{lines}", self.lines),
        }
    }

    /// The surface at `iso`, unlit.
    pub fn iso(&self, iso: f64, caps: bool) -> HardScene {
        let switch = if caps { "on" } else { "off" };
        let lines =
            format!("mode = \"iso\"\niso = {iso:?}\ncaps = \"{switch}\"\nshading = \"none\"\n");
        let open = if caps { "" } else { "-open" };
        self.show(&format!("iso{iso}{open}"), &lines)
    }

    /// The surface at `iso`, lit.
    pub fn lit(&self, iso: f64, caps: bool) -> HardScene {
        let switch = if caps { "on" } else { "off" };
        let lines =
            format!("mode = \"iso\"\niso = {iso:?}\ncaps = \"{switch}\"\nshading = \"phong\"\n");
        self.show("lit", &lines)
    }

    pub fn mip(&self) -> HardScene {
        self.show("mip", "mode = \"mip\"\n")
    }

    /// Emission and absorption to the end of the ray; points of value and opacity, all of one
    /// colour.
    pub fn dvr(&self, what: &str, unit_length_mm: f64, points: &[(f64, f64)]) -> HardScene {
        let point =
            |&(value, opacity): &(f64, f64)| format!("[{value:?}, 0.9, 0.6, 0.3, {opacity:?}]");
        let points: Vec<String> = points.iter().map(point).collect();
        let lines = format!(
            "mode = \"dvr\"\ntermination = 1.0\n[tf]\nunit_length_mm = {unit_length_mm:?}\npoints = [{}]\n",
            points.join(", ")
        );
        self.show(what, &lines)
    }
}

/// Toward an eye that sees three faces, along no line of the grid.
pub const OBLIQUE: DVec3 = DVec3::new(1.0, -2.0, 0.7);
