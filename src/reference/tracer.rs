//! One ray through one scene: what it sees, in double precision.

use glam::{DMat3, DVec3};

use crate::error::{Error, Result};
use crate::extent::Range;
use crate::frame::{Kind, Layer, Wanted};
use crate::scene::{
    Emission, Light, LightFrom, Picture, Projection, Ray, Scene, Shadows, Window, linear_from_srgb,
};
use crate::volume::{Rescale, Volume, Voxel};
use crate::with_voxels;

use super::clip::IndexPlane;
use super::emission::{self, Normals, Path, Shading};
use super::field::Field;
use super::interval::{Entry, IndexRay, Interval};
use super::leaving::Surroundings;
use super::medium::Medium;
use super::occlusion::{open_share, visible_share};
use super::projection::project;
use super::shade::{Lighting, LitPoint, normal_from_gradient};
use super::surface::{Crossing, first_crossing, next_change};

/// Differences of Φ up to this share of its largest magnitude are taken for rounding errors where
/// rising and falling are distinguished.
const NOISE_SHARE: f64 = 1e-13;

/// A point of the surface, as the ray that met it sees it.
struct SurfacePoint {
    index: [f64; 3],
    /// The unit normal by the field in the hit's own cell, toward the side from which it is seen; world space.
    normal_world: DVec3,
    /// Whether it is seen from where Φ ≥ iso.
    seen_from_inside: bool,
}

/// A hit, and what is before it.
struct Before {
    /// `None` of a cap.
    point: Option<SurfacePoint>,
    /// The normal by which it is shaded.
    facing: DVec3,
    at_world: DVec3,
    to_viewer: DVec3,
    /// The iso value, without the calibration's intercept.
    iso: f64,
}

impl Before {
    /// The normal by which it is shaded, toward the viewer.
    fn facing_viewer(&self) -> DVec3 {
        if self.facing.dot(self.to_viewer) < 0.0 {
            -self.facing
        } else {
            self.facing
        }
    }
}

/// The result of casting one ray; all 0 and the depth +∞ if it meets nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayResult {
    /// The colour: linear light, premultiplied, without background.
    pub color: [f64; 4],
    /// Distance from the ray's origin, mm; +∞ if it meets nothing. For a medium the mean, if it was
    /// requested.
    pub depth_mm: f64,
    /// The unit normal, world space, toward lower values; 0 if there is none. For a medium the mean's
    /// direction, if it was requested.
    pub normal_world: DVec3,
    /// Φ at the hit, the projected value, or for a medium the mean, if it was requested; physical.
    pub value: f64,
    /// The number of boxes walked.
    pub cells: u32,
    /// The kind of thing that the ray meets.
    pub kind: Kind,
    /// The share of the light from everywhere that the surface keeps from the hit; 0 where none is asked for.
    pub occlusion: f64,
    /// The share of the first light that reaches the hit, or of a medium the mean, if it was requested; 0 where no shadows
    /// are asked for.
    pub visibility: f64,
    /// How far the ray goes on behind a surface's hit to its next crossing, or to the end of what is seen of it, mm; 0 if it
    /// was not requested.
    pub thick_mm: f64,
}

impl RayResult {
    const NOTHING: Self = Self {
        color: [0.0; 4],
        depth_mm: f64::INFINITY,
        normal_world: DVec3::ZERO,
        value: 0.0,
        cells: 0,
        kind: Kind::Nothing,
        occlusion: 0.0,
        visibility: 0.0,
        thick_mm: 0.0,
    };
}

/// A volume and a scene, prepared for casting rays. Φ is followed without the calibration's intercept,
/// so that values far from zero keep their digits. Of the scene it uses the picture, the clip
/// planes, the lights with the camera that some are fixed to, the gradient and the filter; step, refinement, traversal and early termination are the device's alone.
pub struct Tracer<'a> {
    volume: &'a Volume,
    scene: &'a Scene,
    origin_world: DVec3,
    index_from_world: DMat3,
    clip_planes: Vec<IndexPlane>,
    noise: f64,
    medium: Option<Medium>,
    lighting: Option<Lighting>,
    wanted: Wanted,
}

impl<'a> Tracer<'a> {
    /// Prepares a volume and a scene for casting rays.
    ///
    /// # Errors
    /// The volume's spacing is too small for double precision; usage: more than [`Light::MAX_COUNT`] lights.
    pub fn new(volume: &'a Volume, scene: &'a Scene) -> Result<Self> {
        Light::check_count(&scene.lights)?;
        let (range, slope) = (volume.stored_range(), volume.rescale().slope);
        let magnitude = slope * range.min.abs().max(range.max.abs());
        let index_from_world = volume.geometry().index_from_world().matrix3;
        if !index_from_world.is_finite() {
            return Err(Error::input(format!(
                "the spacing {} mm is too small to compute with",
                volume.geometry().spacing_mm()
            )));
        }
        Ok(Self {
            volume,
            scene,
            origin_world: volume.geometry().origin_mm(),
            index_from_world,
            clip_planes: (scene.clip_planes.iter())
                .map(|&plane| IndexPlane::new(plane, volume.geometry().world_from_index()))
                .collect(),
            noise: magnitude * NOISE_SHARE,
            medium: match &scene.picture {
                Picture::Emission(emission) => {
                    let rescale = volume.rescale();
                    let moved = |value| rescale.without_intercept(value);
                    Some(Medium::new(&emission.transfer.moved(moved)))
                }
                _ => None,
            },
            lighting: lighting(scene),
            wanted: Wanted::NONE,
        })
    }

    /// Adds what these planes need beyond the picture: means of a medium, which are integrals of their own, and how thick a
    /// surface is.
    #[must_use]
    pub fn wanting(self, wanted: Wanted) -> Self {
        Self { wanted, ..self }
    }

    /// Casts one ray. Its direction is a unit vector in world space.
    pub fn cast(&self, ray: Ray) -> RayResult {
        // Relative to the volume's origin, so that a far one costs no digits.
        let origin_index = self.index_from_world * (ray.origin_world - self.origin_world);
        let index_ray = IndexRay {
            origin: origin_index.to_array(),
            dir: (self.index_from_world * ray.dir_world).to_array(),
        };
        let dims = self.volume.dims();
        let inside = Interval::new(&index_ray, dims);
        let visible = inside.and_then(|inside| inside.clipped(&self.clip_planes, dims));
        let Some(interval) = visible else {
            return RayResult::NOTHING;
        };
        with_voxels!(self.volume.voxels(), voxels => {
            let field = Field::new(
                voxels,
                dims,
                self.volume.rescale().slope,
                self.scene.sampling.filter,
            );
            self.see(&field, &interval, ray)
        })
    }

    fn see<T: Voxel>(&self, field: &Field<T>, interval: &Interval, ray: Ray) -> RayResult {
        match &self.scene.picture {
            Picture::Surface { iso, caps, .. } => {
                let iso = self.volume.rescale().without_intercept(*iso);
                let (crossing, cells) =
                    first_crossing(field, interval, iso, *caps, self.scene.gradient);
                let seen = crossing.map_or(RayResult::NOTHING, |crossing| {
                    self.surface(field, &crossing, interval, ray)
                });
                RayResult { cells, ..seen }
            }
            Picture::Projection { of, window } => self.projection(field, interval, *of, *window),
            Picture::Emission(_) => self.emission(field, interval, ray),
        }
    }

    fn surface<T: Voxel>(
        &self,
        field: &Field<T>,
        crossing: &Crossing,
        interval: &Interval,
        ray: Ray,
    ) -> RayResult {
        let to_viewer = -ray.dir_world;
        let normal_world = match crossing.cap {
            Some(entry) => self.outward_normal(entry),
            None => {
                let gradient = DVec3::from_array(crossing.gradient);
                normal_from_gradient(self.gradient_world_from_index() * gradient, to_viewer)
            }
        };
        let Picture::Surface { iso, color, .. } = &self.scene.picture else {
            return RayResult::NOTHING;
        };
        let iso = self.volume.rescale().without_intercept(*iso);
        let depth_mm = interval.enter_mm + crossing.at_mm;
        let at_world = ray.origin_world + ray.dir_world * depth_mm;
        let before = Before {
            point: self.surface_point(field, crossing, interval, ray.dir_world),
            facing: normal_world,
            at_world,
            to_viewer,
            iso,
        };
        let occlusion = (self.scene.ambient_occlusion).map_or(0.0, |asked| {
            self.occlusion(field, &before, asked.distance().get())
        });
        let reached = |from: LightFrom| {
            self.scene.shadows.map_or(1.0, |shadows| {
                self.visibility(field, &before, from, shadows)
            })
        };
        let [r, g, b] = match &self.lighting {
            Some(lighting) => {
                let point = LitPoint {
                    at_world,
                    to_viewer,
                    normal: normal_world,
                };
                lighting.reflect(color.0, point, self.reached(occlusion), |lamp| {
                    reached(lamp.from)
                })
            }
            None => color.0,
        };
        RayResult {
            color: [r, g, b, 1.0],
            depth_mm,
            normal_world,
            value: crossing.value + self.volume.rescale().intercept,
            cells: 0,
            kind: crossing.kind(),
            occlusion,
            visibility: self.first_lamp().map_or(0.0, reached),
            thick_mm: match self.wanted.has(Layer::Thick) {
                true => self.thick_mm(field, crossing, interval, iso),
                false => 0.0,
            },
        }
    }

    /// The first light of a picture that has shadows, whose visibility is a layer.
    fn first_lamp(&self) -> Option<LightFrom> {
        let lighting = self
            .lighting
            .as_ref()
            .filter(|_| self.scene.shadows.is_some())?;
        lighting.lamps().first().map(|lamp| lamp.from)
    }

    /// How far a ray goes on behind a crossing to the next one, or to the end of its interval, mm.
    fn thick_mm<T: Voxel>(
        &self,
        field: &Field<T>,
        crossing: &Crossing,
        interval: &Interval,
        iso: f64,
    ) -> f64 {
        let start_mm = self.surroundings().start_mm;
        let from_mm = (crossing.at_mm + start_mm).min(interval.length_mm);
        let domain = self.volume.dims().domain();
        let behind = Interval {
            enter_mm: interval.enter_mm + from_mm,
            length_mm: interval.length_mm - from_mm,
            start: std::array::from_fn(|a| {
                let (low, high) = domain[a];
                (interval.start[a] + interval.dir[a] * from_mm).clamp(low, high)
            }),
            entry: None,
            ..*interval
        };
        let change = next_change(field, &behind, iso, crossing.inside);
        from_mm - crossing.at_mm + change.unwrap_or(behind.length_mm)
    }

    /// The share of the light from everywhere that reaches a point of which this share is occluded.
    fn reached(&self, occlusion: f64) -> f64 {
        let strength = (self.scene.ambient_occlusion).map_or(0.0, |asked| asked.strength().get());
        1.0 - strength * occlusion
    }

    /// The point of the surface that a ray meets; `None` for a cap: the space before it is empty, since the volume that clip
    /// planes leave is convex.
    fn surface_point<T: Voxel>(
        &self,
        field: &Field<T>,
        crossing: &Crossing,
        interval: &Interval,
        dir_world: DVec3,
    ) -> Option<SurfacePoint> {
        if crossing.cap.is_some() {
            return None;
        }
        let index: [f64; 3] =
            std::array::from_fn(|a| interval.start[a] + interval.dir[a] * crossing.at_mm);
        let gradient = DVec3::from_array(field.slope_in(crossing.cell, index));
        let down = normal_from_gradient(self.gradient_world_from_index() * gradient, -dir_world);
        let seen_from_inside = down.dot(dir_world) > 0.0;
        Some(SurfacePoint {
            index,
            normal_world: if seen_from_inside { -down } else { down },
            seen_from_inside,
        })
    }

    /// 1 − A of a point, A its accessibility within a distance.
    fn occlusion<T: Voxel>(&self, field: &Field<T>, before: &Before, distance_mm: f64) -> f64 {
        let Some(point) = &before.point else {
            return 0.0;
        };
        1.0 - open_share(point.normal_world, |dir_world| {
            self.is_open(field, point, before.iso, dir_world, distance_mm)
        })
    }

    /// V of a point of the surface, the share of a light that is seen from there.
    fn visibility<T: Voxel>(
        &self,
        field: &Field<T>,
        before: &Before,
        light: LightFrom,
        shadows: Shadows,
    ) -> f64 {
        if light == LightFrom::Eye {
            return 1.0;
        }
        let toward = light.toward(before.at_world, before.to_viewer);
        let distance_mm = light.distance_mm(before.at_world);
        let radius = 0.5 * shadows.light_size.get().to_radians();
        visible_share(toward, radius, |dir_world| match &before.point {
            // The space before a cap is empty.
            None => before.facing_viewer().dot(dir_world) > 0.0,
            Some(point) => {
                point.normal_world.dot(dir_world) > 0.0
                    && self.is_open(field, point, before.iso, dir_world, distance_mm)
            }
        })
    }

    /// Whether a ray from a point of the surface does not meet it again within a distance.
    fn is_open<T: Voxel>(
        &self,
        field: &Field<T>,
        point: &SurfacePoint,
        iso: f64,
        dir_world: DVec3,
        distance_mm: f64,
    ) -> bool {
        let around = self.surroundings();
        let interval = around.interval_from(point.index, dir_world, around.start_mm, distance_mm);
        interval.is_none_or(|interval| {
            next_change(field, &interval, iso, point.seen_from_inside).is_none()
        })
    }

    fn surroundings(&self) -> Surroundings<'_> {
        Surroundings::new(self.volume, self.index_from_world, &self.clip_planes)
    }

    fn projection<T: Voxel>(
        &self,
        field: &Field<T>,
        interval: &Interval,
        of: Projection,
        window: Window,
    ) -> RayResult {
        let rescale = self.volume.rescale();
        let of = match of {
            Projection::LocalMaximum { threshold } => Projection::LocalMaximum {
                threshold: rescale.without_intercept(threshold),
            },
            Projection::Maximum | Projection::Minimum | Projection::Mean => of,
        };
        let projected = project(field, interval, of, self.noise);
        let value = projected.value + rescale.intercept;
        let grey = linear_from_srgb(window.grey_srgb(value));
        RayResult {
            color: [grey, grey, grey, 1.0],
            depth_mm: interval.enter_mm + projected.at_mm,
            normal_world: DVec3::ZERO,
            value,
            cells: projected.walked,
            kind: Kind::Surface,
            ..RayResult::NOTHING
        }
    }

    fn emission<T: Voxel>(&self, field: &Field<T>, interval: &Interval, ray: Ray) -> RayResult {
        let (Some(medium), Picture::Emission(picture)) = (&self.medium, &self.scene.picture) else {
            return RayResult::NOTHING;
        };
        let Ray {
            origin_world,
            dir_world,
        } = ray;
        let path = Path {
            start_world: origin_world + dir_world * interval.enter_mm,
            dir_world,
        };
        let shading = self.lighting.as_ref().map(|lighting| Shading {
            lighting,
            path,
            shadows: self.scene.shadows.map(|_| self.surroundings()),
            shaded_from: picture.shaded_from.get(),
            gradient: self.scene.gradient,
            gradient_world_from_index: self.gradient_world_from_index(),
        });
        let emitted = emission::integrate(field, interval, medium, shading.as_ref());
        let [r, g, b] = emitted.color;
        let opacity = 1.0 - emitted.transmittance;
        let result = RayResult {
            color: [r, g, b, opacity],
            cells: emitted.walked,
            ..RayResult::NOTHING
        };
        if (opacity as f32) < Emission::LAYERS_FROM {
            return result;
        }
        self.with_means(result, field, interval, medium, path)
    }

    /// The result for a medium, with the means that are wanted.
    fn with_means<T: Voxel>(
        &self,
        seen: RayResult,
        field: &Field<T>,
        interval: &Interval,
        medium: &Medium,
        path: Path,
    ) -> RayResult {
        let Path { dir_world, .. } = path;
        let visibility = match self
            .first_lamp()
            .filter(|_| self.wanted.has(Layer::Visibility))
        {
            Some(light) => {
                let around = self.surroundings();
                emission::mean_visibility(field, interval, medium, path, &around, light)
            }
            None => 0.0,
        };
        let seen = RayResult { visibility, ..seen };
        let kind = Kind::Surface;
        let means = [Layer::Depth, Layer::Normal, Layer::Value];
        if !self.wanted.has_any(means) {
            return RayResult { kind, ..seen };
        }
        let normals = self.wanted.has(Layer::Normal).then(|| Normals {
            gradient: self.scene.gradient,
            gradient_world_from_index: self.gradient_world_from_index(),
            toward_eye: -dir_world,
        });
        let Rescale { slope, intercept } = self.volume.rescale();
        let Range { min, max } = self.volume.stored_range();
        let range = Range {
            min: slope * min,
            max: slope * max,
        };
        let means = emission::means(field, interval, medium, range, normals.as_ref());
        RayResult {
            depth_mm: interval.enter_mm + means.at_mm,
            normal_world: means.normal_world.try_normalize().unwrap_or(-dir_world),
            value: means.value + intercept,
            kind,
            ..seen
        }
    }

    /// The inverse transpose of world_from_index's linear part.
    fn gradient_world_from_index(&self) -> DMat3 {
        self.index_from_world.transpose()
    }

    fn outward_normal(&self, entry: Entry) -> DVec3 {
        let face = match entry {
            Entry::Face(face) => face,
            Entry::Plane(i) => return self.scene.clip_planes[i].outward_world(),
        };
        let mut outward = DVec3::ZERO;
        outward[face.axis] = if face.low { -1.0 } else { 1.0 };
        (self.gradient_world_from_index() * outward).normalize_or_zero()
    }
}

/// How a shaded picture is lit.
fn lighting(scene: &Scene) -> Option<Lighting> {
    let phong = match &scene.picture {
        Picture::Surface { phong, .. } => *phong,
        Picture::Emission(emission) => emission.phong,
        Picture::Projection { .. } => None,
    };
    phong.map(|phong| Lighting::new(phong, &scene.lights, &scene.camera))
}
