//! Phong's reflection of several lights on a surface with two sides.

use glam::DVec3;
use smallvec::SmallVec;

use crate::scene::{Camera, Light, LightFrom, Phong, Reflection};

/// A light of the scene: from where it shines, and what of it is reflected at most.
#[derive(Debug, Clone, Copy)]
pub struct Lamp {
    /// From where it shines, world space.
    pub from: LightFrom,
    /// The factor of the base colour where the light is faced.
    diffuse: [f64; 3],
    /// The factor of the specular term.
    specular: [f64; 3],
}

/// What a point makes of light: a factor of its base colour, and light of its own colour.
#[derive(Debug, Clone, Copy)]
struct Reflected {
    body: [f64; 3],
    gloss: [f64; 3],
}

/// How a picture's points are lit: the model and the lights.
#[derive(Debug, Clone)]
pub struct Lighting {
    phong: Phong,
    lamps: SmallVec<[Lamp; Light::MAX_COUNT]>,
}

/// A point that is lit.
#[derive(Debug, Clone, Copy)]
pub struct LitPoint {
    /// Where it is, world space, mm.
    pub at_world: DVec3,
    /// The unit vector toward the viewer, world space.
    pub to_viewer: DVec3,
    /// The unit normal, world space, of either side.
    pub normal: DVec3,
}

impl Lighting {
    /// Prepares the lighting of a camera's picture.
    pub fn new(phong: Phong, lights: &[Light], camera: &Camera) -> Self {
        let lamp = |light: &Light| {
            let (diffuse, specular) = phong.of_light(*light);
            Lamp {
                from: light.shines_from(camera),
                diffuse,
                specular,
            }
        };
        Self {
            phong,
            lamps: lights.iter().map(lamp).collect(),
        }
    }

    /// The lights, in the scene's order.
    pub fn lamps(&self) -> &[Lamp] {
        &self.lamps
    }

    /// The linear light reflected by a point of base colour `color`, which the share `reached` of the light from everywhere
    /// gets to, and the share `visibility` of each light that it faces:
    /// `color·ambient·reached + Σ V·L·(color·diffuse·max(n·l, 0) + specular·s)`, after n is turned to the viewer.
    pub fn reflect(
        &self,
        color: [f64; 3],
        point: LitPoint,
        reached: f64,
        visibility: impl Fn(&Lamp) -> f64,
    ) -> [f64; 3] {
        let ambient = Reflected {
            body: self.phong.ambient_light().map(|channel| channel * reached),
            gloss: [0.0; 3],
        };
        let all = (self.lamps.iter()).fold(ambient, |sum, lamp| {
            self.with_light(sum, lamp, point, &visibility)
        });
        std::array::from_fn(|c| color[c] * all.body[c] + all.gloss[c])
    }

    /// The sum with what one light adds, of which a share reaches the point. A point that faces away
    /// from the light has no specular term.
    fn with_light(
        &self,
        sum: Reflected,
        lamp: &Lamp,
        point: LitPoint,
        visibility: &impl Fn(&Lamp) -> f64,
    ) -> Reflected {
        let LitPoint {
            at_world,
            to_viewer,
            normal,
        } = point;
        let n = if normal.dot(to_viewer) < 0.0 {
            -normal
        } else {
            normal
        };
        let to_light = lamp.from.toward(at_world, to_viewer);
        let facing = n.dot(to_light);
        if facing <= 0.0 {
            return sum;
        }
        let cosine = match self.phong.reflection {
            Reflection::Phong => (2.0 * facing * n - to_light).dot(to_viewer),
            Reflection::BlinnPhong => n.dot((to_light + to_viewer).normalize_or_zero()),
        };
        let visibility = visibility(lamp);
        let s = cosine.max(0.0).powf(self.phong.shininess.get());
        Reflected {
            body: std::array::from_fn(|c| sum.body[c] + visibility * (lamp.diffuse[c] * facing)),
            gloss: std::array::from_fn(|c| sum.gloss[c] + visibility * (lamp.specular[c] * s)),
        }
    }

    /// A bound of any channel of [`Self::reflect`] for colours up to 1.
    pub fn brightest(&self) -> f64 {
        let most = |c: usize| {
            let of_lamps = self.lamps.iter().map(|l| l.diffuse[c] + l.specular[c]);
            self.phong.ambient_light()[c] + of_lamps.sum::<f64>()
        };
        (0..3).map(most).fold(0.0, f64::max)
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
