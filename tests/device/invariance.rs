//! What must never change one bit of a picture: skipping, the traversal of the octree, the leaf's
//! edge, the work-group's size, how many rays a work-item follows side by side, whether voxels are in a
//! buffer or an image.

use crate::common;

use angioray::frame::{CERTIFICATE, DEPTH, Frame, KIND, NODES, NORMAL, STEPS, VALUE, Wanted};
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::render::{Lanes, Options, Renderer};
use angioray::scene::{
    ClipPlane, Emission, Filter, Knot, Phong, Picture, Projection, Quadrature, QuadratureMethod,
    Refine, Rgb, SamplingMethod, Storage, Termination, TransferFunction, Traverse, Window,
};
use angioray::volume::Volume;
use common::{hash, volume_of};
use glam::DVec3;

const SIZE_PX: u32 = 72; // not a multiple of any work-group below but 8

/// Sparse curved tubes over faint noise, a size that no node edge divides.
pub fn tubes() -> Volume {
    volume_of([45, 61, 38], |x, y, z| {
        let tube = |cx: f64, cz: f64, r: f64| {
            let d = (x - cx - 6.0 * (y * 0.11).sin()).hypot(z - cz - 4.0 * (y * 0.17).cos());
            (r + 0.5 - d).clamp(0.0, 1.0)
        };
        let bright = tube(14.0, 12.0, 2.5)
            .max(tube(30.0, 24.0, 0.6))
            .max(tube(22.0, 18.0, 1.2));
        (200.0 * bright + 9.0 * hash(x, y, z)) as u8
    })
}

fn noise() -> Volume {
    volume_of([19, 33, 26], |x, y, z| hash(x, y, z) as f32)
}

/// Both signs and sizes from 1e-4 to 1 beside each other: sums and differences round.
fn mixed() -> Volume {
    volume_of([21, 18, 33], |x, y, z| {
        let size = 10f64.powf(-4.0 * hash(y, z, x));
        ((2.0 * hash(x, y, z) - 1.0) * size) as f32
    })
}

pub fn pictures(range_max: f64) -> Vec<Picture> {
    let window = Window::new(0.0, range_max).unwrap();
    let iso = Picture::Surface {
        iso: range_max * 0.45,
        caps: true,
        refine: Refine::default(),
        color: Rgb([0.9, 0.8, 0.7]),
        phong: Some(Phong::default()),
    };
    let knot = |at: f64, grey: f64, opacity: f64| Knot {
        value: at * range_max,
        color: Rgb([grey, grey * 0.5, 0.2]),
        opacity,
    };
    let transfer = TransferFunction::new(
        vec![
            knot(0.2, 0.1, 0.0),
            knot(0.5, 0.9, 0.3),
            knot(0.8, 1.0, 0.9),
        ],
        1.0,
    )
    .unwrap();
    let emission = |phong| {
        Picture::Emission(Emission {
            phong,
            termination: Termination::new(0.99).unwrap(),
            ..Emission::of(transfer.clone())
        })
    };
    let projection = |of| Picture::Projection { of, window };
    vec![
        iso,
        projection(Projection::Maximum),
        projection(Projection::Minimum),
        projection(Projection::Mean),
        projection(Projection::LocalMaximum {
            threshold: range_max * 0.5,
        }),
        emission(None),
        emission(Some(Phong::default())),
    ]
}

/// The planes that make up the picture: all but the counters.
pub fn picture_bits(frame: &Frame) -> Vec<u32> {
    let bits = |v: &f32| v.to_bits();
    let mut all: Vec<u32> = frame.color.iter().flatten().map(bits).collect();
    all.extend(frame.display.iter().flatten().flatten().map(bits));
    all.extend(frame.plane(DEPTH).into_iter().flatten().map(bits));
    all.extend(
        frame
            .plane(NORMAL)
            .into_iter()
            .flatten()
            .flatten()
            .map(bits),
    );
    all.extend(frame.plane(VALUE).into_iter().flatten().map(bits));
    all.extend(frame.plane(KIND).into_iter().flatten());
    all.extend(frame.plane(CERTIFICATE).into_iter().flatten());
    all
}

fn total(counter: Option<&[u32]>) -> u64 {
    counter.into_iter().flatten().map(|&n| u64::from(n)).sum()
}

/// Renders every picture with both filters, by steps and exactly where it can be, under one method of
/// skipping; in a fixed order.
fn all_frames(
    renderer: &mut Renderer,
    volume: &Volume,
    skip: bool,
    traverse: Traverse,
) -> Vec<(String, Frame)> {
    let mut frames = Vec::new();
    for picture in pictures(volume.range().max) {
        let integrated = matches!(picture, Picture::Emission { .. });
        for (filter, method) in [
            (Filter::Linear, SamplingMethod::Fixed),
            (Filter::Nearest, SamplingMethod::Fixed),
            (Filter::Linear, SamplingMethod::Exact),
            (Filter::Nearest, SamplingMethod::Exact),
        ] {
            if integrated && method == SamplingMethod::Exact {
                continue;
            }
            let mut scene = common::scene(volume, SIZE_PX, picture.clone());
            scene.sampling.filter = filter;
            scene.sampling.method = method;
            scene.sampling.skip = skip;
            scene.sampling.traverse = traverse;
            let frame = renderer.render(&scene, Wanted::ALL).unwrap().frame;
            frames.push((format!("{} {filter:?} {method:?}", picture.mode()), frame));
        }
    }
    frames
}

#[test]
fn skipping_and_traversal_never_change_a_bit() {
    let Some(device) = common::device() else {
        return;
    };
    let cases: [(&str, Volume, &[u32]); 3] = [
        ("tubes", tubes(), &[4, 5]),
        ("noise", noise(), &[4]),
        ("mixed", mixed(), &[4]),
    ];
    for (name, volume, leaves) in cases {
        let mut whole = Vec::new();
        for &leaf in leaves {
            let octree = Octree::build(&volume, Leaf::new(leaf).unwrap(), &Silent).unwrap();
            let mut renderer =
                Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
            if whole.is_empty() {
                whole = all_frames(&mut renderer, &volume, false, Traverse::Uniform);
                for (what, frame) in &whole {
                    assert!(
                        frame.color.iter().any(|c| c[3] > 0.0),
                        "{name} {what}: nothing to see"
                    );
                    assert_eq!(total(frame.plane(NODES)), 0);
                }
            }
            let mut node_counts = Vec::new();
            for traverse in Traverse::ALL {
                let skipped = all_frames(&mut renderer, &volume, true, traverse);
                for ((what, whole), (_, skipped)) in whole.iter().zip(&skipped) {
                    let what = format!("{name} {what} leaf {leaf} {traverse:?}");
                    assert!(picture_bits(skipped) == picture_bits(whole), "{what}");
                    let skips = !what.contains("mean");
                    assert_eq!(total(skipped.plane(NODES)) > 0, skips, "{what}");
                    if name == "tubes" && skips && !what.contains("minip") {
                        // Skipping is real.
                        assert!(
                            total(skipped.plane(STEPS)) < total(whole.plane(STEPS)),
                            "{what}"
                        );
                    }
                }
                node_counts.push(total(skipped[0].1.plane(NODES)));
            }
            // The counters distinguish the traversals, where there are nodes to skip.
            node_counts.sort_unstable();
            node_counts.dedup();
            let all = node_counts.len() == Traverse::ALL.len();
            assert!(all || name != "tubes", "{name} leaf {leaf}");
        }
    }
}

/// Every rule for the light along a ray, each filter, on tubes with a spike of a transfer function.
#[test]
fn skipping_never_changes_a_bit_under_any_quadrature() {
    let Some(device) = common::device() else {
        return;
    };
    let knot = |value: f64, opacity: f64| Knot {
        value,
        color: Rgb([0.9, opacity, 0.2]),
        opacity,
    };
    let knots = [
        (40.0, 0.0),
        (90.0, 0.2),
        (91.0, 0.9),
        (92.0, 0.1),
        (150.0, 0.4),
    ];
    let knots = knots.map(|(value, opacity)| knot(value, opacity)).to_vec();
    let transfer = TransferFunction::new(knots, 2.0).unwrap();
    let volume = tubes();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    for method in QuadratureMethod::ALL {
        for filter in [Filter::Linear, Filter::Nearest] {
            let mut render = |skip, traverse| {
                let picture = Picture::Emission(Emission {
                    quadrature: Quadrature::of(method),
                    ..Emission::of(transfer.clone())
                });
                let mut scene = common::scene(&volume, SIZE_PX, picture);
                scene.sampling.filter = filter;
                scene.sampling.skip = skip;
                scene.sampling.traverse = traverse;
                renderer.render(&scene, Wanted::ALL).unwrap().frame
            };
            let whole = render(false, Traverse::Uniform);
            assert!(whole.color.iter().any(|c| c[3] > 0.1), "{method}");
            for traverse in [
                Traverse::Uniform,
                Traverse::KdRestart,
                Traverse::Hierarchical,
            ] {
                let skipped = render(true, traverse);
                let what = format!("{method} {filter:?} {traverse:?}");
                assert!(picture_bits(&skipped) == picture_bits(&whole), "{what}");
                assert!(total(skipped.plane(NODES)) > 0, "{what}");
                // The adaptive rule asks each cell itself.
                let stepped = method != QuadratureMethod::Adaptive;
                assert!(
                    !stepped || total(skipped.plane(STEPS)) < total(whole.plane(STEPS)),
                    "{what}"
                );
            }
        }
    }
}

#[test]
fn skipping_never_changes_a_bit_of_what_is_clipped() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let (center, _) = volume.bounding_sphere();
    let plane = |normal: DVec3, beyond_mm: f64| {
        let offset = normal.length() * beyond_mm - normal.dot(center);
        ClipPlane::new(normal, offset).unwrap()
    };
    let planes = [
        plane(DVec3::new(-0.4, 0.9, 0.3), 3.0),
        plane(DVec3::new(0.1, 0.2, -1.0), 7.0),
    ];
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    for picture in pictures(volume.range().max) {
        let mut frame = |skip, traverse, planes: &[ClipPlane]| {
            let mut scene = common::scene(&volume, 40, picture.clone());
            scene.clip_planes = planes.to_vec();
            scene.sampling.skip = skip;
            scene.sampling.traverse = traverse;
            renderer.render(&scene, Wanted::ALL).unwrap().frame
        };
        let whole = picture_bits(&frame(false, Traverse::Uniform, &planes));
        for traverse in Traverse::ALL {
            let skipped = picture_bits(&frame(true, traverse, &planes));
            assert!(skipped == whole, "{} {traverse:?}", picture.mode());
        }
        // The control: the planes cut.
        let unclipped = picture_bits(&frame(true, Traverse::Uniform, &[]));
        assert!(unclipped != whole, "{}", picture.mode());
    }
}

#[test]
fn any_work_group_gives_the_same_bytes() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let octree = common::octree(&volume);
    let frames = |work_group| {
        let options = Options {
            work_group,
            ..Options::default()
        };
        let mut renderer = Renderer::new(&device, &volume, &octree, options).unwrap();
        all_frames(&mut renderer, &volume, true, Traverse::Hierarchical)
    };
    let first = frames(None);
    for work_group in [[1, 1], [5, 3]] {
        assert!(frames(Some(work_group)) == first, "{work_group:?}");
    }
}

/// Fixed steps and the exact cast of each picture, and the adaptive rule of the unshaded emission.
fn cast_by_each_method(picture: Picture) -> Vec<(Picture, SamplingMethod)> {
    let other = match &picture {
        Picture::Emission(emission) => emission.phong.is_none().then(|| {
            Picture::Emission(Emission {
                quadrature: Quadrature::of(QuadratureMethod::Adaptive),
                ..emission.clone()
            })
        }),
        exact => Some(exact.clone()),
    };
    let mut casts = vec![(picture, SamplingMethod::Fixed)];
    casts.extend(other.map(|picture| (picture, SamplingMethod::Exact)));
    casts
}

/// Volumes of all types, and the modes in which each is shown. What reads voxels differs with their
/// type, all else is the same for all types: tubes alone are shown by all samplings.
fn of_all_types() -> Vec<(Volume, Vec<&'static str>)> {
    let signed = volume_of([23, 18, 31], |x, y, z| (hash(x, y, z) * 6e4 - 3e4) as i16);
    let wide = volume_of([18, 27, 22], |x, y, z| (hash(y, z, x) * 6.5e4) as u16);
    let flat = volume_of([1, 24, 17], |x, y, z| (hash(x, y, z) * 255.0) as u8);
    vec![
        (tubes(), vec!["iso", "mip", "minip", "mean", "lmip", "dvr"]),
        (mixed(), vec!["iso"]),
        (signed, vec!["iso"]),
        (wide, vec!["mip"]),
        (flat, vec!["iso", "mip"]),
    ]
}

/// What rays of a volume are cast for; where there are many modes, by each method.
fn casts(volume: &Volume, modes: &[&str]) -> Vec<(Picture, SamplingMethod)> {
    let wanted = pictures(volume.range().max)
        .into_iter()
        .filter(|picture| modes.contains(&picture.mode().name()));
    let all_methods = modes.len() > 2;
    let by_methods = wanted.map(|picture| {
        if all_methods {
            cast_by_each_method(picture)
        } else {
            vec![(picture, SamplingMethod::Exact)]
        }
    });
    by_methods.flatten().collect()
}

#[test]
fn neither_lanes_nor_an_image_of_the_voxels_change_a_byte() {
    let Some(device) = common::device() else {
        return;
    };
    // What reads an image is the same in all passes: by one lane and by eight in turn.
    let [one, eight, sixteen] = Lanes::ALL;
    let mut lanes_of_image = [one, eight].into_iter().cycle();
    for (volume, modes) in of_all_types() {
        let octree = Octree::build(&volume, Leaf::new(4).unwrap(), &Silent).unwrap();
        let renderer = |lanes| {
            let options = Options {
                lanes: Some(lanes),
                ..Options::default()
            };
            Renderer::new(&device, &volume, &octree, options).unwrap()
        };
        let has_images = renderer(one).check_storage(Storage::Image).is_ok();
        for (picture, method) in casts(&volume, &modes) {
            let seen = |lanes, storage| {
                let mut renderer = renderer(lanes);
                let frames = [Traverse::Hierarchical, Traverse::Distance].map(|traverse| {
                    let mut scene = common::scene(&volume, SIZE_PX, picture.clone());
                    scene.sampling.method = method;
                    scene.sampling.traverse = traverse;
                    scene.sampling.voxels = storage;
                    picture_bits(&renderer.render(&scene, Wanted::ALL).unwrap().frame)
                });
                let what = format!("{} {method:?} {lanes} lanes {storage}", picture.mode());
                assert!(frames[0] == frames[1], "{what}");
                (frames, what)
            };
            let (first, _) = seen(one, Storage::Buffer);
            let mut others = vec![(eight, Storage::Buffer), (sixteen, Storage::Buffer)];
            let imaged = lanes_of_image.next().map(|lanes| (lanes, Storage::Image));
            others.extend(imaged.filter(|_| has_images));
            for (lanes, storage) in others {
                let (frames, what) = seen(lanes, storage);
                assert!(frames == first, "{what}");
            }
        }
    }
}

#[test]
fn the_comparison_sees_one_voxel_changed() {
    let Some(device) = common::device() else {
        return;
    };
    let changed = volume_of([19, 33, 26], |x, y, z| {
        hash(x, y, z) as f32
            * if (x, y, z) == (9.0, 16.0, 13.0) {
                1.2
            } else {
                1.0
            }
    });
    let volume = noise();
    assert_eq!(volume.range(), changed.range());
    let frames = |volume: &Volume| {
        let octree = common::octree(volume);
        let mut renderer = Renderer::new(&device, volume, &octree, Options::default()).unwrap();
        all_frames(&mut renderer, volume, true, Traverse::Hierarchical)
    };
    for ((what, a), (_, b)) in frames(&volume).iter().zip(&frames(&changed)) {
        // What stops at the first surface cannot see a voxel in the middle of noise.
        let seen = what.contains("mean");
        assert!(picture_bits(a) != picture_bits(b) || !seen, "{what}");
    }
}

#[test]
fn impossible_work_groups_are_refused() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = noise();
    let octree = common::octree(&volume);
    for work_group in [[0, 8], [8, 0], [1 << 20, 1 << 20], [usize::MAX, 2]] {
        let options = Options {
            work_group: Some(work_group),
            ..Options::default()
        };
        assert!(
            Renderer::new(&device, &volume, &octree, options).is_err(),
            "{work_group:?}"
        );
    }
}
