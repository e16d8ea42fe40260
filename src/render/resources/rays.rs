//! The rays of a launch: where they come from, and the one place where their set-up narrows from double to
//! single precision.

use std::ops::Range;
use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::gpu::{Args, Buffer, Device, Element, Group};
use crate::memory;
use crate::render::abi::{Lanes, RayGrid, Rays};
use crate::scene::{Camera, Lens, LensPoint};
use crate::volume::Volume;

/// A ray of its own, in index space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IndexRay {
    /// The ray's origin.
    pub origin: [f32; 3],
    /// The ray's direction, of any length: t counts its lengths.
    pub dir: [f32; 3],
    /// The part of it that is cast: from `t_min`, not negative, to `t_max`, which may be +∞.
    pub t: [f32; 2],
}

impl IndexRay {
    /// The ray from its origin on.
    pub fn forward(origin: [f32; 3], dir: [f32; 3]) -> Self {
        let t = [0.0, f32::INFINITY];
        Self { origin, dir, t }
    }
}

/// Where the rays of a launch come from: which arguments kernels read them from, and how many there are.
pub enum RaySource {
    /// A ray through the centre of every pixel of a camera's picture.
    Camera {
        /// The rays, linear over the picture.
        grid: RayGrid,
        /// The picture's size.
        size: ImageSize,
    },
    /// A ray through the centre of each of some pixels.
    Pixels {
        /// The rays of all pixels, linear over the picture.
        grid: RayGrid,
        /// The picture's size.
        size: ImageSize,
        /// Pixels, counted row by row, each with where its rays may meet something first, 0 where that is not known
        /// (`kernels/lib/ray/pixels.clh`).
        listed: Arc<Buffer<[u32; 2]>>,
        /// The part of the list that has rays.
        part: Range<usize>,
    },
    /// Several rays in each of some pixels; planes have an entry for each ray.
    Samples {
        /// The rays of all pixels, linear over the picture.
        grid: RayGrid,
        /// The picture's size.
        size: ImageSize,
        /// Pixels, counted row by row, each with where its rays may meet something first, 0 where that is not known
        /// (`kernels/lib/ray/pixels.clh`).
        listed: Arc<Buffer<[u32; 2]>>,
        /// The part of the list that has rays.
        part: Range<usize>,
        /// Rays along each side of a pixel.
        per_side: u32,
    },
    /// Rays that are given one by one, [`IndexRay`]s; they need not run together.
    Buffers {
        /// Origins, and in w where the part that is cast begins.
        origins: Buffer<[f32; 4]>,
        /// Directions, and in w where it ends.
        dirs: Buffer<[f32; 4]>,
    },
}

/// Rays in a row of a launch whose rays stand in no picture.
const ROW: usize = 4096;

impl RaySource {
    /// The rays that a camera sends through a picture of this size.
    pub fn of_camera(camera: &Camera, size: ImageSize, volume: &Volume) -> Self {
        Self::Camera {
            grid: ray_grid(camera, size, volume, Through::CENTERS),
            size,
        }
    }

    /// The rays that a camera sends through a point of its lens, or through its pinhole, and through this place in each
    /// pixel, in pixels from its upper left corner.
    pub fn through_lens(
        camera: &Camera,
        size: ImageSize,
        volume: &Volume,
        lens: Option<LensPoint>,
        place_px: [f64; 2],
    ) -> Self {
        Self::Camera {
            grid: ray_grid(camera, size, volume, Through { lens, place_px }),
            size,
        }
    }

    /// The rays of a camera that go through these pixels, counted row by row. Work-items follow
    /// neighbours together, in whatever order they are listed.
    ///
    /// # Errors
    /// A pixel outside the picture; the device has no room.
    pub fn of_pixels(
        device: &Device,
        camera: &Camera,
        size: ImageSize,
        volume: &Volume,
        pixels: &[u32],
    ) -> Result<Self> {
        if let Some(pixel) = pixels
            .iter()
            .find(|&&pixel| pixel as usize >= size.pixels())
        {
            return Err(Error::usage(format!(
                "pixel {pixel}: a picture of {size} has {}",
                size.pixels()
            )));
        }
        let width = size.width();
        let mut listed = pixels.to_vec();
        // Tile by tile of 4 × 4, which holds those of 8 lanes too.
        listed.sort_unstable_by_key(|pixel| {
            let (i, j) = (pixel % width, pixel / width);
            (j / 4, i / 4, j, i)
        });
        let listed: Vec<[u32; 2]> = listed.into_iter().map(|pixel| [pixel, 0]).collect();
        Ok(Self::Pixels {
            grid: ray_grid(camera, size, volume, Through::CENTERS),
            size,
            part: 0..listed.len(),
            listed: Arc::new(Buffer::upload(device, "list of pixels", &listed)?),
        })
    }

    /// Rays given one by one.
    ///
    /// # Errors
    /// The device has no room.
    pub fn of_rays(device: &Device, rays: &[IndexRay]) -> Result<Self> {
        let upload = |four: fn(&IndexRay) -> [f32; 4]| {
            let fours: Vec<[f32; 4]> = rays.iter().map(four).collect();
            Buffer::upload(device, "rays", &fours)
        };
        Ok(Self::Buffers {
            origins: upload(|ray| with_w(ray.origin, ray.t[0]))?,
            dirs: upload(|ray| with_w(ray.dir, ray.t[1]))?,
        })
    }

    /// The kind of source that kernels are built for.
    pub fn kind(&self) -> Rays {
        match self {
            Self::Camera { .. } => Rays::Camera,
            Self::Pixels { .. } => Rays::Pixels,
            Self::Samples { .. } => Rays::Samples,
            Self::Buffers { .. } => Rays::Buffers,
        }
    }

    /// The entries of every plane that these rays write to.
    pub fn places(&self) -> usize {
        match self {
            Self::Camera { size, .. } | Self::Pixels { size, .. } => size.pixels(),
            Self::Samples { part, per_side, .. } => part.len() * (per_side * per_side) as usize,
            Self::Buffers { origins, .. } => origins.count(),
        }
    }

    /// How many rays there are.
    pub fn count(&self) -> usize {
        match self {
            Self::Pixels { part, .. } => part.len(),
            _ => self.places(),
        }
    }

    /// Room for one plane; `what` names it in errors. Where no ray writes it, it is `empty`.
    ///
    /// # Errors
    /// The device has no room.
    pub fn plane<T: Element>(&self, device: &Device, what: &str, empty: T) -> Result<Buffer<T>> {
        if matches!(self, Self::Pixels { .. }) {
            let filled = memory::filled(self.places(), empty, "a plane of the picture")?;
            return Buffer::upload(device, what, &filled);
        }
        Buffer::new(device, what, self.places())
    }

    /// The rays along x and y of a launch, and those of them that a work-item follows, `lanes` in all.
    ///
    /// # Errors
    /// No rays, or more than a launch can have.
    pub fn launch_size(&self, lanes: Lanes) -> Result<(ImageSize, [usize; 2])> {
        if let Self::Camera { size, .. } = self {
            return Ok((*size, lanes.tile()));
        }
        let count = self.count();
        let rows = ImageSize::new(ROW.min(count) as u32, count.div_ceil(ROW) as u32)?;
        Ok((rows, [lanes.get() as usize, 1]))
    }

    /// The rays of all pixels of the picture, and its size; `None`: the rays belong to no picture.
    pub fn picture(&self) -> Option<(&RayGrid, ImageSize)> {
        match self {
            Self::Camera { grid, size } | Self::Pixels { grid, size, .. } => Some((grid, *size)),
            Self::Samples { .. } | Self::Buffers { .. } => None,
        }
    }
}

impl Group for &RaySource {
    fn add_to(self, args: Args) -> Args {
        match self {
            RaySource::Camera { grid, .. } => args.value("rays", grid),
            RaySource::Pixels {
                grid, listed, part, ..
            } => args
                .value("rays", grid)
                .read("listed", listed)
                .value("first_listed", &(part.start as u32))
                .value("listed_count", &(part.len() as u32)),
            RaySource::Samples {
                grid,
                listed,
                part,
                per_side,
                ..
            } => args
                .value("rays", grid)
                .read("listed", listed)
                .value("first_listed", &(part.start as u32))
                .value("sample_count", &(self.places() as u32))
                .value("per_side", per_side),
            RaySource::Buffers { origins, dirs } => args
                .read("origins", origins)
                .read("dirs", dirs)
                .value("ray_count", &(origins.count() as u32)),
        }
    }
}

fn with_w([x, y, z]: [f32; 3], w: f32) -> [f32; 4] {
    [x, y, z, w]
}

fn float4(v: DVec3) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}

/// A quantity that is linear over the image: its value at pixel (0,0)'s centre and its change per
/// column and per row.
struct Linear {
    at_first: DVec3,
    per_column: DVec3,
    per_row: DVec3,
}

impl Linear {
    fn map(&self, m: DMat3) -> Self {
        Self {
            at_first: m * self.at_first,
            per_column: m * self.per_column,
            per_row: m * self.per_row,
        }
    }

    fn float4s(&self) -> [[f32; 4]; 3] {
        [self.at_first, self.per_column, self.per_row].map(float4)
    }

    /// The low parts that [`Self::float4s`] leaves out.
    fn low_float4s(&self) -> [[f32; 4]; 3] {
        [self.at_first, self.per_column, self.per_row].map(|v| {
            let high = v.to_array().map(|c| f64::from(c as f32));
            float4(v - DVec3::from_array(high))
        })
    }
}

/// What the rays of a camera go through.
#[derive(Clone, Copy)]
struct Through {
    /// A point of the lens; `None`: the pinhole.
    lens: Option<LensPoint>,
    /// A place in each pixel, from its upper left corner.
    place_px: [f64; 2],
}

impl Through {
    /// The pinhole, and the pixels' centres.
    const CENTERS: Self = Self {
        lens: None,
        place_px: [0.5; 2],
    };
}

/// The rays of every pixel. They start on a plane that faces the eye, just short of the volume's
/// bounding sphere (at the eye when that lies inside it), so that index coordinates stay small
/// however far the eye is.
fn ray_grid(camera: &Camera, size: ImageSize, volume: &Volume, through: Through) -> RayGrid {
    let (center_world, radius_mm) = volume.bounding_sphere();
    // A little before the sphere: a ray through a corner that touches it must still enter by a face.
    let base_mm =
        ((center_world - camera.eye_world()).dot(camera.forward()) - 1.001 * radius_mm).max(0.0);
    let index_from_world: DAffine3 = volume.geometry().index_from_world();

    let pixel_px = 2.0 / f64::from(size.height());
    let [x, y] = through.place_px;
    let first_u = (2.0 * x - f64::from(size.width())) / f64::from(size.height());
    let first_v = (f64::from(size.height()) - 2.0 * y) / f64::from(size.height());
    let across = |half_height: f64| Linear {
        at_first: (camera.right() * first_u + camera.up() * first_v) * half_height,
        per_column: camera.right() * (pixel_px * half_height),
        per_row: camera.up() * (-pixel_px * half_height),
    };
    let base_world = camera.eye_world() + camera.forward() * base_mm;
    let (mut origin, mut dir) = match camera.lens() {
        Lens::Perspective { fov_deg } => {
            let tangent = (fov_deg.to_radians() / 2.0).tan();
            (across(tangent * base_mm), across(tangent))
        }
        Lens::Orthographic { height_mm } => (across(height_mm / 2.0), across(0.0)),
    };
    dir.at_first += camera.forward();
    if let Some(point) = through.lens {
        let [aside, slope] = camera.lens_shift(point);
        origin.at_first += aside + slope * base_mm;
        dir.at_first += slope;
    }

    let across_index = dir.map(index_from_world.matrix3);
    let (dir_index, dir_index_low) = (across_index.float4s(), across_index.low_float4s());
    let dir_world = dir.float4s();
    let mut origin_index = origin.map(index_from_world.matrix3);
    origin_index.at_first += index_from_world.transform_point3(base_world);
    let (origin, origin_low) = (origin_index.float4s(), origin_index.low_float4s());
    RayGrid {
        origin: origin[0],
        origin_dx: origin[1],
        origin_dy: origin[2],
        origin_low: origin_low[0],
        origin_dx_low: origin_low[1],
        origin_dy_low: origin_low[2],
        dir_index: dir_index[0],
        dir_index_dx: dir_index[1],
        dir_index_dy: dir_index[2],
        dir_index_low: dir_index_low[0],
        dir_index_dx_low: dir_index_low[1],
        dir_index_dy_low: dir_index_low[2],
        dir_world: dir_world[0],
        dir_world_dx: dir_world[1],
        dir_world_dy: dir_world[2],
        base_mm: base_mm as f32,
        width: size.width(),
        height: size.height(),
        pad: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::Dims;
    use crate::volume::{Geometry, NonFinite, Rescale, Voxels};

    fn oblique_volume() -> Volume {
        let direction = DMat3::from_cols(
            DVec3::new(0.6, 0.8, 0.0),
            DVec3::new(-0.8, 0.6, 0.0),
            DVec3::NEG_Z,
        );
        let geometry = Geometry::new(
            DVec3::new(10.0, -20.0, 5.0),
            direction,
            DVec3::new(0.5, 1.0, 3.0),
        )
        .unwrap();
        let voxels = Voxels::from(vec![0u8; 10 * 12 * 8]);
        Volume::new(
            Dims::new([10, 12, 8]).unwrap(),
            voxels,
            geometry,
            Rescale::IDENTITY,
            NonFinite::Refuse,
        )
        .unwrap()
    }

    /// Largest distance, in voxels, of the device's rays from the camera's own in double
    /// precision, at the volume's centre depth.
    fn ray_error_voxels(camera: &Camera, size: ImageSize, volume: &Volume, shift_px: f64) -> f64 {
        let grid = ray_grid(camera, size, volume, Through::CENTERS);
        let index_from_world = volume.geometry().index_from_world();
        let xyz = |v: [f32; 4]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
        let (center, _) = volume.bounding_sphere();
        let mut worst: f64 = 0.0;
        for (i, j) in [(0, 0), (63, 0), (0, 31), (63, 31), (31, 17)] {
            let (x, y) = (f64::from(i), f64::from(j));
            let along = |v: [f32; 4], dx, dy| xyz(v) + xyz(dx) * x + xyz(dy) * y;
            let origin = along(grid.origin, grid.origin_dx, grid.origin_dy)
                + along(grid.origin_low, grid.origin_dx_low, grid.origin_dy_low);
            let dir_world = along(grid.dir_world, grid.dir_world_dx, grid.dir_world_dy);
            let dir_index = along(grid.dir_index, grid.dir_index_dx, grid.dir_index_dy)
                + along(
                    grid.dir_index_low,
                    grid.dir_index_dx_low,
                    grid.dir_index_dy_low,
                );
            let dir = dir_index / dir_world.length();
            let ray = camera.ray(size, x + 0.5 + shift_px, y + 0.5);
            let t_mm = (center - ray.origin_world).dot(ray.dir_world);
            let exact = index_from_world.transform_point3(ray.origin_world + ray.dir_world * t_mm);
            // From the base plane in single precision's own terms: t − base cancels, so take the
            // nearest point of the device's ray instead of the point at t.
            let near = origin + dir * (exact - origin).dot(dir) / dir.length_squared();
            worst = worst.max(near.distance(exact));
            // The ray starts where base_mm says, as exactly as that number holds a far distance.
            let base_mm = f64::from(grid.base_mm) * dir_world.length();
            let starts_at = |t_mm: f64| {
                let p_world = ray.origin_world + ray.dir_world * t_mm;
                let p_index = index_from_world.transform_point3(p_world);
                p_index.distance(origin) < 1e-4 + 1e-6 * base_mm
            };
            assert!(shift_px != 0.0 || starts_at(base_mm));
            assert!(!starts_at(base_mm * 1.001 + 0.001));
        }
        worst
    }

    #[test]
    fn device_rays_are_the_cameras_rays() {
        let size = ImageSize::new(64, 32).unwrap();
        let volume = oblique_volume();
        let (center, radius_mm) = volume.bounding_sphere();
        let near = center + DVec3::new(3.0, -4.0, 2.0).normalize() * (3.0 * radius_mm);
        let far = center + DVec3::new(3.0, -4.0, 2.0).normalize() * (1e5 * radius_mm);
        for (eye, lens) in [
            (near, Lens::Perspective { fov_deg: 40.0 }),
            (center, Lens::Perspective { fov_deg: 100.0 }),
            (far, Lens::Perspective { fov_deg: 0.001 }),
            (near, Lens::Orthographic { height_mm: 30.0 }),
            (far, Lens::Orthographic { height_mm: 30.0 }),
        ] {
            let target = if eye == center {
                center + DVec3::X
            } else {
                center
            };
            let camera = Camera::look_at(eye, target, DVec3::Z, lens).unwrap();
            let error = ray_error_voxels(&camera, size, &volume, 0.0);
            assert!(error < 1e-9, "{lens:?}: {error}");
            // The check sees a millionth of a pixel.
            if eye != center {
                assert!(
                    ray_error_voxels(&camera, size, &volume, 1e-6) > 1e-9,
                    "{lens:?}"
                );
            }
        }
    }
}
