//! Volumes: cases 22 to 26.

use angioray::frame::{Frame, KIND, Wanted};
use angioray::lab::hardcases::{HardCase, orientation_of};
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::render::{Options, Renderer};
use angioray::scene::{
    Emission, Knot, Picture, Projection, Rgb, Scene, Termination, TransferFunction, Window,
};
use angioray::volume::{Geometry, NonFinite, ReadOptions, Rescale, Volume, Voxels, read};
use glam::{DMat3, DVec3};

use crate::common::Figure::{AlphaMax, ColorMean, DepthMean, Kind, NormalMean, ValueMax};
use crate::common::{self, Figure, on_reference};
use crate::mutant::{Mutant, NEVER_ABOVE, assert_caught, is_mutant, kernel};
use crate::trial::{Seen, check, is, near, resolved};

pub const CASES: &[&str] = &[
    "sizes",
    "constant",
    "types",
    "non-finite",
    "orientations",
    "wide-index",
    "clip-planes",
];

/// Like `volume`, with other voxels.
fn with_voxels(volume: &Volume, voxels: Vec<f32>) -> Volume {
    let (dims, geometry) = (volume.dims(), *volume.geometry());
    Volume::new(
        dims,
        Voxels::from(voxels),
        geometry,
        Rescale::IDENTITY,
        NonFinite::Refuse,
    )
    .unwrap()
}

#[test]
fn sizes() {
    // An axis with one voxel has no extent.
    let flat = kernel(
        "lib/ray/ray.clh",
        &[
            ("return n == 1u ? -0.5f : 0.0f;", "return 0.0f;"),
            (
                "return n == 1u ? 0.5f : (float)(n - 1u);",
                "return (float)(n - 1u);",
            ),
        ],
    );
    check("volumes::sizes", "sizes", |_| Vec::new(), &[flat]);
}

#[test]
fn constant() {
    fn expected(seen: &Seen) -> Vec<String> {
        let caps = (0..seen.pixels())
            .filter(|&pixel| seen.kind(pixel) == 2)
            .count();
        match seen.name {
            "iso77" => is("the volume is closed by caps", caps > 50),
            "mip" => near("the maximum", seen.value(seen.middle()), 77.0, 0.0),
            _ => is("nothing is hit", seen.hits() == 0),
        }
    }
    let never_above = kernel("lib/find/crossing.clh", &NEVER_ABOVE);
    check("volumes::constant", "constant", expected, &[never_above]);
}

#[test]
fn types() {
    // Voxels cut to eight bits: a byte's type for all.
    let eight_bits = kernel(
        "lib/volume/voxels.clh",
        &[
            (
                "AS_FLOATS(GATHER(Ints, voxels, i))",
                "AS_FLOATS(GATHER(Ints, voxels, i) & 0xff)",
            ),
            ("((two) & 0xffff)", "((two) & 0xff)"),
        ],
    );
    check("volumes::types", "types", |_| Vec::new(), &[eight_bits]);
}

/// Their files, written as `angioray phantom` does, give the volumes that they should.
#[test]
fn files_of_all_types_are_read_as_they_should_be() {
    if is_mutant() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut compared = 0;
    for name in ["types", "non-finite", "orientations"] {
        let (case, _) = HardCase::named(name).unwrap();
        for member in 0..case.count() {
            let made = case.volume(member).unwrap();
            let path = folder.path().join(format!("{name}-{member}.nrrd"));
            made.write(&path, member % 2 == 1).unwrap();
            let found = read(&path, &ReadOptions::default(), &Silent).unwrap();
            assert_eq!(found.dims(), made.volume.dims());
            assert_eq!(
                found.non_finite(),
                made.volume.non_finite(),
                "{name} {member}"
            );
            let physical =
                |volume: &Volume, i: usize| volume.rescale().physical(volume.voxels().stored(i));
            for i in 0..found.voxels().len() {
                let (a, b) = (physical(&found, i), physical(&made.volume, i));
                assert!((a - b).abs() <= 1e-7 * b.abs(), "{name} {member}: {a} {b}");
                compared += usize::from(a != 0.0);
            }
        }
    }
    assert!(compared > 10_000, "{compared}");
}

#[test]
fn non_finite() {
    fn expected(seen: &Seen) -> Vec<String> {
        let lowest = seen.volume.range().min;
        let mut lines = is("17 voxels are counted", seen.volume.non_finite() == 17);
        lines.extend(is("they are the smallest finite value", lowest < -40.0));
        lines
    }
    // Read as 0.
    let as_zero = Mutant::Volume(|volume| {
        let lowest = volume.range().min;
        let rescale = volume.rescale();
        let voxels = (0..volume.voxels().len()).map(|i| {
            let value = rescale.physical(volume.voxels().stored(i));
            if value == lowest { 0.0 } else { value as f32 }
        });
        with_voxels(volume, voxels.collect())
    });
    check("volumes::non_finite", "non-finite", expected, &[as_zero]);
}

/// A surface, a maximum and an emission from the surface's camera.
fn pictures(surface: &Scene) -> [Scene; 3] {
    let knot = |value, opacity| Knot {
        value,
        color: Rgb([0.9, 0.6, 0.3]),
        opacity,
    };
    let knots = vec![knot(60.0, 0.0), knot(220.0, 0.4)];
    let emission = Emission {
        termination: Termination::NEVER,
        ..Emission::of(TransferFunction::new(knots, 2.0).unwrap())
    };
    let maximum = Picture::Projection {
        of: Projection::Maximum,
        window: Window::new(0.0, 255.0).unwrap(),
    };
    let shown = |picture| Scene {
        picture,
        ..surface.clone()
    };
    [
        surface.clone(),
        shown(maximum),
        shown(Picture::Emission(emission)),
    ]
}

/// What two pictures of the same content may differ by: rounding, and of the emission the samples'
/// places.
#[rustfmt::skip]
const SAME: [&[(Figure, f64)]; 3] = [
    &[(Kind, 0.0), (DepthMean, 1e-3), (NormalMean, 0.01), (ColorMean, 1e-4)],
    &[(Kind, 0.0), (ValueMax, 1e-4), (ColorMean, 1e-4)],
    &[(AlphaMax, 1e-2), (ColorMean, 1e-3)],
];

/// All 48 give the pictures of the first: the surface always, the others, built by the same rays, for
/// two flips an order of axes. With a geometry that does not say how they are stored these do not.
#[test]
fn orientations() {
    let Some(device) = common::device() else {
        return;
    };
    let (case, _) = HardCase::named("orientations").unwrap();
    assert_eq!(case.count(), 48);
    let first = case.volume(0).unwrap().volume;
    let (_, surface) = &resolved(case, &first)[0];
    let scenes = pictures(surface);
    let frames = |volume: &Volume, count: usize| -> Vec<Frame> {
        let octree = Octree::build(volume, Leaf::default(), &Silent).unwrap();
        let mut renderer = Renderer::new(&device, volume, &octree, Options::default()).unwrap();
        let frame = |scene| renderer.render(scene, Wanted::ALL).unwrap().frame;
        scenes[..count].iter().map(frame).collect()
    };
    let expected = frames(&first, 3);
    // The first figure above its limit, of each picture.
    let differs = |volume: &Volume, count: usize| -> Vec<Option<Figure>> {
        let frames = frames(volume, count);
        let pairs = expected.iter().zip(&frames).zip(SAME);
        let first_above = |((expected, frame), same): ((&Frame, &Frame), &[(Figure, f64)])| {
            let above =
                |&&(figure, limit): &&(Figure, f64)| figure.of(expected, frame, &first) > limit;
            same.iter().find(above).map(|(figure, _)| *figure)
        };
        pairs.map(first_above).collect()
    };
    for member in 0..case.count() {
        let stored = case.volume(member).unwrap().volume;
        let count = if [1, 6].contains(&(member % 8)) { 3 } else { 1 };
        let found = differs(&stored, count);
        assert!(
            found.iter().all(Option::is_none),
            "orientation {:?}: {found:?}",
            orientation_of(member)
        );
        if count == 3 {
            let unoriented = Geometry::new(
                DVec3::new(3.0, -4.0, 5.0),
                DMat3::IDENTITY,
                stored.geometry().spacing_mm(),
            );
            let Voxels::U8(voxels) = stored.voxels() else {
                panic!("made as u8");
            };
            let unoriented = Volume::new(
                stored.dims(),
                Voxels::from(voxels.to_vec()),
                unoriented.unwrap(),
                Rescale::IDENTITY,
                NonFinite::Refuse,
            );
            let found = differs(&unoriented.unwrap(), count);
            assert!(
                found.iter().all(Option::is_some),
                "orientation {member} left out: {found:?}"
            );
        }
    }
}

/// A voxel's linear index.
const INDEX: &str = "(AS_INDEX(z) * volume.ny + AS_INDEX(y)) * volume.nx + AS_INDEX(x)";

#[test]
fn wide_index() {
    let sixteen_bits = kernel(
        "lib/volume/voxels.clh",
        &[(
            INDEX,
            "((AS_INDEX(z) * volume.ny + AS_INDEX(y)) * volume.nx + AS_INDEX(x)) & 0xffffu",
        )],
    );
    check(
        "volumes::wide_index",
        "wide-index",
        |_| Vec::new(),
        &[sixteen_bits],
    );
    if is_mutant() {
        return;
    }
    // The control the other way: an index of 64 bits is not caught.
    let sixty_four = [(
        "typedef Uints Index;
#define AS_INDEX(number) AS_UINTS(number)",
        "#if LANES == 8
typedef ulong8 Index;
#define AS_INDEX(number) convert_ulong8(AS_UINTS(number))
#else
typedef ulong16 Index;
#define AS_INDEX(number) convert_ulong16(AS_UINTS(number))
#endif",
    )];
    let caught = std::panic::catch_unwind(|| {
        assert_caught("volumes::wide_index", "lib/volume/voxels.clh", &sixty_four);
    });
    assert!(caught.is_err(), "64 bits change the picture");
}

#[test]
fn clip_planes() {
    fn expected(seen: &Seen) -> Vec<String> {
        let hits = seen.hits();
        if seen.name.starts_with("nothing-left") {
            return is("nothing is left", hits == 0);
        }
        let mut lines = is("something is hit", hits > 20);
        // What is hit is on the kept side.
        for pixel in (0..seen.pixels()).filter(|&pixel| seen.kind(pixel) != 0) {
            let ray = seen.ray(pixel);
            let at = ray.origin_world + ray.dir_world * seen.depth_mm(pixel);
            for plane in &seen.scene.clip_planes {
                let normal = plane.normal_world();
                let above = (normal.dot(at) + plane.offset()) / normal.length();
                lines.extend(is("a hit is on the kept side", above > -1e-3));
            }
        }
        // One plane, written otherwise or among planes that cut nothing.
        if seen.name.starts_with("scaled") || seen.name.starts_with("many") {
            let (case, _) = HardCase::named("clip-planes").unwrap();
            let scenes = resolved(case, seen.volume);
            let (_, half) = scenes
                .iter()
                .find(|(name, _)| name.starts_with("half"))
                .unwrap();
            let expected = on_reference(seen.volume, half);
            let expected = expected.plane(KIND).unwrap();
            let same = (0..seen.pixels()).all(|pixel| expected[pixel] == seen.kind(pixel));
            lines.extend(is("the picture is that of one plane", same));
        }
        lines.truncate(3);
        lines
    }
    // Planes along the rays without effect; only the first plane of all.
    let along = kernel(
        "lib/ray/clip.clh",
        &[("& height < 0.0f", "& height < -INFINITY")],
    );
    let first = kernel(
        "lib/ray/clip.clh",
        &[("i < clip.count &&", "i < 1u && i < clip.count &&")],
    );
    check(
        "volumes::clip_planes",
        "clip-planes",
        expected,
        &[along, first],
    );
}
