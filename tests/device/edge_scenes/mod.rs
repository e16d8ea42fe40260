//! Scenes at the edge: rays along the grid, eyes on it, extreme cameras, geometries, images, sizes
//! and values. On the device and on the reference: no NaN, no hang, the same answer.

use crate::common;
mod extremes;
mod grid;
mod offsets;
mod rounding;
mod values;

use angioray::extent::ImageSize;
use angioray::gpu::Device;
use angioray::scene::{
    Camera, Emission, Knot, Picture, Projection, Refine, Rgb, Scene, StepVoxels, Termination,
    TransferFunction, Window,
};
use angioray::volume::Volume;
use common::Figure::{AlphaMax, DepthP99, Kind, ValueMax};
use common::{Figure, assert_sound, hash, moved_by_a_pixel, on_device, on_reference, volume_of};

/// How far device and reference may be apart. Steps are a sixteenth of a voxel here, so that what
/// is left is rounding, and of white noise one pixel of 17² that a ridge grazes.
#[rustfmt::skip]
const LIMITS: &[(Mode, &[(Figure, f64)])] = &[
    (Mode::Iso, &[(Kind, 0.0), (DepthP99, 0.01)]),
    (Mode::Uncapped, &[(Kind, 0.0035), (DepthP99, 0.01)]),
    (Mode::Mip, &[(Kind, 0.0), (ValueMax, 0.005)]),
    (Mode::Minip, &[(Kind, 0.0), (ValueMax, 0.005)]),
    (Mode::Mean, &[(Kind, 0.0), (ValueMax, 0.005)]),
    (Mode::Lmip, &[(Kind, 0.0)]),
    (Mode::Dvr, &[(AlphaMax, 0.002)]),
];
const STEP_VOXELS: f64 = 0.0625;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    Iso,
    Uncapped,
    Mip,
    Minip,
    Mean,
    Lmip,
    Dvr,
}

fn surface(iso: f64, caps: bool) -> Picture {
    Picture::Surface {
        iso,
        caps,
        refine: "bisection:12".parse::<Refine>().unwrap(),
        color: Rgb([0.9; 3]),
        phong: None,
    }
}

fn emission(knots: &[(f64, f64)], unit_mm: f64) -> Picture {
    let knot = |&(value, opacity)| Knot {
        value,
        color: Rgb([0.8, 0.5, 0.3]),
        opacity,
    };
    Picture::Emission(Emission {
        termination: Termination::NEVER,
        ..Emission::of(TransferFunction::new(knots.iter().map(knot).collect(), unit_mm).unwrap())
    })
}

/// Each mode over the volume's own range.
fn picture(mode: Mode, volume: &Volume) -> Picture {
    let range = volume.range();
    let high = if range.width() > 0.0 {
        range.max
    } else {
        range.min + 1.0
    };
    let window = Window::new(range.min, high).unwrap();
    let projection = |of| Picture::Projection { of, window };
    let unit_mm = 4.0 * volume.geometry().smallest_spacing_mm();
    match mode {
        Mode::Iso => surface(range.at(0.45), true),
        Mode::Uncapped => surface(range.at(0.45), false),
        Mode::Mip => projection(Projection::Maximum),
        Mode::Minip => projection(Projection::Minimum),
        Mode::Mean => projection(Projection::Mean),
        Mode::Lmip => projection(Projection::LocalMaximum {
            threshold: range.at(0.5),
        }),
        Mode::Dvr => emission(&[(range.at(0.1), 0.0), (range.at(0.9), 0.5)], unit_mm),
    }
}

/// All modes of one volume from many cameras, and what is wrong with them.
struct Trial<'a> {
    device: &'a Device,
    volume: &'a Volume,
    name: String,
}

impl Trial<'_> {
    fn scene(&self, picture: Picture, camera: Camera, size: ImageSize) -> Scene {
        let mut scene = common::scene(self.volume, 1, picture);
        scene.camera = camera;
        scene.size = size;
        scene.sampling.step = StepVoxels::new(STEP_VOXELS).unwrap();
        scene
    }

    /// Renders every mode with both; gives the figures above their limits.
    fn failures(&self, cameras: &[(String, Camera, ImageSize)]) -> Vec<String> {
        let mut rows = Vec::new();
        let mut scenes = Vec::new();
        for (from, camera, size) in cameras {
            for (mode, limits) in LIMITS {
                rows.push((format!("{} from {from}: {mode:?}", self.name), *limits));
                scenes.push(self.scene(picture(*mode, self.volume), *camera, *size));
            }
        }
        let frames = on_device(self.device, self.volume, &scenes);
        let mut wrong = Vec::new();
        for (((what, limits), scene), frame) in rows.iter().zip(&scenes).zip(&frames) {
            let reference = on_reference(self.volume, scene);
            assert_sound(what, frame);
            assert_sound(what, &reference);
            for &(figure, limit) in *limits {
                let measured = figure.of(&reference, frame, self.volume);
                if measured > limit {
                    wrong.push(format!("{what}: {figure:?} {measured:.3e} > {limit}"));
                }
            }
        }
        wrong
    }
}

/// Every limit is broken by a picture moved by one pixel.
#[test]
fn the_limits_see_a_pixel() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = noise();
    let trial = Trial {
        device: &device,
        volume: &volume,
        name: "control".into(),
    };
    let camera = common::camera(&volume, common::OBLIQUE);
    let scene = |(mode, _): &(Mode, _)| trial.scene(picture(*mode, &volume), camera, size(21, 21));
    let scenes: Vec<Scene> = LIMITS.iter().map(scene).collect();
    let frames = on_device(&device, &volume, &scenes);
    for (((mode, limits), scene), frame) in LIMITS.iter().zip(&scenes).zip(&frames) {
        let reference = on_reference(&volume, scene);
        for &(figure, limit) in *limits {
            let control = figure.of(&reference, &moved_by_a_pixel(frame), &volume);
            assert!(control > limit, "{mode:?}: {figure:?} {control}");
        }
    }
}

fn size(width: u32, height: u32) -> ImageSize {
    ImageSize::new(width, height).unwrap()
}

fn report(wrong: &[String]) {
    assert!(
        wrong.is_empty(),
        "{} wrong:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

fn noise() -> Volume {
    volume_of([9, 9, 9], |x, y, z| (255.0 * hash(x, y, z)) as u8)
}
