//! Exact sampling against the double-precision reference: no hit missed, none invented, what is
//! proven is true, and every projected value to single precision. On every phantom, on white noise,
//! on volumes of few values, and on real angiograms where `ANGIORAY_DATA` names their folder.
//!
//! `cargo nextest run --test device --no-capture exact:: | grep '|'` prints what is measured.

use crate::common;

use angioray::extent::Dims;
use angioray::frame::error::{depth_error, value_error};
use angioray::frame::{CERTIFICATE, Certificate, DEPTH, Frame, VALUE, Wanted};
use angioray::lab::measure::{Borderline, Closeness, excuse_dips};
use angioray::progress::Silent;
use angioray::reference;
use angioray::render::{Options, Renderer};
use angioray::scene::{Filter, Picture, Projection, Refine, Rgb, SamplingMethod, Scene, Window};
use angioray::volume::{PhantomKind, PhantomSpec, Volume, phantom};
use common::{hash, volume_of};

const SIZE_PX: u32 = 192;

/// 99.9 % of depths within this many voxels of the reference's.
const DEPTH_P999_VOXELS: f64 = 1e-3;
/// The largest error of a projected value, as a share of the value range.
const VALUE_MAX: f64 = 2e-6;
/// Pixels of which nothing is proven, as a share of all, on real data.
const UNDECIDED: f64 = 1e-4;

/// Pixels of lmip that may differ: there a ray's first local maximum is followed by a dip of less
/// than a millionth of its cell's spread in slope, which single precision cannot distinguish from 0.
const SHALLOW_DIPS: usize = 2;

/// A volume under test.
struct Subject<'a> {
    name: &'a str,
    volume: &'a Volume,
    renderer: Renderer<'a>,
    filter: Filter,
}

/// The errors of a surface's picture.
#[derive(Debug)]
struct Wrong {
    missed: u64,
    extra: u64,
    p999: f64,
    max: f64,
    undecided: f64,
    /// Proven, and not so.
    disproven: usize,
}

impl Subject<'_> {
    fn scene(&self, picture: Picture, method: SamplingMethod) -> Scene {
        let mut scene = common::scene(self.volume, SIZE_PX, picture);
        scene.camera = common::camera(self.volume, -common::OBLIQUE);
        scene.sampling.method = method;
        scene.sampling.filter = self.filter;
        scene
    }

    fn both(&mut self, scene: &Scene) -> (Frame, Frame) {
        let reference = reference::render(self.volume, scene, Wanted::ALL, &Silent).unwrap();
        let frame = self.renderer.render(scene, Wanted::ALL).unwrap().frame;
        common::assert_sound(self.name, &frame);
        (reference, frame)
    }

    /// The scene of a surface, the reference's picture of it and the device's.
    fn surface(&mut self, iso: f64, caps: bool, method: SamplingMethod) -> (Scene, Frame, Frame) {
        let picture = Picture::Surface {
            iso,
            caps,
            refine: Refine::default(),
            color: Rgb([0.9; 3]),
            phong: None,
        };
        let scene = self.scene(picture, method);
        let (reference, frame) = self.both(&scene);
        (scene, reference, frame)
    }

    fn wrong(&mut self, iso: f64, caps: bool) -> Wrong {
        let (scene, reference, mut frame) = self.surface(iso, caps, SamplingMethod::Exact);
        let disproven = disproven(&reference, &frame);
        let undecided = frame.undecided().unwrap() as f64 / frame.size.pixels() as f64;
        Borderline::new(self.volume, &scene, Closeness::Exact)
            .unwrap()
            .excuse(&reference, &mut frame);
        let voxel_mm = self.volume.geometry().smallest_spacing_mm();
        let error = depth_error(&reference, &frame, voxel_mm).unwrap();
        let depths = reference
            .plane(DEPTH)
            .into_iter()
            .flatten()
            .zip(frame.plane(DEPTH).into_iter().flatten());
        let mut differences: Vec<f64> = depths
            .filter(|(a, b)| a.is_finite() && b.is_finite())
            .map(|(&a, &b)| (f64::from(a) - f64::from(b)).abs() / voxel_mm)
            .collect();
        assert!(!differences.is_empty(), "{}: nothing is hit", self.name);
        differences.sort_by(f64::total_cmp);
        Wrong {
            missed: error.missed,
            extra: error.extra,
            p999: differences[(differences.len() * 999).div_ceil(1000) - 1],
            max: error.max.unwrap(),
            undecided,
            disproven,
        }
    }

    /// The largest error of a projected value, as a share of the range.
    fn projection(&mut self, of: Projection, method: SamplingMethod) -> f64 {
        let range = self.volume.range();
        let window = Window::new(range.min, range.max).unwrap();
        let scene = self.scene(Picture::Projection { of, window }, method);
        let (reference, mut frame) = self.both(&scene);
        let local = matches!(of, Projection::LocalMaximum { .. });
        if local && method == SamplingMethod::Exact {
            let references = reference.plane(VALUE).unwrap();
            let own = frame.plane_mut(VALUE).unwrap();
            let close = VALUE_MAX * range.width();
            excuse_dips(self.volume, &scene, references, own, close).unwrap();
            let wrong = |(a, b): (&f32, &f32)| f64::from((a - b).abs()) > close;
            let pixels = references
                .iter()
                .zip(&*own)
                .filter(|&(a, b)| wrong((a, b)))
                .count();
            assert!(pixels <= SHALLOW_DIPS, "{}: {pixels} pixels", self.name);
            if pixels > 0 {
                own.copy_from_slice(references);
            }
        }
        let error = value_error(&reference, &frame, range.width()).unwrap();
        assert_eq!((error.missed, error.extra), (0, 0));
        error.max.unwrap()
    }
}

/// Pixels whose certificate says what is not so.
fn disproven(reference: &Frame, frame: &Frame) -> usize {
    let certificates = frame.plane(CERTIFICATE).into_iter().flatten();
    certificates
        .zip(reference.plane(CERTIFICATE).into_iter().flatten())
        .filter(|&(&own, &true_one)| own != Certificate::Undecided as u32 && own != true_one)
        .count()
}

/// Checks surfaces (with and without caps) and projections against their limits, and prints rows.
fn check(name: &str, volume: &Volume, iso: f64, filter: Filter) -> Option<Outcome> {
    let device = common::device()?;
    let octree = common::octree(volume);
    let renderer = Renderer::new(&device, volume, &octree, Options::default()).unwrap();
    let mut subject = Subject {
        name,
        volume,
        renderer,
        filter,
    };
    let threshold = volume.range().at(0.6);
    let projections = [
        Projection::Maximum,
        Projection::Minimum,
        Projection::Mean,
        Projection::LocalMaximum { threshold },
    ];
    let mut undecided: f64 = 0.0;
    for caps in [true, false] {
        let exact = subject.wrong(iso, caps);
        println!(
            "| {name}, caps {caps} | {} | {} | {:.1e} | {:.1e} | {:.1e} |",
            exact.missed, exact.extra, exact.p999, exact.max, exact.undecided
        );
        assert_eq!((exact.missed, exact.extra), (0, 0), "{name}: {exact:?}");
        assert_eq!(exact.disproven, 0, "{name}: {exact:?}");
        undecided = undecided.max(exact.undecided);
        assert!(exact.p999 <= DEPTH_P999_VOXELS, "{name}: {exact:?}");
    }
    let (_, _, fixed) = subject.surface(iso, true, SamplingMethod::Fixed);
    let pixels = fixed.size.pixels() as u64;
    assert_eq!(
        fixed.undecided(),
        Some(pixels),
        "{name}: fixed steps prove nothing"
    );
    let errors = projections.map(|of| subject.projection(of, SamplingMethod::Exact));
    let [mip, minip, mean, lmip] = errors;
    println!("| {name} | mip {mip:.1e} | minip {minip:.1e} | mean {mean:.1e} | lmip {lmip:.1e} |");
    assert!(errors.iter().all(|&e| e <= VALUE_MAX), "{name}: {errors:?}");
    let fixed = projections.map(|of| subject.projection(of, SamplingMethod::Fixed));
    Some(Outcome {
        undecided,
        fixed_breaks: fixed.iter().any(|&e| e > VALUE_MAX),
    })
}

struct Outcome {
    /// The larger share, with caps and without.
    undecided: f64,
    /// Whether fixed steps break the limit of projected values.
    fixed_breaks: bool,
}

#[test]
fn phantoms() {
    let mut broken_by_fixed_steps = 0;
    for kind in PhantomKind::ALL {
        let n = match kind {
            PhantomKind::Voxel => 12, // enough pixels for the one voxel
            _ => u64::from(kind.default_size()).min(64),
        };
        let spec = PhantomSpec::new(kind, Dims::new([n, n, n]).unwrap());
        let volume = phantom(&spec).unwrap().volume;
        let iso = spec.values().at(0.5);
        let Some(outcome) = check(kind.name(), &volume, iso, Filter::Linear) else {
            return;
        };
        assert!(outcome.undecided <= UNDECIDED, "{}", kind.name());
        broken_by_fixed_steps += usize::from(outcome.fixed_breaks);
    }
    // Steps find the extrema of linear fields too.
    assert!(broken_by_fixed_steps >= 5, "{broken_by_fixed_steps}");
}

/// Checks volumes on every limit but the certificate's, which fixed steps break.
fn check_hard(name: &str, volume: &Volume, iso: f64, filter: Filter) {
    let outcome = check(name, volume, iso, filter);
    assert!(outcome.is_none_or(|outcome| outcome.fixed_breaks), "{name}");
}

#[test]
fn white_noise() {
    let volume = volume_of([40, 37, 33], |x, y, z| (255.0 * hash(x, y, z)) as u8);
    check_hard("white noise", &volume, 127.5, Filter::Linear);
}

/// Surfaces that are plateaus, ridges and single points.
#[test]
fn few_values_and_the_iso_value_one_of_them() {
    let volume = volume_of([31, 33, 29], |x, y, z| (4.0 * hash(x, y, z)) as u8);
    check_hard("few values", &volume, 2.0, Filter::Linear);
}

/// The device's iso value is 2, a plateau's; the requested one is beyond it.
#[test]
fn an_iso_value_between_two_floats() {
    let volume = volume_of([31, 33, 29], |x, y, z| (4.0 * hash(x, y, z)) as u8);
    let Some(device) = common::device() else {
        return;
    };
    let octree = common::octree(&volume);
    let renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut subject = Subject {
        name: "between floats",
        volume: &volume,
        renderer,
        filter: Filter::Linear,
    };
    let (_, reference, frame) = subject.surface(2.0 + 1e-9, true, SamplingMethod::Exact);
    // Rounded, it is hit where the other is not; nothing of that is called proven.
    assert!(depth_error(&reference, &frame, 1.0).unwrap().extra > 0);
    assert_eq!(disproven(&reference, &frame), 0);
}

#[test]
fn floats_of_mixed_signs() {
    let volume = volume_of([24, 25, 26], |x, y, z| {
        (1e-3 * (2.0 * hash(x, y, z) - 1.0)) as f32
    });
    check_hard("mixed signs", &volume, 1.25e-5, Filter::Linear);
}

#[test]
fn the_nearest_filter() {
    let volume = volume_of([17, 24, 9], |x, y, z| (255.0 * hash(x, y, z)) as u8);
    check_hard("nearest", &volume, 127.5, Filter::Nearest);
}

#[test]
fn one_voxel_along_an_axis() {
    let volume = volume_of([33, 1, 29], |x, y, z| (255.0 * hash(x, y, z)) as u8);
    check_hard("sheet", &volume, 127.5, Filter::Linear);
}

fn check_real(name: &str, file: &str, iso: f64) {
    let Some(volume) = common::real_volume(file) else {
        return;
    };
    let outcome = check(name, &volume, iso, Filter::Linear);
    assert!(outcome.is_none_or(|o| o.fixed_breaks && o.undecided <= UNDECIDED));
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
