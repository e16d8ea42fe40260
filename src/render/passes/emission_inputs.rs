//! The inputs of both passes of an emission.

use crate::frame::Layer;
use crate::gpu::{Args, Buffer, Defines, Group};
use crate::render::abi::{EmissionCast, KernelEnum, LightGrid, Shading};
use crate::render::resources::{DeviceGradient, DeviceLayers, DeviceTransfer};

use crate::scene::ShadowMethod;

use super::inputs::CastInputs;
use super::run::Run;

/// The inputs of both passes of an emission.
pub struct EmissionInputs<'a> {
    /// The inputs of every cast.
    pub cast_inputs: CastInputs<'a>,
    /// The transfer function, with the tables of the quadrature.
    pub transfer: &'a DeviceTransfer,
    /// The value that stands for each leaf, where some are homogeneous.
    pub node_average: Option<&'a Buffer<f32>>,
    /// How normals are found, where they are made use of.
    pub gradient: DeviceGradient<'a>,
    /// The cast's numbers.
    pub cast: EmissionCast,
    /// The light; shaded or not.
    pub shading: Shading,
    /// Whether the light is used.
    pub shaded: bool,
    /// How what reaches points of lights is found; `None`: all reaches them.
    pub shadows: Option<ShadowMethod>,
    /// Optical depths from the lights on, where shadows are found by them.
    pub light_grids: Option<LightDepths<'a>>,
}

/// Optical depths at the points of a grid in each light.
#[derive(Clone, Copy)]
pub struct LightDepths<'a> {
    /// The grids, one a light.
    pub grids: &'a Buffer<LightGrid>,
    /// The depths of all of them.
    pub depths: &'a Buffer<f32>,
}

impl Group for LightDepths<'_> {
    fn add_to(self, args: Args) -> Args {
        args.read("light_grids", self.grids)
            .read("light_depths", self.depths)
    }
}

/// The layers of an emission, in the order of its passes' arguments. A pass is built for those that it
/// writes: without any it computes none.
const LAYERS: [Layer; 6] = [
    Layer::Depth,
    Layer::Value,
    Layer::Normal,
    Layer::Visibility,
    Layer::Steps,
    Layer::Nodes,
];

impl EmissionInputs<'_> {
    /// The switches of a pass that writes these layers.
    pub fn defines(&self, run: &Run, layers: &DeviceLayers) -> Defines {
        let has = |layer| u32::from(layers.has(layer));
        let defines = self.gradient.define(run.defines());
        defines
            .with("SHADED", u32::from(self.shaded))
            .with("LAYERS", has(Layer::Depth))
            .with("SHADOWS", self.shadows.number())
            .with("NORMALS", has(Layer::Normal))
            .with("VISIBILITY", has(Layer::Visibility))
            .with("COUNTERS", has(Layer::Steps))
    }

    /// The arguments of a pass that writes the colour (linear light, premultiplied) and these layers.
    pub fn args(&self, run: &Run, color: &mut Buffer<[f32; 4]>, layers: &mut DeviceLayers) -> Args {
        let args = self.cast_inputs.by_cells(run).with(self.transfer);
        let args = args.read_some("node_average", self.node_average);
        let args = args.with(self.cast_inputs.clip);
        let leaves = self.cast_inputs.occupancy.leaf_light.as_ref();
        let args = match self.light_grids {
            Some(grids) => args.with(grids).read_some("leaf_light", leaves),
            None => args,
        };
        let args = self.cast_inputs.seen_along_rays(args, run, self.gradient);
        self.cast_inputs
            .by_steps(args, &self.cast)
            .value("shading", &self.shading)
            .write("color", color)
            .with(layers.writing(&LAYERS))
    }
}
