//! The passes of `dvr`: classify the nodes, one cast.

use crate::error::{Error, Result};
use crate::gpu::Buffer;
use crate::scene::{Emission, Phong, QuadratureMethod, Rgb, TransferFunction};

use super::abi::EmissionCast;
use super::medium::Knots;
use super::passes::{DeviceTransfer, Run, adaptive_emission, cast_emission};
use super::picture::View;
use super::planes::Planes;
use super::twins;
use super::variant::traverse_through_leaves;

pub fn emission(run: &mut Run, view: &View, emission: &Emission) -> Result<Planes> {
    let Emission {
        phong,
        quadrature,
        homogeneity,
        ref transfer,
        ..
    } = *emission;
    if homogeneity.is_some() && (phong.is_some() || !quadrature.is_stepped()) {
        return Err(Error::usage(
            "homogeneous nodes go with neither shading nor the adaptive quadrature",
        ));
    }
    let knots = Knots::of(transfer, view.volume);
    let on_device = match quadrature.method {
        QuadratureMethod::Preintegrated => transfer_on_device(run, &knots.smooth(), true)?,
        QuadratureMethod::Adaptive => transfer_on_device(run, &knots, true)?,
        _ => transfer_on_device(run, &knots, false)?,
    };
    let averages = match homogeneity {
        Some(_) => {
            let leaves = view.octree.levels()[0].nodes();
            let averages = &view.octree.averages()[..leaves];
            Some(Buffer::upload(run.device, "octree's averages", averages)?)
        }
        None => None,
    };
    let shaded_by = phong.map(|_| view.gradient);
    let cast = emission_cast(view, emission, &on_device);
    let shading = twins::shading(Rgb::BLACK, phong, view.scene.light);
    let mut color = run.plane("colour plane")?;
    let mut counters = run.counters(view.wanted.counters)?;
    if quadrature.is_stepped() {
        cast_emission(
            run,
            quadrature.method,
            shaded_by,
            view.uploaded,
            view.clip,
            view.classified,
            averages.as_ref(),
            &on_device,
            &view.rays,
            &cast,
            &shading,
            &mut color,
            counters.as_mut(),
        )?;
    } else {
        adaptive_emission(
            run,
            shaded_by,
            view.uploaded,
            view.clip,
            view.classified,
            &on_device,
            &view.rays,
            &cast,
            &shading,
            &mut color,
            counters.as_mut(),
        )?;
    }
    let averages_bytes = averages.as_ref().map_or(0, |averages| averages.bytes());
    Ok(Planes {
        color,
        display: None,
        depth: None,
        normal: None,
        value: None,
        kind: None,
        certificate: None,
        counters,
        other_bytes: on_device.bytes() + averages_bytes,
    })
}

fn transfer_on_device(run: &Run, knots: &Knots, with_sums: bool) -> Result<DeviceTransfer> {
    let sums = if with_sums { knots.sums() } else { Vec::new() };
    Ok(DeviceTransfer {
        values: Buffer::upload(run.device, "transfer function", &knots.values)?,
        colors: Buffer::upload(run.device, "transfer function", &knots.colors)?,
        sums: Buffer::upload(run.device, "transfer function's sums", &sums)?,
        knots: knots.values.len() as u32,
        color_spread: knots.color_spread(),
        absorbing: knots.absorbing(),
    })
}

/// The share of the adaptive quadrature's bound that early termination may use up.
const ENDED_EARLY: f64 = 0.25;

fn emission_cast(view: &View, emission: &Emission, on_device: &DeviceTransfer) -> EmissionCast {
    let Emission {
        quadrature,
        homogeneity,
        ref transfer,
        ..
    } = *emission;
    // What a bound on premultiplied light leaves for opacity: all behind may be this bright.
    let bound = quadrature.bound / emission.phong.map_or(1.0, brightest).max(1.0);
    let termination = 1.0 - emission.termination;
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
        traverse: if homogeneity.is_some() {
            traverse_through_leaves(&view.scene.sampling)
        } else {
            view.traverse()
        },
        bound: ((1.0 - ENDED_EARLY) * bound) as f32,
        color_spread: on_device.color_spread,
        absorbs_from: on_device.absorbing[0],
        absorbs_to: on_device.absorbing[1],
        pad_0: 0,
        pad_1: 0,
    }
}

/// The most light that white reflects.
fn brightest(phong: Phong) -> f64 {
    phong.ambient + phong.diffuse + phong.specular
}
