//! Leaves taken for their average value: the optical rule keeps every pixel within its limit and the
//! rule on value ranges does not; and what changing the transfer function costs.

use crate::common;

use std::path::PathBuf;

use angioray::extent::Dims;
use angioray::frame::{Frame, STEPS, Wanted};
use angioray::gpu::Device;
use angioray::progress::Silent;
use angioray::render::{Options, Renderer};
use angioray::scene::{
    Emission, Homogeneity, HomogeneityLimit, HomogeneityRule, Knot, Phong, Picture, Quadrature,
    QuadratureMethod, Refine, Rgb, StepVoxels, Termination, TransferFile, TransferFunction,
};
use angioray::volume::{PhantomKind, PhantomSpec, ReadOptions, Volume, phantom, read};
use common::{hash, volume_of};

const SIZE_PX: u32 = 96;

fn transfer(points: &[(f64, f64)], unit_mm: f64) -> TransferFunction {
    let knot = |&(value, opacity)| Knot {
        value,
        color: Rgb([0.9, 0.6, 0.3]),
        opacity,
    };
    TransferFunction::new(points.iter().map(knot).collect(), unit_mm).unwrap()
}

fn total(counter: Option<&[u32]>) -> u64 {
    counter.into_iter().flatten().map(|&n| u64::from(n)).sum()
}

/// The largest difference of any channel of premultiplied linear light and opacity.
fn apart(a: &Frame, b: &Frame) -> f64 {
    let pairs = a.color.iter().flatten().zip(b.color.iter().flatten());
    pairs.fold(0.0, |max, (a, b)| f64::max(max, f64::from((a - b).abs())))
}

/// What homogeneous leaves do to a picture: its largest error, and the share of samples saved.
struct Change {
    error: f64,
    saved: f64,
}

fn change(
    renderer: &mut Renderer,
    volume: &Volume,
    emission: &Emission,
    homogeneity: Homogeneity,
) -> Change {
    let mut render = |homogeneity| {
        let picture = Picture::Emission(Emission {
            homogeneity,
            ..emission.clone()
        });
        let mut scene = common::scene(volume, SIZE_PX, picture);
        scene.sampling.step = StepVoxels::new(0.25).unwrap();
        renderer.render(&scene, Wanted::ALL).unwrap().frame
    };
    let (plain, taken) = (render(None), render(Some(homogeneity)));
    common::assert_sound("homogeneous", &taken);
    let [before, after] = [&plain, &taken].map(|frame| total(frame.plane(STEPS)) as f64);
    Change {
        error: apart(&plain, &taken),
        saved: 1.0 - after / before,
    }
}

/// Both rules at one limit on one volume.
fn both(device: &Device, volume: &Volume, emission: &Emission, limit: f64) -> [Change; 2] {
    let octree = common::octree(volume);
    let mut renderer = Renderer::new(device, volume, &octree, Options::default()).unwrap();
    [HomogeneityRule::Optical, HomogeneityRule::Range].map(|rule| {
        change(
            &mut renderer,
            volume,
            emission,
            Homogeneity {
                rule,
                limit: HomogeneityLimit::new(limit).unwrap(),
            },
        )
    })
}

/// The optical rule keeps its limit, also under a transfer function that changes much within a part of
/// the value range that the other rule takes for nothing; that one loses a picture.
fn check(name: &str, volume: &Volume, opaque: TransferFunction) {
    let Some(device) = common::device() else {
        return;
    };
    for quadrature in [QuadratureMethod::Simpson, QuadratureMethod::Preintegrated] {
        let emission = Emission {
            quadrature: Quadrature::of(quadrature),
            termination: Termination::NEVER,
            ..Emission::of(opaque.clone())
        };
        for limit in [0.02, 0.1] {
            let [optical, range] = both(&device, volume, &emission, limit);
            println!(
                "| {name} | {quadrature} | {limit} | {:.1e} | {:.1} % | {:.1e} | {:.1} % |",
                optical.error,
                100.0 * optical.saved,
                range.error,
                100.0 * range.saved
            );
            // Rounding is all that may come on top of the limit.
            assert!(optical.error <= limit + 1e-5, "{name}: {}", optical.error);
            assert!(range.error > 2.5 * limit, "{name}: {}", range.error);
        }
    }
}

/// Noise within a fiftieth of the range, opaque in its upper part alone.
#[test]
fn noise_under_a_step() {
    let volume = volume_of([40, 40, 40], |x, y, z| {
        let far = (x, y, z) == (0.0, 0.0, 0.0);
        if far {
            1.0
        } else {
            0.5 + 0.008 * hash(x, y, z) as f32
        }
    });
    let opaque = transfer(
        &[(0.505, 0.0), (0.5051, 0.3), (0.55, 0.3), (0.551, 0.0)],
        4.0,
    );
    check("noise", &volume, opaque);
}

fn real(file: &str) -> Option<Volume> {
    let folder = std::env::var_os("ANGIORAY_DATA").map(PathBuf::from)?;
    let path = folder.join(file);
    if !path.exists() {
        eprintln!("skipped: there is no {}", path.display());
        return None;
    }
    let mut options = ReadOptions::default();
    if file.ends_with(".raw.gz") {
        options.raw.size = Some("256x256x256".parse().unwrap());
        options.raw.element = Some("u8".parse().unwrap());
    }
    Some(read(&path, &options, &Silent).unwrap())
}

/// Faint tissue about an aneurysm, of 1 to 4 in 255.
#[test]
fn faint_values_of_a_real_angiogram() {
    let Some(volume) = real("aneurism_toxi/aneurism.raw.gz") else {
        return;
    };
    let opaque = transfer(&[(1.2, 0.0), (1.3, 0.5), (2.4, 0.5), (2.5, 0.0)], 1.0);
    check("aneurism", &volume, opaque);
}

/// Where the medium is the same all over a leaf, the optical rule does save samples.
#[test]
fn samples_are_saved_in_what_is_the_same() {
    let Some(device) = common::device() else {
        return;
    };
    let spec = PhantomSpec::new(PhantomKind::Sphere, Dims::new([64; 3]).unwrap());
    let volume = phantom(&spec).unwrap().volume;
    let range = volume.range();
    // A plateau of mist around the ball; the ball itself.
    let mist = transfer(
        &[
            (range.at(0.2), 0.01),
            (range.at(0.8), 0.1),
            (range.at(1.0), 0.1),
        ],
        4.0,
    );
    let emission = Emission {
        termination: Termination::NEVER,
        ..Emission::of(mist)
    };
    for change in both(&device, &volume, &emission, 0.01) {
        assert!(change.saved > 0.4, "{}", change.saved);
        assert!(change.error <= 0.01, "{}", change.error);
    }
    // A finer limit takes no more leaves than a coarser one; an absurd one takes them all.
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let rule = HomogeneityRule::Range;
    let mut saved = |limit| {
        change(
            &mut renderer,
            &volume,
            &emission,
            Homogeneity {
                rule,
                limit: HomogeneityLimit::new(limit).unwrap(),
            },
        )
        .saved
    };
    let (fine, coarse) = (saved(1e-6), saved(1.0));
    assert!(fine < coarse && coarse > 0.6, "{fine} {coarse}");
}

/// A picture with counters.
fn counted(
    renderer: &mut Renderer,
    volume: &Volume,
    emission: &Emission,
    homogeneity: Option<Homogeneity>,
) -> Frame {
    let picture = Picture::Emission(Emission {
        homogeneity,
        ..emission.clone()
    });
    let scene = common::scene(volume, SIZE_PX, picture);
    renderer.render(&scene, Wanted::ALL).unwrap().frame
}

/// Where a limit is so fine that no leaf keeps it nothing is averaged, and nothing costs more; where it
/// takes but a few leaves that does not cost the others their skipping.
#[test]
fn averaging_nothing_or_little_takes_no_more_samples() {
    let Some(device) = common::device() else {
        return;
    };
    let rule = HomogeneityRule::Range;
    for same in [0.0, 9.0] {
        // Thin tubes in noise; a block of one value, of so many voxels.
        let volume = volume_of([48, 44, 40], |x, y, z| {
            let tube = (x - 20.0).hypot(z - 18.0) < 2.5 || (y - 30.0).hypot(x - 35.0) < 1.5;
            if x < same && y < same && z < same {
                255
            } else {
                (if tube { 180.0 } else { 0.0 } + 40.0 * hash(x, y, z)) as u8
            }
        });
        let octree = common::octree(&volume);
        let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
        for method in QuadratureMethod::ALL {
            let emission = Emission {
                quadrature: Quadrature::of(method),
                ..Emission::of(transfer(&[(60.0, 0.0), (150.0, 0.2), (240.0, 0.5)], 2.0))
            };
            if !emission.quadrature.is_stepped() {
                continue;
            }
            let mut render = |limit: Option<f64>| {
                let homogeneity = limit.map(|limit| Homogeneity {
                    rule,
                    limit: HomogeneityLimit::new(limit).unwrap(),
                });
                counted(&mut renderer, &volume, &emission, homogeneity)
            };
            let (off, fine, coarse) = (render(None), render(Some(1e-6)), render(Some(1.0)));
            let [off_samples, fine_samples] = [&off, &fine].map(|frame| total(frame.plane(STEPS)));
            if same == 0.0 {
                assert!(fine == off, "{method}");
            } else {
                // One value averaged is that value: only sums of equal panels round.
                assert!(apart(&fine, &off) < 1e-5, "{method}");
                assert!(fine.color != off.color, "{method}: nothing is averaged");
                assert!(
                    fine_samples < off_samples,
                    "{method}: {fine_samples} {off_samples}"
                );
            }
            // The control: a coarse limit does average, and is seen.
            assert!(apart(&coarse, &off) > 0.01, "{method}");
        }
    }
}

#[test]
fn skipping_and_traversal_do_not_change_a_bit_of_it() {
    use angioray::scene::Traverse;
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume_of([37, 29, 41], |x, y, z| {
        let tube = (x - 18.0).hypot(z - 20.0) < 13.0;
        (if tube { 180.0 } else { 0.0 } + 3.0 * hash(x, y, z)) as u8
    });
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let picture = |homogeneity| {
        Picture::Emission(Emission {
            homogeneity,
            ..Emission::of(transfer(&[(20.0, 0.0), (160.0, 0.2), (220.0, 0.4)], 2.0))
        })
    };
    let homogeneity = Homogeneity {
        rule: HomogeneityRule::Range,
        limit: HomogeneityLimit::new(0.05).unwrap(),
    };
    let mut render = |homogeneity, skip, traverse| {
        let mut scene = common::scene(&volume, 72, picture(homogeneity));
        scene.sampling.skip = skip;
        scene.sampling.traverse = traverse;
        renderer.render(&scene, Wanted::NONE).unwrap().frame.color
    };
    let whole = render(Some(homogeneity), false, Traverse::Uniform);
    for traverse in [
        Traverse::Uniform,
        Traverse::KdRestart,
        Traverse::Hierarchical,
        Traverse::Revelles,
        Traverse::Distance,
    ] {
        assert!(
            render(Some(homogeneity), true, traverse) == whole,
            "{traverse:?}"
        );
    }
    assert!(render(None, true, Traverse::Uniform) != whole);
}

#[test]
fn shading_and_the_adaptive_rule_are_refused() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume_of([5, 5, 5], |x, _, _| x as u8);
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let homogeneity = Some(Homogeneity {
        rule: HomogeneityRule::Optical,
        limit: HomogeneityLimit::new(0.1).unwrap(),
    });
    let plain = Emission {
        homogeneity,
        ..Emission::of(transfer(&[(1.0, 0.5)], 1.0))
    };
    let shaded = Emission {
        phong: Some(Phong::default()),
        ..plain.clone()
    };
    let adaptive = Emission {
        quadrature: Quadrature::of(QuadratureMethod::Adaptive),
        ..plain.clone()
    };
    for (emission, allowed) in [(plain, true), (shaded, false), (adaptive, false)] {
        let scene = common::scene(&volume, 8, Picture::Emission(emission));
        let rendered = renderer.render(&scene, Wanted::NONE);
        assert_eq!(
            rendered.map_err(|e| e.exit_code()).err(),
            (!allowed).then_some(2)
        );
    }
}

#[test]
fn another_transfer_function_uploads_tables_and_no_voxels() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume_of([70, 80, 90], |x, y, z| (255.0 * hash(x, y, z)) as u8);
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let uploaded = |renderer: &mut Renderer, preset: &str| {
        let file = TransferFile::named(preset).unwrap();
        let transfer = file.transfer_function(volume.range()).unwrap();
        let scene = common::scene(&volume, 8, Picture::Emission(Emission::of(transfer)));
        let rendering = renderer.render(&scene, Wanted::NONE).unwrap();
        assert_eq!(
            rendering.classify_ms > 0.0,
            rendering.uploaded_bytes > 10_000
        );
        rendering.uploaded_bytes
    };
    let voxels = volume.voxels().bytes().len() as u64;
    let first = uploaded(&mut renderer, "3dra");
    let second = uploaded(&mut renderer, "mra");
    assert!(first > voxels, "{first}");
    // A byte a node, a bit a cell, and the knots.
    let cells: u64 = volume.dims().cells().map(u64::from).iter().product();
    let min = octree.ranges().len() as u64 + cells / 8;
    assert!(
        (min..min + 10_000).contains(&second) && second < voxels / 5,
        "{second}"
    );
    // And nothing again for the same one, nor for the one before it, until they are forgotten.
    for preset in ["mra", "3dra", "mra"] {
        assert!(uploaded(&mut renderer, preset) < 10_000, "{preset}");
    }
    renderer.forget_classes();
    assert!(uploaded(&mut renderer, "mra") > min);
    // The oldest of many is forgotten too: its memory is another's.
    let held = |renderer: &mut Renderer, iso: f64| {
        let surface = Picture::Surface {
            iso,
            caps: true,
            refine: Refine::default(),
            color: Rgb([1.0; 3]),
            phong: None,
        };
        let scene = common::scene(&volume, 8, surface);
        let rendering = renderer.render(&scene, Wanted::NONE).unwrap();
        (rendering.device_bytes, rendering.classify_ms > 0.0)
    };
    let bytes: Vec<u64> = (0..12)
        .map(|n| held(&mut renderer, 20.5 + f64::from(n)).0)
        .collect();
    assert!(bytes[3] > bytes[0] && bytes[8] == bytes[11], "{bytes:?}");
    assert_eq!(
        [11, 0].map(|n| held(&mut renderer, 20.5 + f64::from(n)).1),
        [false, true]
    );
}
