//! Phong's reflection on a surface with two sides.

use glam::DVec3;

use crate::scene::{Light, Phong, Reflection};

/// How a ray's points are lit: the model, and the directions toward viewer and light.
#[derive(Debug, Clone, Copy)]
pub struct Lighting {
    phong: Phong,
    /// The unit vector toward the viewer, world space.
    pub to_viewer: DVec3,
    /// The unit vector toward the light, world space.
    pub to_light: DVec3,
}

impl Lighting {
    /// Prepares the lighting of a ray of the unit direction `dir_world`.
    pub fn new(phong: Phong, light: Light, dir_world: DVec3) -> Self {
        let to_viewer = -dir_world;
        Self {
            phong,
            to_viewer,
            to_light: match light {
                Light::Headlight => to_viewer,
                Light::Distant { toward_light } => toward_light.unit(),
            },
        }
    }

    /// The linear light reflected by a point of base colour `color`: `color·(ambient + diffuse·max(n·l,
    /// 0)) + specular·s`, after n is turned to the viewer. A point that faces away from the light has no
    /// specular term.
    pub fn reflect(&self, color: [f64; 3], normal: DVec3) -> [f64; 3] {
        let p = &self.phong;
        let n = if normal.dot(self.to_viewer) < 0.0 {
            -normal
        } else {
            normal
        };
        let facing = n.dot(self.to_light);
        let s = if facing <= 0.0 {
            0.0
        } else {
            let cosine = match p.reflection {
                Reflection::Phong => (2.0 * facing * n - self.to_light).dot(self.to_viewer),
                Reflection::BlinnPhong => {
                    n.dot((self.to_light + self.to_viewer).normalize_or_zero())
                }
            };
            cosine.max(0.0).powf(p.shininess.get())
        };
        let body = p.ambient.get() + p.diffuse.get() * facing.max(0.0);
        color.map(|c| c * body + p.specular.get() * s)
    }

    /// A bound of any channel of [`Self::reflect`] for colours up to 1.
    pub fn brightest(&self) -> f64 {
        let p = &self.phong;
        p.ambient.get() + p.diffuse.get() + p.specular.get()
    }
}

/// `−gradient` as a unit vector; where the gradient is zero, `toward_eye`.
pub fn normal_from_gradient(gradient: DVec3, toward_eye: DVec3) -> DVec3 {
    let largest = gradient.abs().max_element();
    if largest == 0.0 {
        return toward_eye;
    }
    // Scaled first: the squares of tiny components would vanish.
    -(gradient / largest).normalize()
}
