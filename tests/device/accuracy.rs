//! The device against the double-precision reference: every phantom, and real angiograms where
//! `ANGIORAY_DATA` names their folder. Prints the table of docs/accuracy.md, a row a volume (in brackets:
//! fixed steps alone):
//!
//! `cargo nextest run --test device --no-capture accuracy:: | grep '|'`

use crate::common;

use angioray::extent::Dims;
use angioray::frame::error::{DepthError, color_error, depth_error, value_error};
use angioray::frame::{Frame, Wanted};
use angioray::progress::Silent;
use angioray::reference;
use angioray::render::{Options, Renderer};
use angioray::scene::{
    Emission, Picture, Projection, Refine, Rgb, Scene, StepVoxels, TransferFile, Window,
};
use angioray::volume::{PhantomKind, PhantomSpec, Volume, phantom};

const SIZE_PX: u32 = 256;

/// Iso at step 0.5, regula falsi: 99 % of depths within this many voxels of the reference's.
const DEPTH_P99_VOXELS: f64 = 0.01;
/// Mip at step 0.25: the mean error as a share of the value range.
const MIP_MEAN: f64 = 0.002;
/// Dvr at step 0.25: the largest error of any channel of any pixel, sRGB-encoded.
const DVR_MAX: f64 = 2.0 / 255.0;

/// One volume on the device and on the reference.
struct Subject<'a> {
    name: &'a str,
    volume: &'a Volume,
    renderer: Renderer<'a>,
}

impl Subject<'_> {
    /// From where the ramp is not all cap.
    fn scene(&self, picture: Picture, step_voxels: f64) -> Scene {
        let mut scene = common::scene(self.volume, SIZE_PX, picture);
        scene.camera = common::camera(self.volume, -common::OBLIQUE);
        scene.sampling.step = StepVoxels::new(step_voxels).unwrap();
        scene
    }

    fn reference(&self, scene: &Scene) -> Frame {
        reference::render(self.volume, scene, Wanted::ALL, &Silent).unwrap()
    }

    fn frame(&mut self, scene: &Scene) -> Frame {
        self.renderer.render(scene, Wanted::ALL).unwrap().frame
    }

    /// Isosurface at step 0.5: as it is by default, and with fixed steps alone.
    fn surface(&mut self, iso: f64) -> (DepthError, DepthError) {
        let picture = |refine| Picture::Surface {
            iso,
            caps: true,
            refine,
            color: Rgb([0.9; 3]),
            phong: None,
        };
        let voxel_mm = self.volume.geometry().smallest_spacing_mm();
        let mut scene = self.scene(picture(Refine::default()), 0.5);
        let reference = self.reference(&scene);
        let mut error =
            |scene: &Scene| depth_error(&reference, &self.frame(scene), voxel_mm).unwrap();
        let probed = error(&scene);
        scene.sampling.probe = false;
        let plain = error(&scene);
        scene.picture = picture("none".parse().unwrap());
        let unrefined = error(&scene);
        let name = self.name;
        assert!(probed.compared > 0, "{name}: the iso value hits nothing");
        assert!(
            probed.p99.unwrap() <= DEPTH_P99_VOXELS,
            "{name}: {probed:?}"
        );
        assert!(
            unrefined.p99.unwrap() > DEPTH_P99_VOXELS,
            "{name}: the limit sees nothing"
        );
        (probed, plain)
    }

    /// Mean error of the maximum at step 0.25 as a share of the range: as it is by default, and
    /// with fixed steps alone.
    fn maximum(&mut self) -> (f64, f64) {
        let range = self.volume.range();
        let picture = |of| Picture::Projection {
            of,
            window: Window::new(range.min, range.max).unwrap(),
        };
        let mut scene = self.scene(picture(Projection::Maximum), 0.25);
        let reference = self.reference(&scene);
        let mut error = |scene: &Scene| {
            let error = value_error(&reference, &self.frame(scene), range.width()).unwrap();
            error.mean.unwrap()
        };
        let probed = error(&scene);
        scene.sampling.probe = false;
        let plain = error(&scene);
        scene.picture = picture(Projection::Mean);
        let mean = error(&scene);
        let name = self.name;
        assert!(probed <= MIP_MEAN, "{name}: {probed}");
        assert!(mean > MIP_MEAN, "{name}: the limit sees nothing");
        (probed, plain)
    }

    /// The largest colour error under the default transfer function at step 0.25.
    fn emission(&mut self) -> f64 {
        let preset = TransferFile::named(TransferFile::DEFAULT_PRESET).unwrap();
        let picture = Picture::Emission(Emission::of(
            preset.transfer_function(self.volume.range()).unwrap(),
        ));
        let mut scene = self.scene(picture, 0.25);
        let reference = self.reference(&scene);
        let mut error = |scene: &Scene| color_error(&reference, &self.frame(scene)).unwrap().max;
        let fine = error(&scene);
        scene.sampling.step = StepVoxels::new(8.0).unwrap();
        let coarse = error(&scene);
        let name = self.name;
        assert!(fine <= DVR_MAX, "{name}: {fine}");
        assert!(coarse > DVR_MAX, "{name}: the limit sees nothing");
        fine
    }
}

/// Renders the volume in three modes, keeps the limits, prints its row.
fn check(name: &str, volume: &Volume, iso: f64) {
    let Some(device) = common::device() else {
        return;
    };
    let octree = common::octree(volume);
    let renderer = Renderer::new(&device, volume, &octree, Options::default()).unwrap();
    let mut subject = Subject {
        name,
        volume,
        renderer,
    };
    let (surface, plain_surface) = subject.surface(iso);
    let (maximum, plain_maximum) = subject.maximum();
    let emission = subject.emission();
    println!(
        "| {name} | {} | {} ({}) | {} ({}) | {:.5} ({:.5}) | {:.4} % ({:.4} %) | {:.2} |",
        surface.reference_hits,
        surface.missed,
        plain_surface.missed,
        surface.extra,
        plain_surface.extra,
        surface.p99.unwrap(),
        plain_surface.p99.unwrap(),
        maximum * 100.0,
        plain_maximum * 100.0,
        emission * 255.0
    );
}

fn check_phantom(kind: PhantomKind) {
    let n = match kind {
        PhantomKind::Voxel => 12, // enough pixels for the one voxel
        _ => u64::from(kind.default_size()).min(64),
    };
    let spec = PhantomSpec::new(kind, Dims::new([n, n, n]).unwrap());
    let volume = phantom(&spec).unwrap().volume;
    check(kind.name(), &volume, spec.values().at(0.5));
}

fn check_real(name: &str, file: &str, iso: f64) {
    if let Some(volume) = common::real_volume(file) {
        check(name, &volume, iso);
    }
}

#[test]
fn sphere() {
    check_phantom(PhantomKind::Sphere);
}

#[test]
fn slab() {
    check_phantom(PhantomKind::Slab);
}

#[test]
fn ramp() {
    check_phantom(PhantomKind::Ramp);
}

#[test]
fn gaussian() {
    check_phantom(PhantomKind::Blob);
}

#[test]
fn marschner_lobb() {
    check_phantom(PhantomKind::MarschnerLobb);
}

#[test]
fn voxel() {
    check_phantom(PhantomKind::Voxel);
}

#[test]
fn noise() {
    check_phantom(PhantomKind::Noise);
}

#[test]
fn vessels() {
    check_phantom(PhantomKind::Vessels);
}

#[test]
fn real_aneurism() {
    check_real("aneurism", common::ANEURISM, 50.0);
}

#[test]
fn real_ct_avm() {
    check_real("CT_AVM", common::CT_AVM, 150.0);
}

#[test]
fn real_chris_mra() {
    check_real("chris_MRA", common::CHRIS_MRA, 80.0);
}

#[test]
fn real_aorta() {
    check_real("aorta", common::AORTA, 900.0);
}

#[test]
fn real_stent() {
    check_real("stent", common::STENT, 350.0);
}
