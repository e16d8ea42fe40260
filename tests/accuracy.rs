//! The device against the double-precision reference: every phantom, and real angiograms where
//! `ANGIORAY_DATA` names their folder. Prints the README's table, a row a volume:
//!
//! `cargo nextest run --test accuracy --no-capture | grep '|'`

mod common;

use std::path::PathBuf;

use angioray::extent::Dims;
use angioray::frame::error::{color_error, depth_error, value_error};
use angioray::frame::{Frame, Wanted};
use angioray::gpu::Device;
use angioray::progress::Silent;
use angioray::reference;
use angioray::render::{Options, Renderer};
use angioray::scene::{
    Knot, Phong, Picture, Projection, Refine, RefineMethod, Rgb, Scene, TransferFunction, Window,
};
use angioray::volume::{PhantomKind, PhantomSpec, ReadOptions, Volume, phantom, read};

const SIZE_PX: u32 = 256;

/// Iso at step 0.5, regula falsi: 99 % of depths within this many voxels of the reference's.
const DEPTH_P99_VOXELS: f64 = 0.01;
/// Mip at step 0.25: the mean error as a share of the value range.
const MIP_MEAN: f64 = 0.002;
/// Dvr at step 0.25: the largest error of any channel of any pixel, sRGB-encoded.
const DVR_MAX: f64 = 2.0 / 255.0;

/// Colour and opacity rise gently over the upper part of the range, as for contrast-filled vessels.
fn transfer(volume: &Volume) -> TransferFunction {
    let knot = |at: f64, [r, g, b]: [f64; 3], opacity: f64| Knot {
        value: volume.range().at(at),
        color: Rgb::from_srgb([r, g, b]),
        opacity,
    };
    let knots = vec![
        knot(0.15, [0.4, 0.05, 0.05], 0.0),
        knot(0.4, [0.8, 0.25, 0.15], 0.15),
        knot(0.7, [1.0, 0.8, 0.6], 0.5),
        knot(1.0, [1.0, 1.0, 0.95], 0.8),
    ];
    TransferFunction::new(knots, 1.0).unwrap()
}

/// One picture of a volume on the device and on the reference.
struct Judge<'a> {
    volume: &'a Volume,
    renderer: Renderer<'a>,
}

impl Judge<'_> {
    fn frames(&mut self, scene: &Scene) -> (Frame, Frame) {
        let wanted = Wanted::ALL;
        let truth = reference::render(self.volume, scene, wanted, &Silent).unwrap();
        (truth, self.renderer.render(scene, wanted).unwrap().frame)
    }

    fn device(&mut self, scene: &Scene) -> Frame {
        self.renderer.render(scene, Wanted::ALL).unwrap().frame
    }
}

/// Renders the volume in three modes, prints its row, keeps the limits.
fn judge(name: &str, volume: &Volume, iso: f64) {
    let Some(device) = common::device() else {
        return;
    };
    judge_on(&device, name, volume, iso);
}

fn judge_on(device: &Device, name: &str, volume: &Volume, iso: f64) {
    let octree = common::octree(volume);
    let renderer = Renderer::new(device, volume, &octree, Options::default()).unwrap();
    let mut judge = Judge { volume, renderer };
    let voxel_mm = volume.geometry().smallest_spacing_mm();

    let surface = |refine| Picture::Surface {
        iso,
        caps: true,
        refine,
        color: Rgb([0.9; 3]),
        phong: Some(Phong::default()),
    };
    let mut scene = common::scene(volume, SIZE_PX, surface(Refine::default()));
    scene.sampling.step_voxels = 0.5;
    let (truth, frame) = judge.frames(&scene);
    let depth = depth_error(&truth, &frame, voxel_mm).unwrap();
    scene.picture = surface(Refine {
        method: RefineMethod::None,
        iterations: 0,
    });
    let unrefined = depth_error(&truth, &judge.device(&scene), voxel_mm).unwrap();

    let window = Window::new(volume.range().min, volume.range().max).unwrap();
    scene.picture = Picture::Projection {
        of: Projection::Maximum,
        window,
    };
    scene.sampling.step_voxels = 0.25;
    let (truth, frame) = judge.frames(&scene);
    let mip = value_error(&truth, &frame, volume.range().width()).unwrap();

    scene.picture = Picture::Emission {
        transfer: transfer(volume),
        phong: None,
        termination: 0.999,
    };
    let (truth, frame) = judge.frames(&scene);
    let dvr = color_error(&truth, &frame).unwrap();
    scene.sampling.step_voxels = 8.0;
    let coarse = color_error(&truth, &judge.device(&scene)).unwrap();

    let voxels = |figure: Option<f64>| figure.map_or("–".into(), |v| format!("{v:.5}"));
    println!(
        "| {name} | {} | {} | {} | {} | {} | {:.4} % | {:.3} / 255 |",
        depth.reference_hits,
        depth.missed,
        depth.extra,
        voxels(depth.p99),
        voxels(depth.max),
        mip.mean.unwrap() * 100.0,
        dvr.max * 255.0
    );

    assert!(
        depth.reference_hits > 0,
        "{name}: the iso value hits nothing"
    );
    assert!(depth.p99.unwrap() <= DEPTH_P99_VOXELS, "{name}: {depth:?}");
    assert!(mip.mean.unwrap() <= MIP_MEAN, "{name}: {mip:?}");
    assert!(dvr.max <= DVR_MAX, "{name}: {dvr:?}");
    // Each limit is one that a worse setting breaks.
    assert!(
        unrefined.p99.unwrap() > DEPTH_P99_VOXELS,
        "{name}: {unrefined:?}"
    );
    assert!(coarse.max > DVR_MAX, "{name}: {coarse:?}");
}

fn judge_phantom(kind: PhantomKind) {
    let n = u64::from(kind.default_size()).min(64);
    let spec = PhantomSpec::new(kind, Dims::new([n, n, n]).unwrap());
    let volume = phantom(&spec).unwrap().volume;
    judge(kind.name(), &volume, spec.values().at(0.5));
}

fn judge_real(name: &str, file: &str, iso: f64) {
    let Some(folder) = std::env::var_os("ANGIORAY_DATA").map(PathBuf::from) else {
        eprintln!("skipped: ANGIORAY_DATA does not name a folder of real volumes");
        return;
    };
    let path = folder.join(file);
    if !path.exists() {
        eprintln!("skipped: there is no {}", path.display());
        return;
    }
    let mut options = ReadOptions::default();
    if file.ends_with(".raw.gz") {
        options.raw.size = Some("256x256x256".parse().unwrap());
        options.raw.element = Some("u8".parse().unwrap());
    }
    let volume = read(&path, &options, &Silent).unwrap();
    judge(name, &volume, iso);
}

#[test]
fn sphere() {
    judge_phantom(PhantomKind::Sphere);
}

#[test]
fn slab() {
    judge_phantom(PhantomKind::Slab);
}

#[test]
fn ramp() {
    judge_phantom(PhantomKind::Ramp);
}

#[test]
fn gaussian() {
    judge_phantom(PhantomKind::Blob);
}

#[test]
fn marschner_lobb() {
    judge_phantom(PhantomKind::MarschnerLobb);
}

#[test]
fn voxel() {
    judge_phantom(PhantomKind::Voxel);
}

#[test]
fn noise() {
    judge_phantom(PhantomKind::Noise);
}

#[test]
fn vessels() {
    judge_phantom(PhantomKind::Vessels);
}

#[test]
fn real_aneurism() {
    judge_real("aneurism", "aneurism_toxi/aneurism.raw.gz", 50.0);
}

#[test]
fn real_ct_avm() {
    judge_real("CT_AVM", "niivue_CT_AVM/CT_AVM.nii.gz", 150.0);
}

#[test]
fn real_chris_mra() {
    judge_real("chris_MRA", "niivue_chris_MRA/chris_MRA.nii.gz", 80.0);
}

#[test]
fn real_aorta() {
    judge_real("aorta", "vmtk_aorta/aorta.mha", 900.0);
}

#[test]
fn real_stent() {
    judge_real("stent", "stent_npz/stent.npz", 350.0);
}
