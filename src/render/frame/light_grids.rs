//! Grids of optical depths that stand in the lights of a medium's picture.

use std::cell::{Cell, RefCell};

use glam::{DAffine3, DVec3};

use crate::error::Result;
use crate::extent::ImageSize;
use crate::gpu::{Buffer, Device};
use crate::render::abi::{EmissionCast, LightGrid};
use crate::render::passes::{CastInputs, GridLayers, LightDepths, Run, light_depths};
use crate::render::resources::{DeviceTransfer, RaySource};
use crate::scene::{Camera, GridSide, Lens, LightFrom, Scene};
use crate::volume::Volume;

/// The share by which a grid is wider than what it holds.
const ROOM: f64 = 1.001;

/// The grids of all lights of a picture on the device, and whether they are filled.
pub struct LightGrids {
    grids: Buffer<LightGrid>,
    depths: RefCell<Buffer<f32>>,
    stands: Vec<Stand>,
    are_filled: Cell<bool>,
}

/// How a grid stands in a light: a camera in the light's place sees its points, one behind the other.
struct Stand {
    camera: Camera,
    layers: GridLayers,
}

impl LightGrids {
    /// Room for a grid in each light but those at the eye, and those that stand in the volume: they have none.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(device: &Device, scene: &Scene, volume: &Volume, side: GridSide) -> Result<Self> {
        let mut stands = Vec::new();
        let mut grids = Vec::new();
        for light in &scene.lights {
            let first = stands.len() as u32 * side.get().pow(3);
            let stand = stand(light.shines_from(&scene.camera), volume, side, first)?;
            grids.push(
                stand
                    .as_ref()
                    .map_or(bytemuck::Zeroable::zeroed(), |stand| {
                        light_grid(stand, volume.geometry().world_from_index())
                    }),
            );
            stands.extend(stand);
        }
        let count = (stands.len() * (side.get() as usize).pow(3)).max(1);
        Ok(Self {
            grids: Buffer::upload(device, "grids of lights", &grids)?,
            depths: RefCell::new(Buffer::new(device, "optical depths of lights", count)?),
            stands,
            are_filled: Cell::new(false),
        })
    }

    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.grids.bytes() + self.depths.borrow().bytes()
    }

    /// Fills the grids, unless they are.
    ///
    /// # Errors
    /// As [`Run::screen`].
    pub fn fill(
        &self,
        run: &mut Run,
        inputs: CastInputs,
        transfer: &DeviceTransfer,
        cast: &EmissionCast,
        volume: &Volume,
    ) -> Result<()> {
        if self.are_filled.get() {
            return Ok(());
        }
        let mut depths = self.depths.borrow_mut();
        for Stand { camera, layers } in &self.stands {
            let size = ImageSize::new(layers.side, layers.side)?;
            let of_light = RaySource::of_camera(camera, size, volume);
            let of_picture = std::mem::replace(&mut run.rays, of_light);
            let filled = light_depths(run, inputs, transfer, cast, *layers, &mut depths);
            run.rays = of_picture;
            filled?;
        }
        self.are_filled.set(!run.announcing);
        Ok(())
    }

    /// What a pass reads of them.
    pub fn read<T>(&self, pass: impl FnOnce(LightDepths) -> T) -> T {
        pass(LightDepths {
            grids: &self.grids,
            depths: &self.depths.borrow(),
        })
    }
}

/// How a grid of points stands in a light, around the whole volume; `None`: in none.
fn stand(light: LightFrom, volume: &Volume, side: GridSide, first: u32) -> Result<Option<Stand>> {
    let (center, radius_mm) = volume.bounding_sphere();
    let radius_mm = ROOM * radius_mm;
    let nodes = f64::from(side.get());
    // The outermost points, pixels' centres, lie half a pixel from the picture's edge.
    let edge = nodes / (nodes - 1.0);
    let (eye, lens) = match light {
        LightFrom::Eye => return Ok(None),
        LightFrom::Direction(toward) => {
            let height_mm = 2.0 * radius_mm * edge;
            (
                center + 2.0 * radius_mm * toward,
                Lens::Orthographic { height_mm },
            )
        }
        LightFrom::Point(at_world) => {
            let distance_mm = at_world.distance(center);
            if distance_mm < 1.1 * radius_mm {
                return Ok(None);
            }
            let tangent = radius_mm / (distance_mm.powi(2) - radius_mm.powi(2)).sqrt();
            let fov_deg = 2.0 * (tangent * edge).atan().to_degrees();
            (at_world, Lens::Perspective { fov_deg })
        }
    };
    let up = (center - eye).normalize().any_orthonormal_vector();
    let camera = Camera::look_at(eye, center, up, lens)?;
    let spacing_mm = 2.0 * radius_mm / (nodes - 1.0);
    let layers = GridLayers {
        nearest_mm: (eye.distance(center) - radius_mm) as f32,
        spacing_mm: spacing_mm as f32,
        side: side.get(),
        first,
    };
    Ok(Some(Stand { camera, layers }))
}

/// The maps from index space to a grid's points.
fn light_grid(stand: &Stand, world_from_index: DAffine3) -> LightGrid {
    let Stand { camera, layers } = stand;
    let eye = camera.eye_world();
    // A linear function of the place in the camera's space, in index space.
    let along = |axis: DVec3, constant: f64| {
        let linear = world_from_index.matrix3.transpose() * axis;
        let at_origin = axis.dot(world_from_index.translation - eye) + constant;
        [linear.x, linear.y, linear.z, at_origin].map(|number| number as f32)
    };
    let side = f64::from(layers.side);
    let middle = (side - 1.0) / 2.0;
    let forward = camera.forward();
    let (x, y, over) = match camera.lens() {
        Lens::Orthographic { height_mm } => {
            let pixels = side / height_mm;
            let over = [0.0, 0.0, 0.0, 1.0];
            (
                along(camera.right() * pixels, middle),
                along(camera.up() * -pixels, middle),
                over,
            )
        }
        Lens::Perspective { fov_deg } => {
            let pixels = side / (2.0 * (fov_deg.to_radians() / 2.0).tan());
            (
                along(camera.right() * pixels + forward * middle, 0.0),
                along(camera.up() * -pixels + forward * middle, 0.0),
                along(forward, 0.0),
            )
        }
    };
    let spacing_mm = f64::from(layers.spacing_mm);
    let nearest = -f64::from(layers.nearest_mm) / spacing_mm;
    LightGrid {
        x,
        y,
        over,
        depth: along(forward / spacing_mm, nearest),
        side: layers.side,
        first: layers.first,
        spacing_mm: layers.spacing_mm,
        pad: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::Dims;
    use crate::volume::{Geometry, NonFinite, Rescale, Voxels};

    fn oblique_volume() -> Volume {
        let direction = glam::DMat3::from_cols(
            DVec3::new(0.6, 0.8, 0.0),
            DVec3::new(-0.8, 0.6, 0.0),
            DVec3::NEG_Z,
        );
        let origin = DVec3::new(10.0, -20.0, 5.0);
        let geometry = Geometry::new(origin, direction, DVec3::new(0.5, 1.0, 3.0)).unwrap();
        Volume::new(
            Dims::new([10, 12, 8]).unwrap(),
            Voxels::from(vec![0u8; 10 * 12 * 8]),
            geometry,
            Rescale::IDENTITY,
            NonFinite::Refuse,
        )
        .unwrap()
    }

    #[test]
    fn a_grids_points_are_found_where_they_stand() {
        let volume = oblique_volume();
        let (center, radius_mm) = volume.bounding_sphere();
        let side: GridSide = "17".parse().unwrap();
        let toward = DVec3::new(1.0, 2.0, -0.5).normalize();
        let index_from_world = volume.geometry().index_from_world();
        for light in [
            LightFrom::Direction(toward),
            LightFrom::Point(center + 3.0 * radius_mm * toward),
        ] {
            let stand = stand(light, &volume, side, 5).unwrap().unwrap();
            let grid = light_grid(&stand, volume.geometry().world_from_index());
            assert_eq!([grid.side, grid.first], [17, 5]);
            let size = ImageSize::new(17, 17).unwrap();
            for (i, j, k) in [(0, 0, 0), (16, 0, 3), (4, 16, 16), (8, 8, 8)]
                .map(|(i, j, k)| (f64::from(i), f64::from(j), f64::from(k)))
            {
                let ray = stand.camera.ray(size, i + 0.5, j + 0.5);
                let axial_mm =
                    f64::from(stand.layers.nearest_mm) + k * f64::from(stand.layers.spacing_mm);
                let along_mm = axial_mm / ray.dir_world.dot(stand.camera.forward());
                let at_world = ray.origin_world + along_mm * ray.dir_world;
                let at = index_from_world.transform_point3(at_world).as_vec3();
                let map = |m: [f32; 4]| m[0] * at.x + m[1] * at.y + m[2] * at.z + m[3];
                let over = map(grid.over);
                let found = [map(grid.x) / over, map(grid.y) / over, map(grid.depth)];
                for (found, place) in found.into_iter().zip([i, j, k]) {
                    assert!(
                        (f64::from(found) - place).abs() < 1e-3,
                        "{light:?}: {found} {place}"
                    );
                }
            }
            // The volume lies within.
            for corner in [[0.0, 0.0, 0.0], [9.0, 11.0, 7.0], [9.0, 0.0, 7.0]] {
                let at = DVec3::from_array(corner).as_vec3();
                let map = |m: [f32; 4]| m[0] * at.x + m[1] * at.y + m[2] * at.z + m[3];
                let over = map(grid.over);
                for place in [map(grid.x) / over, map(grid.y) / over, map(grid.depth)] {
                    assert!((0.0..=16.0).contains(&place), "{light:?}: {place}");
                }
            }
        }
        // Lights at the eye and in the volume have none.
        for light in [LightFrom::Eye, LightFrom::Point(center)] {
            assert!(stand(light, &volume, side, 0).unwrap().is_none());
        }
    }
}
