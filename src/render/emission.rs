//! The passes of `dvr`: classify the nodes, one cast.

use crate::error::{Error, Result};
use crate::gpu::Buffer;
use crate::scene::{Emission, Phong, QuadratureMethod, Rgb, TransferFunction};

use super::abi::EmissionCast;
use super::gradient::DeviceGradient;
use super::homogeneity::stand_ins;
use super::medium::Knots;
use super::passes::{
    DeviceTransfer, EmissionPlanes, Run, adaptive_emission, cast_emission, integrates,
};
use super::picture::View;
use super::planes::Planes;
use super::twins;
use super::variant::traverse_through_leaves;

pub fn emission(run: &mut Run, view: &View, emission: &Emission) -> Result<Planes> {
    let Emission {
        phong,
        quadrature,
        homogeneity,
        ..
    } = *emission;
    if homogeneity.is_some() && (phong.is_some() || !quadrature.is_stepped()) {
        return Err(Error::usage(
            "homogeneous nodes go with neither shading nor the adaptive quadrature",
        ));
    }
    let with_values = view.wanted.depth || view.wanted.value;
    let on_device = transfer_on_device(run, view, emission, with_values)?;
    // Where no leaf counts as homogeneous the rays are followed as without.
    let node_average = match homogeneity.filter(|_| view.classified.has_homogeneous) {
        Some(_) => {
            let stand_ins = stand_ins(view.octree, run.variant.filter);
            Some(Buffer::upload(run.device, "octree's averages", &stand_ins)?)
        }
        None => None,
    };
    let gradient = if phong.is_some() || view.wanted.normal {
        view.gradient
    } else {
        DeviceGradient::none()
    };
    let cast = emission_cast(view, emission, &on_device, node_average.is_some());
    let shading = twins::shading(Rgb::BLACK, phong, view.scene.light);
    let mut planes = EmissionPlanes::new(run, view.wanted)?;
    if quadrature.is_stepped() {
        cast_emission(
            run,
            quadrature.method(),
            phong.is_some(),
            gradient,
            view.uploaded,
            view.clip,
            view.classified,
            node_average.as_ref(),
            &on_device,
            &view.rays,
            &cast,
            &shading,
            &mut planes,
        )?;
    } else {
        adaptive_emission(
            run,
            phong.is_some(),
            gradient,
            view.uploaded,
            view.clip,
            view.classified,
            &on_device,
            &view.rays,
            &cast,
            &shading,
            &mut planes,
        )?;
    }
    let averages_bytes = node_average.as_ref().map_or(0, |averages| averages.bytes());
    let (depth, value) = planes.place.unzip();
    Ok(Planes {
        color: planes.color,
        display: None,
        depth,
        normal: planes.normal,
        value,
        kind: None,
        certificate: None,
        counters: planes.counters,
        other_bytes: on_device.bytes() + averages_bytes,
    })
}

/// The transfer function with what the quadrature needs of it; `with_values` where the layers are averaged.
fn transfer_on_device(
    run: &Run,
    view: &View,
    emission: &Emission,
    with_values: bool,
) -> Result<DeviceTransfer> {
    let method = emission.quadrature.method();
    let plain = Knots::of(&emission.transfer, view.volume);
    let integrates = integrates(method, run.variant.filter);
    let knots = if integrates { plain.smooth() } else { plain };
    let (mut sums, mut value_sums) = (Vec::new(), Vec::new());
    if integrates || method == QuadratureMethod::Adaptive {
        sums = knots.sums();
        if with_values {
            value_sums = knots.value_sums();
        }
    }
    Ok(DeviceTransfer {
        values: Buffer::upload(run.device, "transfer function", &knots.values)?,
        colors: Buffer::upload(run.device, "transfer function", &knots.colors)?,
        sums: Buffer::upload(run.device, "transfer function's sums", &sums)?,
        value_sums: Buffer::upload(run.device, "transfer function's sums", &value_sums)?,
        knots: knots.values.len() as u32,
        color_spread: knots.color_spread(),
        absorbing: knots.absorbing(),
    })
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
    let bound = quadrature.bound() / emission.phong.map_or(1.0, brightest).max(1.0);
    let termination = 1.0 - emission.termination.get();
    let least_transmission = if quadrature.is_stepped() {
        termination
    } else {
        termination.min(ENDED_EARLY * bound)
    };
    EmissionCast {
        step_mm: view.step_mm(),
        unit_length_mm: transfer.unit_length_mm() as f32,
        most_absorption: -(-TransferFunction::MAX_OPACITY).ln_1p() as f32,
        least_transmission: least_transmission as f32,
        knots: on_device.knots,
        traverse: if through_leaves {
            traverse_through_leaves(&view.scene.sampling)
        } else {
            view.traverse()
        },
        bound: ((1.0 - ENDED_EARLY) * bound) as f32,
        color_spread: on_device.color_spread,
        absorbs_from: on_device.absorbing[0],
        absorbs_to: on_device.absorbing[1],
        layers_from: Emission::LAYERS_FROM,
        pad: 0,
    }
}

/// The most light that white reflects.
fn brightest(phong: Phong) -> f64 {
    phong.ambient.get() + phong.diffuse.get() + phong.specular.get()
}
