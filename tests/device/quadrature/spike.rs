//! A transfer function's spike that falls between two samples.

use angioray::scene::{
    Emission, Quadrature, QuadratureMethod, StepVoxels, Termination, TransferFunction,
};
use glam::DVec3;

use super::{apart, colors, knot, through};
use crate::common::{self, on_reference, volume_of};

const RED: [f64; 3] = [0.9, 0.1, 0.2];

/// Opaque for values within `width` of 4.37, which a ramp of one a voxel has for 2 `width` mm.
fn spike(width: f64) -> TransferFunction {
    let knots = vec![
        knot(0.0, [0.0; 3], 0.0),
        knot(4.37 - width, RED, 0.0),
        knot(4.37, RED, 0.9),
        knot(4.37 + width, RED, 0.0),
    ];
    TransferFunction::new(knots, 2.0 * width).unwrap()
}

#[test]
fn preintegration_keeps_a_spike_between_two_samples_and_other_rules_lose_it() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume_of([9, 9, 9], |x, _, _| x as f32);
    for width in [0.05, 1e-3, 1e-5] {
        for method in QuadratureMethod::ALL {
            let emission = Emission {
                quadrature: Quadrature::of(method),
                termination: Termination::NEVER,
                ..Emission::of(spike(width))
            };
            let mut scene = through(&volume, DVec3::splat(4.2), DVec3::X, emission);
            scene.sampling.step = StepVoxels::new(1.0).unwrap();
            let reference = on_reference(&volume, &scene).color[0].map(f64::from);
            assert!(reference[3] > 0.5, "{reference:?}");
            let seen = colors(&device, &volume, &[scene])[0];
            let error = apart(seen, reference);
            // A spike of 1e-5 has its knots in the last digits of single precision.
            let limit = if width < 1e-4 { 0.05 } else { 2e-3 };
            let keeps = matches!(
                method,
                QuadratureMethod::Preintegrated | QuadratureMethod::Adaptive
            );
            assert_eq!(error < limit, keeps, "{method}, {width}: {error}");
            assert!(keeps || seen[3] == 0.0, "{method}, {width}: {seen:?}");
        }
    }
}
