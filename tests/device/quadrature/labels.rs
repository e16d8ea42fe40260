//! Labels: with the nearest filter the field has the voxels' own values and none between them, whatever
//! looks at it.

use angioray::frame::{Frame, KIND, VALUE, Wanted};
use angioray::gpu::Device;
use angioray::render::{Options, Renderer};
use angioray::scene::{
    Emission, Filter, Homogeneity, HomogeneityLimit, HomogeneityRule, Picture, Projection,
    Quadrature, QuadratureMethod, Refine, Rgb, Scene, TransferFunction, Window,
};
use angioray::volume::Volume;

use super::knot;
use crate::common::{self, hash, on_reference, volume_of};

const SIZE_PX: u32 = 24;
const RED: [f64; 3] = [1.0, 0.0, 0.0];

/// Blocks of three voxels, each of one of two labels; and one voxel far away from both, so that their
/// leaves' ranges are small shares of the volume's.
fn labelled(labels: [u8; 2]) -> Volume {
    volume_of([17, 16, 18], |x, y, z| {
        let block = |at: f64| (at / 3.0).floor();
        let second = hash(block(x), block(y), block(z)) < 0.5;
        let far = (x, y, z) == (16.0, 15.0, 17.0);
        if far { 40 } else { labels[usize::from(second)] }
    })
}

/// Opaque for values within 1/2 of one.
fn band(value: f64) -> TransferFunction {
    let points = [(-0.5, 0.0), (-0.4, 0.8), (0.4, 0.8), (0.5, 0.0)];
    let knots = points.map(|(off, opacity)| knot(value + off, RED, opacity));
    TransferFunction::new(knots.to_vec(), 1.0).unwrap()
}

/// Every rule, and with every one that allows it every method of taking leaves for one value.
fn rules() -> Vec<(Quadrature, Option<Homogeneity>)> {
    let mut rules = Vec::new();
    for method in QuadratureMethod::ALL {
        let quadrature = Quadrature::of(method);
        rules.push((quadrature, None));
        for (rule, limit) in [
            (HomogeneityRule::Optical, 1e-3),
            (HomogeneityRule::Optical, 1.0),
            (HomogeneityRule::Range, 1e-6),
            (HomogeneityRule::Range, 0.2),
            (HomogeneityRule::Range, 1.0),
        ] {
            if quadrature.is_stepped() {
                rules.push((
                    quadrature,
                    Some(Homogeneity {
                        rule,
                        limit: HomogeneityLimit::new(limit).unwrap(),
                    }),
                ));
            }
        }
    }
    rules
}

fn scene(volume: &Volume, filter: Filter, picture: Picture) -> Scene {
    let mut scene = common::scene(volume, SIZE_PX, picture);
    scene.sampling.filter = filter;
    scene
}

fn emission(value: f64, (quadrature, homogeneity): (Quadrature, Option<Homogeneity>)) -> Picture {
    Picture::Emission(Emission {
        quadrature,
        homogeneity,
        ..Emission::of(band(value))
    })
}

fn max_alpha(frame: &Frame) -> f32 {
    frame.color.iter().fold(0.0, |max, c| f32::max(max, c[3]))
}

/// The volumes, and for each the value between its two labels.
fn volumes() -> [(Volume, f64); 2] {
    [(labelled([0, 2]), 1.0), (labelled([1, 3]), 2.0)]
}

#[test]
fn no_rule_shows_a_label_between_two_with_the_nearest_filter() {
    let Some(device) = common::device() else {
        return;
    };
    for (volume, between) in volumes() {
        let octree = common::octree(&volume);
        let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
        let mut opacity = |filter, value, rule| {
            let scene = scene(&volume, filter, emission(value, rule));
            let wanted = match filter {
                Filter::Nearest => Wanted::NONE,
                Filter::Linear => Wanted::ALL,
            };
            max_alpha(&renderer.render(&scene, wanted).unwrap().frame)
        };
        for rule in rules() {
            assert_eq!(opacity(Filter::Nearest, between, rule), 0.0, "{rule:?}");
            // The controls: the linear filter has that value; and the labels themselves are seen.
            assert!(opacity(Filter::Linear, between, rule) > 0.3, "{rule:?}");
            assert!(
                opacity(Filter::Nearest, between + 1.0, rule) > 0.9,
                "{rule:?}"
            );
        }
        let reference = |filter, value| {
            let rule = (Quadrature::default(), None);
            max_alpha(&on_reference(
                &volume,
                &scene(&volume, filter, emission(value, rule)),
            ))
        };
        assert_eq!(reference(Filter::Nearest, between), 0.0);
        assert!(reference(Filter::Linear, between) > 0.3);
        assert!(reference(Filter::Nearest, between + 1.0) > 0.9);
    }
}

/// Values of the pixels that have one.
fn values(device: &Device, volume: &Volume, filter: Filter, picture: Picture) -> Vec<f32> {
    let scene = scene(volume, filter, picture);
    let frame = &common::on_device(device, volume, &[scene])[0];
    let seen = frame
        .plane(KIND)
        .into_iter()
        .flatten()
        .zip(frame.plane(VALUE).into_iter().flatten());
    seen.filter(|(kind, _)| **kind > 0)
        .map(|(_, &v)| v)
        .collect()
}

#[test]
fn no_peak_lies_between_two_samples_of_the_nearest_filter() {
    let Some(device) = common::device() else {
        return;
    };
    let window = Window::new(0.0, 40.0).unwrap();
    let mut pictures = vec![Picture::Surface {
        iso: 1.0,
        caps: true,
        refine: Refine::default(),
        color: Rgb(RED),
        phong: None,
    }];
    for of in [
        Projection::Maximum,
        Projection::Minimum,
        Projection::LocalMaximum { threshold: 0.5 },
    ] {
        pictures.push(Picture::Projection { of, window });
    }
    let volume = labelled([0, 2]);
    let mut others = 0;
    for picture in pictures {
        let is_label = |v: &f32| [0.0, 2.0, 40.0].contains(v);
        let nearest = values(&device, &volume, Filter::Nearest, picture.clone());
        assert!(
            nearest.len() > 100 && nearest.iter().all(is_label),
            "{picture:?}"
        );
        let linear = values(&device, &volume, Filter::Linear, picture);
        others += linear.iter().filter(|v| !is_label(v)).count();
    }
    // The control.
    assert!(others > 100, "{others}");
}
