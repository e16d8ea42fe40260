//! How a surface or a medium reflects the lights of a scene.

use super::{Light, Reflectance, Rgb, Shininess};

/// The specular term.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reflection {
    /// Phong 1975: `max(r·v, 0)^shininess`, r the mirrored light direction.
    Phong,
    /// Blinn 1977: `max(n·h, 0)^shininess`, h half way between light and viewer.
    BlinnPhong,
}

/// Shading of a point with base colour c: `c·ambient + Σ L·(c·diffuse·max(n·l, 0) + specular·s)`, the sum over the
/// lights: L the light's colour times its intensity, n the normal, l toward the light, s the specular term, 0 where
/// n·l ≤ 0. Ambient, diffuse and specular are a share times a colour, channel by channel, in linear light.
///
/// Two-sided: the normal is turned to the viewer before anything else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phong {
    /// The specular term.
    pub reflection: Reflection,
    /// The share of the base colour that is there without light.
    pub ambient: Reflectance,
    /// The colour of that light, linear.
    pub ambient_color: Rgb,
    /// The share of the base colour that is reflected diffusely.
    pub diffuse: Reflectance,
    /// By what the base colour is multiplied where it is reflected diffusely, linear.
    pub diffuse_color: Rgb,
    /// The strength of the highlight.
    pub specular: Reflectance,
    /// The colour of the highlight under white light, linear.
    pub specular_color: Rgb,
    /// The exponent of the highlight: the larger, the smaller.
    pub shininess: Shininess,
}

impl Default for Phong {
    fn default() -> Self {
        Self {
            reflection: Reflection::Phong,
            ambient: Reflectance::AMBIENT,
            ambient_color: Rgb::WHITE,
            diffuse: Reflectance::DIFFUSE,
            diffuse_color: Rgb::WHITE,
            specular: Reflectance::SPECULAR,
            specular_color: Rgb::WHITE,
            shininess: Shininess::default(),
        }
    }
}

/// The most that is reflected whatever the normal, per channel: of a base colour c at most
/// `c·(ambient + diffuse) + specular`, and at least `c·ambient`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MostReflected {
    /// The share of the base colour that is there without light.
    pub ambient: [f64; 3],
    /// The share that is reflected diffusely where all lights are faced.
    pub diffuse: [f64; 3],
    /// The sum of all highlights at their middles.
    pub specular: [f64; 3],
}

impl MostReflected {
    /// Returns the most of any channel of base colours up to 1.
    pub fn of_white(&self) -> f64 {
        let channels = (0..3).map(|c| self.ambient[c] + self.diffuse[c] + self.specular[c]);
        channels.fold(0.0, f64::max)
    }
}

impl Phong {
    /// Returns the factor of the base colour that no light has a part in: linear light.
    pub fn ambient_light(&self) -> [f64; 3] {
        let Rgb(color) = self.ambient_color;
        color.map(|channel| self.ambient.get() * channel)
    }

    /// Returns the factor of the base colour under a light that is faced, and that of the specular term:
    /// linear light.
    pub fn of_light(&self, light: Light) -> ([f64; 3], [f64; 3]) {
        let Rgb(light) = light.linear();
        let under = |share: Reflectance, Rgb(color): Rgb| {
            std::array::from_fn(|c| share.get() * color[c] * light[c])
        };
        (
            under(self.diffuse, self.diffuse_color),
            under(self.specular, self.specular_color),
        )
    }

    /// Returns the most that is reflected of these lights.
    pub fn most_reflected(&self, lights: &[Light]) -> MostReflected {
        let mut most = MostReflected {
            ambient: self.ambient_light(),
            diffuse: [0.0; 3],
            specular: [0.0; 3],
        };
        for light in lights {
            let (diffuse, specular) = self.of_light(*light);
            for c in 0..3 {
                most.diffuse[c] += diffuse[c];
                most.specular[c] += specular[c];
            }
        }
        most
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lights_and_material_give_is_a_product_by_channels() {
        let phong = Phong {
            diffuse: Reflectance::new(0.5).unwrap(),
            diffuse_color: Rgb([1.0, 0.5, 0.0]),
            specular_color: Rgb([0.0, 1.0, 0.25]),
            ..Phong::default()
        };
        let blue: Light = "headlight@#00f@2".parse().unwrap();
        let most = phong.most_reflected(&[Light::HEADLIGHT, blue]);
        assert_eq!(most.ambient, [0.1; 3]);
        assert_eq!(most.diffuse, [0.5, 0.25, 0.0]);
        assert_eq!(most.specular, [0.0, 0.2, 0.05 + 0.1]);
        assert_eq!(most.of_white(), 0.1 + 0.5);
        // The control: the second light counts.
        assert_ne!(most, phong.most_reflected(&[Light::HEADLIGHT]));
    }
}
