//! A ray that ends early loses at most (1 − termination) times the brightest colour.

use crate::common;

use angioray::frame::{Frame, STEPS, Wanted};
use angioray::render::{Options, Renderer};
use angioray::scene::{
    Emission, Knot, Picture, Quadrature, QuadratureMethod, Rgb, Termination, TransferFunction,
};
use common::volume_of;

/// Thin dark mist before bright fog: what a ray loses at its end is the brightest there is.
fn mist_before_fog(method: QuadratureMethod, termination: f64) -> Picture {
    let knot = |value: f64, light: f64, opacity: f64| Knot {
        value,
        color: Rgb([light; 3]),
        opacity,
    };
    let knots = vec![
        knot(0.0, 0.0, 0.08),
        knot(1.0, 0.0, 0.08),
        knot(1.1, 1.0, 0.5),
    ];
    Picture::Emission(Emission {
        quadrature: Quadrature::of(method),
        termination: Termination::new(termination).unwrap(),
        ..Emission::of(TransferFunction::new(knots, 1.0).unwrap())
    })
}

fn max_lost(whole: &Frame, ended: &Frame) -> f64 {
    let pairs = whole
        .color
        .iter()
        .flatten()
        .zip(ended.color.iter().flatten());
    pairs.map(|(w, e)| f64::from(w - e)).fold(0.0, f64::max)
}

#[test]
fn what_is_lost_stays_below_the_bound_and_samples_are_saved() {
    let Some(device) = common::device() else {
        return;
    };
    // The eye looks along +y and −x: fog behind, mist before.
    let volume = volume_of([40, 40, 40], |_, y, _| if y > 22.0 { 2u8 } else { 0 });
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut render = |method, termination| {
        let scene = common::scene(&volume, 48, mist_before_fog(method, termination));
        let frame = renderer.render(&scene, Wanted::ALL).unwrap().frame;
        let samples: u64 = frame
            .plane(STEPS)
            .into_iter()
            .flatten()
            .map(|&n| u64::from(n))
            .sum();
        (frame, samples)
    };
    for method in QuadratureMethod::ALL {
        let (whole, all_samples) = render(method, 1.0);
        let mut samples_before = 0;
        for termination in [0.5, 0.8, 0.95, 0.999] {
            let (ended, samples) = render(method, termination);
            let lost = max_lost(&whole, &ended);
            if method == QuadratureMethod::Adaptive {
                // Its own bound holds for what is lost at the end too, whatever is requested.
                assert!(
                    lost <= Quadrature::DEFAULT_BOUND,
                    "{method} {termination}: {lost}"
                );
                continue;
            }
            let bound = 1.0 - termination;
            assert!(lost <= bound + 1e-6, "{method} {termination}: {lost}");
            // The bound is no idle one: a fifth of it is lost in some pixel.
            assert!(lost > 0.2 * bound, "{method} {termination}: {lost}");
            assert!(
                samples > samples_before && samples < all_samples,
                "{method} {termination}"
            );
            samples_before = samples;
        }
    }
}
