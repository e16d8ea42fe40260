//! The passes build and take the arguments that their Rust functions give: for every voxel type,
//! filter and picture with all layers and counters; for `u8` also with samples shifted, with neither, with every gradient,
//! and, under the linear filter, with either alone and with an octree leaf that is no power of two. The 64-bit index, which only volumes of more than 2^32 voxels select, is left to
//! `kernel_lint`.

use crate::common;

use angioray::extent::ImageSize;
use angioray::frame::{Layer, Wanted};
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::render::{Options, Renderer};
use angioray::scene::{
    Emission, Filter, Gradient, Homogeneity, HomogeneityLimit, HomogeneityRule, Jitter, Knot,
    Phong, Picture, Precomputed, Projection, Quadrature, QuadratureMethod, Reconstruction, Refine,
    Rgb, Termination, TransferFunction, Window,
};
use angioray::volume::{Volume, VoxelType, Voxels};
use common::volume_of;

/// With the default quadrature.
fn pictures() -> Vec<Picture> {
    let window = Window::new(0.0, 4.0).unwrap();
    let transfer = TransferFunction::new(
        vec![Knot {
            value: 1.0,
            color: Rgb([1.0; 3]),
            opacity: 0.5,
        }],
        1.0,
    )
    .unwrap();
    let mut pictures = Vec::new();
    for phong in [None, Some(Phong::default())] {
        pictures.push(Picture::Surface {
            iso: 1.5,
            caps: true,
            refine: Refine::default(),
            color: Rgb([1.0; 3]),
            phong,
        });
        pictures.push(Picture::Emission(Emission {
            phong,
            termination: Termination::new(0.99).unwrap(),
            ..Emission::of(transfer.clone())
        }));
    }
    for of in [
        Projection::Maximum,
        Projection::Mean,
        Projection::LocalMaximum { threshold: 1.0 },
    ] {
        pictures.push(Picture::Projection { of, window });
    }
    pictures
}

/// Emission under every quadrature, shaded and not, and with homogeneous leaves.
fn emissions() -> Vec<Picture> {
    let knot = Knot {
        value: 1.0,
        color: Rgb([1.0; 3]),
        opacity: 0.5,
    };
    let plain = Emission::of(TransferFunction::new(vec![knot], 1.0).unwrap());
    let homogeneity = Homogeneity {
        rule: HomogeneityRule::Optical,
        limit: HomogeneityLimit::new(0.1).unwrap(),
    };
    let mut emissions = Vec::new();
    for method in QuadratureMethod::ALL {
        let quadrature = Quadrature::of(method);
        let mut push = |phong, homogeneity| {
            emissions.push(Picture::Emission(Emission {
                phong,
                quadrature,
                homogeneity,
                ..plain.clone()
            }));
        };
        push(None, None);
        push(Some(Phong::default()), None);
        if quadrature.is_stepped() {
            push(None, Some(homogeneity));
        }
    }
    emissions
}

/// Other gradients than central differences.
fn gradients() -> Vec<Gradient> {
    vec![
        Gradient::Forward,
        Gradient::FourthOrder,
        Gradient::Precomputed(Precomputed::default()),
    ]
}

/// Every picture with central differences for each of the outputs; those that shade with the other
/// gradients too, for the last of them.
fn views<'a>(
    pictures: &[Picture],
    gradients: &[Gradient],
    outputs: &'a [Wanted],
) -> Vec<(Picture, Gradient, &'a [Wanted])> {
    let last = &outputs[outputs.len() - 1..];
    let mut all = Vec::new();
    for picture in pictures {
        let is_shaded = match picture {
            Picture::Surface { phong, .. } => phong.is_some(),
            Picture::Emission(emission) => emission.phong.is_some(),
            Picture::Projection { .. } => false,
        };
        all.push((picture.clone(), Gradient::Central, outputs));
        if is_shaded {
            let of = |&gradient| (picture.clone(), gradient, last);
            all.extend(gradients.iter().map(of));
        }
    }
    all
}

fn layers_alone() -> Wanted {
    Wanted::ALL.without(Layer::COUNTERS)
}

fn counters_alone() -> Wanted {
    Wanted::NONE.with(Layer::COUNTERS)
}

/// Builds and runs every pass of these pictures for one voxel type, with these filters and planes;
/// counts the launches.
fn launches<T>(
    pictures: &[Picture],
    gradients: &[Gradient],
    leaf: Leaf,
    filters: &[Filter],
    outputs: &[Wanted],
    voxel: impl Fn(f64, f64, f64) -> T,
) -> usize
where
    Voxels: From<Vec<T>>,
{
    let Some(device) = common::device() else {
        return 1;
    };
    let volume: Volume = volume_of([13, 7, 4], voxel);
    let octree = Octree::build(&volume, leaf, &Silent).unwrap();
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut launches = 0;
    for (picture, gradient, outputs) in views(pictures, gradients, outputs) {
        for &filter in filters {
            for &wanted in outputs {
                let mut scene = common::scene(&volume, 8, picture.clone());
                scene.size = ImageSize::new(8, 8).unwrap();
                scene.sampling.filter = filter;
                scene.gradient = gradient;
                let rendering = renderer.render(&scene, wanted).unwrap();
                assert!(
                    rendering
                        .frame
                        .color
                        .iter()
                        .flatten()
                        .all(|c| c.is_finite())
                );
                assert_eq!(rendering.frame.display.is_some(), wanted.display);
                for layer in Layer::ALL.into_iter().filter(|&layer| layer != Layer::Cast) {
                    assert_eq!(rendering.frame.layers.has(layer), wanted.has(layer));
                }
                launches += rendering.passes.len();
            }
            let mut straight = common::scene(&volume, 8, picture.clone());
            straight.sampling.filter = filter;
            assert!(renderer.sample_field(&straight).unwrap().samples() > 0);
            // Shifts have nothing to do with voxels.
            if volume.voxels().voxel_type() == VoxelType::U8 {
                straight.sampling.jitter = Jitter::Hash { seed: 1, frame: 0 };
                let jittered = renderer.render(&straight, Wanted::ALL).unwrap();
                launches += jittered.passes.len();
            }
            if filter == Filter::Linear && matches!(picture, Picture::Surface { .. }) {
                straight.sampling.recon = Reconstruction::Adaptive;
                launches += renderer
                    .render(&straight, Wanted::ALL)
                    .unwrap()
                    .passes
                    .len();
            }
        }
    }
    launches
}

const FILTERS: [Filter; 2] = [Filter::Linear, Filter::Nearest];

fn sum(x: f64, y: f64, z: f64) -> u8 {
    (x + y + z) as u8
}

/// Both filters, with all layers and counters: what the type of a voxel may change.
fn of_voxel<T>(voxel: impl Fn(f64, f64, f64) -> T) -> usize
where
    Voxels: From<Vec<T>>,
{
    let outputs = [Wanted::ALL];
    launches(&pictures(), &[], Leaf::default(), &FILTERS, &outputs, voxel)
}

#[test]
fn u8_variants_build() {
    let outputs = [Wanted::NONE, Wanted::ALL];
    let leaf = Leaf::default();
    assert!(launches(&pictures(), &gradients(), leaf, &FILTERS, &outputs, sum) > 0);
}

#[test]
fn u8_variants_build_with_either_output_alone() {
    let outputs = [layers_alone(), counters_alone()];
    let (leaf, linear) = (Leaf::default(), [Filter::Linear]);
    assert!(launches(&pictures(), &[], leaf, &linear, &outputs, sum) > 0);
}

#[test]
fn u8_variants_build_with_a_leaf_of_five_cells() {
    let (leaf, linear) = (Leaf::new(5).unwrap(), [Filter::Linear]);
    assert!(launches(&pictures(), &[], leaf, &linear, &[Wanted::ALL], sum) > 0);
}

#[test]
fn u8_variants_of_every_quadrature_build() {
    let leaf = Leaf::default();
    let linear = [Filter::Linear];
    assert!(
        launches(
            &emissions(),
            &gradients(),
            leaf,
            &linear,
            &[Wanted::ALL],
            sum
        ) > 0
    );
}

#[test]
fn u8_variants_of_every_quadrature_build_with_nearest_voxels() {
    let leaf = Leaf::default();
    let nearest = [Filter::Nearest];
    let outputs = [Wanted::NONE];
    assert!(launches(&emissions(), &[], leaf, &nearest, &outputs, sum) > 0);
}

#[test]
fn u16_variants_build() {
    assert!(of_voxel(|x, y, z| (x + y + z) as u16) > 0);
}

#[test]
fn i16_variants_build() {
    assert!(of_voxel(|x, y, z| (x + y - z) as i16) > 0);
}

#[test]
fn f32_variants_build() {
    assert!(of_voxel(|x, y, z| (x + y + z) as f32 * 0.5) > 0);
}
