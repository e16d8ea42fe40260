//! Every variant of every pass builds, and takes the arguments that its Rust function gives.

mod common;

use angioray::extent::ImageSize;
use angioray::frame::Wanted;
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::render::{Options, Renderer};
use angioray::scene::{
    Filter, Knot, Phong, Picture, Projection, Refine, Rgb, TransferFunction, Window,
};
use angioray::volume::{Volume, Voxels};
use common::volume_of;

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
        pictures.push(Picture::Emission {
            transfer: transfer.clone(),
            phong,
            termination: 0.99,
        });
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

/// Builds and runs every pass of every picture for one voxel type; counts the launches.
fn launches<T>(voxel: impl Fn(f64, f64, f64) -> T) -> usize
where
    Voxels: From<Vec<T>>,
{
    let Some(device) = common::device() else {
        return 1;
    };
    let volume: Volume = volume_of([6, 5, 4], voxel);
    let octree = Octree::build(&volume, Leaf::default(), &Silent).unwrap();
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut launches = 0;
    for picture in pictures() {
        for filter in [Filter::Linear, Filter::Nearest] {
            for wanted in [Wanted::default(), Wanted::ALL] {
                let mut scene = common::scene(&volume, 8, picture.clone());
                scene.size = ImageSize::new(8, 8).unwrap();
                scene.sampling.filter = filter;
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
                assert_eq!(rendering.frame.normal.is_some(), wanted.normal);
                launches += rendering.passes.len();
            }
        }
    }
    launches
}

#[test]
fn u8_variants_build() {
    assert!(launches(|x, y, z| (x + y + z) as u8) > 0);
}

#[test]
fn u16_variants_build() {
    assert!(launches(|x, y, z| (x + y + z) as u16) > 0);
}

#[test]
fn i16_variants_build() {
    assert!(launches(|x, y, z| (x + y - z) as i16) > 0);
}

#[test]
fn f32_variants_build() {
    assert!(launches(|x, y, z| (x + y + z) as f32 * 0.5) > 0);
}
