//! One typed function per kernel of `kernels/pass`: `&` is read, `&mut` is written.

mod adaptive_emission;
mod cast_emission;
mod cast_maximum;
mod cast_surface;
mod emission_planes;
mod exact_projection;
mod exact_surface;
mod sample_field;
mod shade_surface;
mod surface_normal;
mod tone_curve;
mod window_value;

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use crate::error::Result;
use crate::extent::ImageSize;
use crate::gpu::{
    Buffer, Defines, Device, Element, Launch, Parameter, Pass, Timings, input, output,
};

use super::abi::VolumeGrid;
use super::clip::DeviceClip;
use super::gradient::DeviceGradient;
use super::lanes::Lanes;
use super::variant::Variant;
use super::voxels::{DeviceVoxels, parameter};

pub use adaptive_emission::adaptive_emission;
pub use cast_emission::{DeviceTransfer, cast_emission, integrates};
pub use cast_maximum::cast_maximum;
pub use cast_surface::cast_surface;
pub use emission_planes::EmissionPlanes;
pub use exact_projection::exact_projection;
pub use exact_surface::exact_surface;
pub use sample_field::sample_field;
pub use shade_surface::shade_surface;
pub use surface_normal::surface_normal;
pub use tone_curve::tone_curve;
pub use window_value::window_value;

/// The passes of a renderer: each variant is built once, when it is first launched.
#[derive(Default)]
pub struct Built {
    passes: HashMap<(&'static str, Defines), Arc<Pass>>,
}

impl Built {
    /// The pass `name` with these constants.
    pub(super) fn pass(
        &mut self,
        name: &'static str,
        defines: Defines,
        signature: impl FnOnce() -> Vec<Parameter>,
    ) -> Result<&Arc<Pass>> {
        Ok(match self.passes.entry((name, defines)) {
            Entry::Occupied(there) => there.into_mut(),
            Entry::Vacant(place) => {
                let defines = place.key().1.clone();
                let lanes = defines.get("LANES").map_or(Ok(Lanes::ONE), str::parse)?;
                let pass = Pass::new("pass", name, defines, signature());
                place.insert(Arc::new(pass.with_tile(lanes.tile())))
            }
        })
    }
}

/// What all passes of one frame share.
pub struct Run<'a> {
    pub device: &'a Device,
    pub built: &'a mut Built,
    pub timings: &'a mut Timings,
    pub size: ImageSize,
    /// Work-items along x and y of a group; `None`: small square tiles of pixels.
    pub work_group: Option<[usize; 2]>,
    pub variant: Variant,
    /// In the variant's storage.
    pub voxels: &'a DeviceVoxels,
}

impl Run<'_> {
    /// Room for one plane of the frame; `what` names it in errors.
    pub fn plane<T: Element>(&self, what: &str) -> Result<Buffer<T>> {
        Buffer::new(self.device, what, self.size.pixels())
    }

    pub fn counters(&self, wanted: bool) -> Result<Option<Counters>> {
        let room = || -> Result<Counters> {
            Ok(Counters {
                steps: self.plane("steps plane")?,
                nodes: self.plane("nodes plane")?,
            })
        };
        wanted.then(room).transpose()
    }
}

/// The volume on the device, but for its voxels.
pub struct DeviceVolume {
    pub grid: VolumeGrid,
    /// Per octree level its nodes along x, y, z and its first node's offset.
    pub levels: Buffer<[u32; 4]>,
    /// Per octree node the range of its values.
    pub node_range: Buffer<[f32; 2]>,
}

impl DeviceVolume {
    /// Device memory held, in bytes.
    pub fn bytes(&self) -> u64 {
        self.levels.bytes() + self.node_range.bytes()
    }
}

/// Per pixel: samples taken and octree nodes tested.
pub struct Counters {
    pub steps: Buffer<u32>,
    pub nodes: Buffer<u32>,
}

impl Counters {
    /// Their place at the end of a cast's signature.
    fn parameters(wanted: bool) -> impl Iterator<Item = Parameter> {
        ["steps", "nodes"]
            .into_iter()
            .filter(move |_| wanted)
            .map(output::<u32>)
    }

    /// Gives them, when they are wanted, as a cast's last arguments.
    fn give<'a>(counters: Option<&'a mut Self>, launch: Launch<'a>) -> Launch<'a> {
        match counters {
            Some(counters) => launch
                .output(&mut counters.steps)
                .output(&mut counters.nodes),
            None => launch,
        }
    }
}

fn voxels(variant: Variant) -> Parameter {
    parameter(variant.storage, variant.voxel)
}

fn levels() -> Parameter {
    input::<[u32; 4]>("levels")
}

/// A switch as the kernels' preprocessor reads it.
fn switch(on: bool) -> u32 {
    u32::from(on)
}
