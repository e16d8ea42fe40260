//! The passes of `dvr`: one cast.

use crate::error::{Error, Result};
use crate::gpu::Buffer;
use crate::scene::{Emission, QuadratureMethod, Rgb, TransferFunction};

use super::abi::EmissionCast;
use super::classify;
use super::homogeneity::Limit;
use super::medium::Knots;
use super::passes::{DeviceTransfer, Run, cast_emission};
use super::picture::View;
use super::planes::Planes;
use super::twins;
use super::variant::traverse_through_leaves;

/// `dvr`: classify the nodes, cast.
pub fn emission(run: &mut Run, view: &View, emission: &Emission) -> Result<Planes> {
    let Emission {
        ref transfer,
        phong,
        quadrature,
        termination,
        homogeneity,
    } = *emission;
    if homogeneity.is_some() && (phong.is_some() || !quadrature.is_stepped()) {
        return Err(Error::usage(
            "homogeneous nodes go with neither shading nor the adaptive quadrature",
        ));
    }
    let knots = Knots::of(transfer, view.volume);
    let skip = view.scene.sampling.skip;
    let node_class = run.node_classes(|| {
        let limit = homogeneity.map(|homogeneity| Limit::new(homogeneity, transfer, view.volume));
        classify::by_opacity(view.octree, &knots, skip, limit)
    })?;
    let integrates = matches!(
        quadrature.method,
        QuadratureMethod::Preintegrated | QuadratureMethod::Adaptive
    );
    let knots = if integrates { knots.smooth() } else { knots };
    let sums = if integrates { knots.sums() } else { Vec::new() };
    let on_device = DeviceTransfer {
        values: Buffer::upload(run.device, "transfer function", &knots.values)?,
        colors: Buffer::upload(run.device, "transfer function", &knots.colors)?,
        sums: Buffer::upload(run.device, "transfer function's sums", &sums)?,
    };
    let leaves = view.octree.levels()[0].nodes();
    let averages = homogeneity
        .map(|_| {
            let averages = &view.octree.averages()[..leaves];
            Buffer::upload(run.device, "octree's averages", averages)
        })
        .transpose()?;
    let cast = EmissionCast {
        step_mm: view.step_mm(),
        unit_length_mm: transfer.unit_length_mm() as f32,
        most_absorption: -(-TransferFunction::MAX_OPACITY).ln_1p() as f32,
        least_transmission: (1.0 - termination) as f32,
        knots: knots.values.len() as u32,
        traverse: if homogeneity.is_some() {
            traverse_through_leaves(&view.scene.sampling)
        } else {
            view.traverse()
        },
        bound: quadrature.bound as f32,
        pad: 0,
    };
    let shading = twins::shading(Rgb::BLACK, phong, view.scene.light);
    let mut color = run.plane("colour plane")?;
    let mut counters = run.counters(view.wanted.counters)?;
    cast_emission(
        run,
        quadrature.method,
        phong.is_some(),
        view.uploaded,
        &node_class,
        averages.as_ref(),
        &on_device,
        &view.rays,
        &cast,
        &shading,
        &mut color,
        counters.as_mut(),
    )?;
    let averages_bytes = averages.as_ref().map_or(0, |averages| averages.bytes());
    Ok(Planes {
        color,
        display: None,
        depth: None,
        normal: None,
        value: None,
        kind: None,
        counters,
        other_bytes: node_class.bytes() + on_device.bytes() + averages_bytes,
    })
}
