//! The inputs of both passes of an emission.

use crate::frame::Layer;
use crate::gpu::{Args, Buffer, Defines};
use crate::render::abi::{EmissionCast, Shading};
use crate::render::resources::{DeviceGradient, DeviceLayers, DeviceTransfer};

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
}

/// The layers of an emission, in the order of its passes' arguments. A pass is built for those that it
/// writes: without any it computes none.
const LAYERS: [Layer; 5] = [
    Layer::Depth,
    Layer::Value,
    Layer::Normal,
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
            .with("NORMALS", has(Layer::Normal))
            .with("COUNTERS", has(Layer::Steps))
    }

    /// The arguments of a pass that writes the colour (linear light, premultiplied) and these layers.
    pub fn args(&self, run: &Run, color: &mut Buffer<[f32; 4]>, layers: &mut DeviceLayers) -> Args {
        let args = self.cast_inputs.by_cells(run).with(self.transfer);
        let args = args.read_some("node_average", self.node_average);
        let args = self.cast_inputs.along_rays(args, run, self.gradient);
        self.cast_inputs
            .by_steps(args, &self.cast)
            .value("shading", &self.shading)
            .write("color", color)
            .with(layers.writing(&LAYERS))
    }
}
