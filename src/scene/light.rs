//! The light and how a surface reflects it.

use glam::DVec3;

/// One distant white light.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Light {
    /// At the eye: every ray is lit along itself.
    #[default]
    Headlight,
    /// From far away; the unit vector points from the scene toward the light, in world space.
    Distant { toward_light: DVec3 },
}

/// The specular term.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reflection {
    /// Phong 1975: `max(r·v, 0)^shininess`, r the mirrored light direction.
    Phong,
    /// Blinn 1977: `max(n·h, 0)^shininess`, h half way between light and viewer.
    BlinnPhong,
}

/// Shading of a point with base colour c: `c·(ambient + diffuse·max(n·l, 0)) + specular·s`.
///
/// Two-sided: the normal is turned to the viewer before anything else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phong {
    pub reflection: Reflection,
    pub ambient: f64,
    pub diffuse: f64,
    pub specular: f64,
    pub shininess: f64,
}

impl Default for Phong {
    fn default() -> Self {
        Self {
            reflection: Reflection::Phong,
            ambient: 0.1,
            diffuse: 0.9,
            specular: 0.2,
            shininess: 32.0,
        }
    }
}
