//! The observed order of convergence of each fixed-step rule on smooth scenes. `angioray bench
//! convergence` prints it.

use angioray::lab::bench::convergence::{
    Errors, FLOOR_OF_FEW, ORDERS, Smooth, errors, halvings, observed_order,
};
use angioray::scene::QuadratureMethod;

use crate::common;

#[test]
fn every_rule_converges_with_its_order() {
    let Some(device) = common::device() else {
        return;
    };
    for scene in [Smooth::ramp().unwrap(), Smooth::cubic().unwrap()] {
        for (method, order) in ORDERS {
            let Errors { color, opacity } = errors(&device, &scene, method, &halvings()).unwrap();
            let name = format!("{} {method}", scene.name);
            let of_color = observed_order(&color, order);
            let agrees = |observed: f64, expected: f64| match expected {
                6.0 => observed >= 5.5,
                expected => (observed - expected).abs() <= 0.15,
            };
            assert!(agrees(of_color.unwrap(), order), "{name}: {color:?}");
            if scene.name == "ramp" && method == QuadratureMethod::Preintegrated {
                assert!(
                    opacity.iter().all(|&e| e < FLOOR_OF_FEW),
                    "{name}: {opacity:?}"
                );
                continue;
            }
            let of_opacity = observed_order(&opacity, order).unwrap();
            assert!(agrees(of_opacity, order), "{name}: {opacity:?}");
            // The control: no rule is taken for one of another order.
            for other in [1.0, 2.0, 4.0, 6.0] {
                let observed = observed_order(&opacity, other).unwrap_or(0.0);
                assert_eq!(
                    agrees(observed, other),
                    other == order,
                    "{name} {other}: {opacity:?}"
                );
            }
        }
    }
}

/// Every rule is exact at any step where the medium is the same everywhere.
#[test]
fn a_homogeneous_medium_is_exact_at_any_step() {
    let Some(device) = common::device() else {
        return;
    };
    let mut scene = Smooth::homogeneous().unwrap();
    let steps = [3.0, 1.0, 0.37];
    let max = |scene: &Smooth, method| {
        let Errors { color, opacity } = errors(&device, scene, method, &steps).unwrap();
        color.into_iter().chain(opacity).fold(0.0, f64::max)
    };
    for (method, _) in ORDERS {
        let error = max(&scene, method);
        assert!(error < 1e-6, "{method}: {error}");
    }
    // The control: a thousandth denser.
    scene.reference[3] *= 1.001;
    assert!(max(&scene, QuadratureMethod::Simpson) > 1e-6);
}
