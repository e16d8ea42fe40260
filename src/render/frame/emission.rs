//! The passes of `dvr`: one cast.

use crate::error::{Error, Result};
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::{EmissionCast, KernelEnum, Material, Shading, covector_scale, shading};
use crate::render::occupancy::{Opacity, stand_ins};
use crate::render::passes::{
    Blocks, EmissionInputs, LightDepths, MediumBlocks, Reflects, Run, Seen, SurfaceBlocks,
    adaptive_emission, cast_emission, mark_uncertain, mark_varying_light,
};
use crate::render::resources::{DeviceGradient, DeviceTransfer, Tables};
use crate::scene::{
    Emission, Gradient, Light, Quadrature, Rgb, Scene, ScreenError, ShadowMethod, TransferFunction,
    Traverse,
};

use super::light_grids::LightGrids;
use super::planes::Planes;
use super::schedule::Schedule;
use super::view::View;

/// One cast, under a transfer function that is on the device.
pub struct EmissionPasses<'a> {
    view: &'a View<'a>,
    quadrature: Quadrature,
    transfer: DeviceTransfer,
    /// The averages that stand for homogeneous leaves; `None` where no leaf counts as homogeneous, and rays
    /// are followed as without.
    node_average: Option<Buffer<f32>>,
    cast: EmissionCast,
    shading: Shading,
    is_shaded: bool,
    shadows: Option<ShadowMethod>,
    /// Grids in the lights, where shadows are found by them.
    light_grids: Option<LightGrids>,
    reflects: Reflects,
}

impl<'a> EmissionPasses<'a> {
    /// The passes of a medium, whose transfer function is uploaded.
    ///
    /// # Errors
    /// The device has no room; homogeneous nodes, or a gradient to shade from, beside what excludes them.
    pub fn new(
        run: &Run,
        view: &'a View<'a>,
        emission: &Emission,
        opacity: &Opacity,
    ) -> Result<Self> {
        check_homogeneity(emission)?;
        check_gradient(emission, view.scene.gradient)?;
        let quadrature = emission.quadrature;
        let with_values = layers(view).contains(&Layer::Value);
        let shadows = shadows(view, emission);
        let tables = Tables::of(quadrature.method(), run.variant.filter, with_values)
            .with_sums_if(integrates(shadows), with_values);
        let light_grids = match shadows {
            Some(ShadowMethod::Cached(side)) => {
                Some(LightGrids::new(run.device, view.scene, view.volume, side)?)
            }
            _ => None,
        };
        let transfer = DeviceTransfer::upload(run.device, &opacity.knots, tables)?;
        let node_average = node_average(run, view, emission)?;
        let material = Material {
            color: Rgb::BLACK,
            phong: emission.phong,
            shaded_from: emission.shaded_from,
        };
        Ok(Self {
            view,
            quadrature,
            cast: emission_cast(view, emission, &transfer, node_average.is_some()),
            shading: shading(&material, view.scene, view.volume),
            is_shaded: emission.phong.is_some(),
            shadows,
            light_grids,
            reflects: reflects(emission, &view.scene.lights),
            transfer,
            node_average,
        })
    }
}

impl Schedule for EmissionPasses<'_> {
    fn planes(&self, run: &Run) -> Result<Planes> {
        let mut planes = Planes::new(run, &layers(self.view))?;
        let averages_bytes = self
            .node_average
            .as_ref()
            .map_or(0, |averages| averages.bytes());
        let grids_bytes = self.light_grids.as_ref().map_or(0, |grids| grids.bytes());
        planes.other_bytes = self.transfer.bytes() + averages_bytes + grids_bytes;
        Ok(planes)
    }

    fn cast(&self, run: &mut Run, planes: &mut Planes) -> Result<()> {
        let Some(grids) = &self.light_grids else {
            return self.cast_with(run, planes, None);
        };
        grids.fill(
            run,
            self.view.inputs,
            &self.transfer,
            &self.cast,
            self.view.volume,
        )?;
        grids.read(|depths| self.cast_with(run, planes, Some(depths)))
    }

    /// The error is of a channel's linear light, and of the opacity.
    fn mark_unproven(
        &self,
        run: &mut Run,
        blocks: Blocks,
        error: ScreenError,
        marks: &mut Buffer<u32>,
    ) -> Result<()> {
        let asked = MediumBlocks {
            blocks,
            max_error: error.get() as f32,
            unit_length_mm: self.cast.unit_length_mm,
            reflects: self.reflects,
        };
        mark_varying_light(run, self.view.inputs, &asked, marks)
    }

    fn mark_hidden(&self, run: &mut Run, planes: &Planes, marks: &mut Buffer<u32>) -> Result<()> {
        let asked = SurfaceBlocks {
            blocks: Blocks::PIXELS,
            iso: f32::INFINITY,
            margin: 0.5,
            max_error_mm: None,
            seen: Some(Seen::Colors(&planes.color)),
        };
        mark_uncertain(run, self.view.inputs, &asked, marks)
    }
}

impl EmissionPasses<'_> {
    /// The cast, with what is known of the lights' shadows.
    fn cast_with(
        &self,
        run: &mut Run,
        planes: &mut Planes,
        light_grids: Option<LightDepths>,
    ) -> Result<()> {
        let Planes { color, layers, .. } = planes;
        let inputs = EmissionInputs {
            cast_inputs: self.view.inputs,
            transfer: &self.transfer,
            node_average: self.node_average.as_ref(),
            gradient: if self.is_shaded || layers.has(Layer::Normal) {
                self.view.gradient
            } else {
                DeviceGradient::NONE
            },
            cast: self.cast,
            shading: self.shading,
            shaded: self.is_shaded,
            shadows: self.shadows,
            light_grids,
        };
        if self.quadrature.is_stepped() {
            cast_emission(run, self.quadrature.method(), &inputs, color, layers)
        } else {
            adaptive_emission(run, &inputs, color, layers)
        }
    }
}

/// How what reaches points of lights is found, where the medium is shaded.
fn shadows(view: &View, emission: &Emission) -> Option<ShadowMethod> {
    let shadows = view.scene.shadows.filter(|_| emission.phong.is_some());
    shadows.map(|shadows| shadows.method)
}

/// Whether what feelers pass is integrated over values.
fn integrates(shadows: Option<ShadowMethod>) -> bool {
    matches!(shadows, Some(ShadowMethod::Exact | ShadowMethod::Cached(_)))
}

fn check_homogeneity(emission: &Emission) -> Result<()> {
    let refuses = emission.phong.is_some() || !emission.quadrature.is_stepped();
    if emission.homogeneity.is_some() && refuses {
        return Err(Error::usage(
            "homogeneous nodes go with neither shading nor the adaptive quadrature",
        ));
    }
    Ok(())
}

fn check_gradient(emission: &Emission, gradient: Gradient) -> Result<()> {
    let is_direction = matches!(gradient, Gradient::Precomputed(_));
    if emission.phong.is_some() && emission.shaded_from.get() > 0.0 && is_direction {
        return Err(Error::usage(
            "a gradient to shade from does not go with precomputed gradients, of which only the direction is stored",
        ));
    }
    Ok(())
}

/// The layers that the cast writes.
fn layers(view: &View) -> Vec<Layer> {
    let wanted = view.wanted;
    let mut layers = Vec::new();
    if wanted.has_any([Layer::Depth, Layer::Value]) {
        layers.extend([Layer::Depth, Layer::Value]);
    }
    if wanted.has(Layer::Normal) {
        layers.push(Layer::Normal);
    }
    if wanted.has(Layer::Visibility) && view.scene.shadows.is_some() {
        layers.push(Layer::Visibility);
    }
    if wanted.has_any(Layer::COUNTERS) {
        layers.extend(Layer::COUNTERS);
    }
    layers
}

fn node_average(run: &Run, view: &View, emission: &Emission) -> Result<Option<Buffer<f32>>> {
    if emission.homogeneity.is_none() || !view.inputs.occupancy.has_homogeneous() {
        return Ok(None);
    }
    let stand_ins = stand_ins(view.octree, run.variant.filter);
    Buffer::upload(run.device, "octree's averages", &stand_ins).map(Some)
}

/// The share of the adaptive quadrature's bound that early termination may use up.
const ENDED_EARLY: f64 = 0.25;

fn emission_cast(
    view: &View,
    emission: &Emission,
    on_device: &DeviceTransfer,
    through_leaves: bool,
) -> EmissionCast {
    let Emission {
        quadrature,
        ref transfer,
        ..
    } = *emission;
    // What a bound on premultiplied light leaves for opacity: all behind may be this bright.
    let max_reflected = (emission.phong).map_or(1.0, |phong| {
        phong.most_reflected(&view.scene.lights).of_white()
    });
    let bound = quadrature.bound() / max_reflected.max(1.0);
    let termination = 1.0 - emission.termination.get();
    let min_transmittance = if quadrature.is_stepped() {
        termination
    } else {
        termination.min(ENDED_EARLY * bound)
    };
    EmissionCast {
        step_mm: view.step_mm(),
        unit_length_mm: transfer.unit_length_mm() as f32,
        max_absorption: -(-TransferFunction::MAX_OPACITY).ln_1p() as f32,
        min_transmittance: min_transmittance as f32,
        knots: on_device.knots,
        traverse: if through_leaves {
            traverse_through_leaves(view)
        } else {
            view.traverse()
        },
        bound: ((1.0 - ENDED_EARLY) * bound) as f32,
        color_spread: on_device.color_spread,
        absorbs_from: on_device.absorbing[0],
        absorbs_to: on_device.absorbing[1],
        layers_from: Emission::LAYERS_FROM,
        mm_per_t: covector_scale(view.volume).recip() as f32,
        shadow_step_mm: view.step_mm() * shadow_steps(view.scene) as f32,
        pad_0: 0,
        pad_1: 0,
        pad_2: 0,
    }
}

/// The distance of samples along the rays toward lights, in sample steps of the eye's rays.
fn shadow_steps(scene: &Scene) -> f64 {
    match scene.shadows.map(|shadows| shadows.method) {
        Some(ShadowMethod::Stepped(steps)) => steps.get(),
        _ => 1.0,
    }
}

/// How kernels are to traverse where every leaf must be met: without skipping, one leaf after the other.
fn traverse_through_leaves(view: &View) -> u32 {
    let sampling = &view.scene.sampling;
    let traverse = if sampling.skip {
        sampling.traverse
    } else {
        Traverse::Uniform
    };
    Some(traverse).number()
}

/// What shading makes of a medium's colour at least and at most; where the gradient is small it leaves it, wholly or in
/// part.
fn reflects(emission: &Emission, lights: &[Light]) -> Reflects {
    let Some(phong) = emission.phong else {
        return Reflects::UNSHADED;
    };
    let most = phong.most_reflected(lights);
    let channels = |of: &dyn Fn(usize) -> f64| {
        let [r, g, b] = std::array::from_fn(|c| of(c) as f32);
        [r, g, b, 0.0]
    };
    Reflects {
        least: channels(&|c| most.ambient[c].min(1.0)),
        most: channels(&|c| (most.ambient[c] + most.diffuse[c]).max(1.0)),
        added: channels(&|c| most.specular[c]),
    }
}
