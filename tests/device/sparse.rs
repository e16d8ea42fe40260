//! Sparse casting against its definition, made of whole pictures: which pixels are cast, what is interpolated
//! between them, and that a certified picture without an error is the whole one.

use std::collections::BTreeSet;

use angioray::frame::{
    CAST, CERTIFICATE, Certificate, DEPTH, Frame, KIND, Kind, NODES, NORMAL, STEPS, VALUE, Wanted,
};
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::render::{Lanes, Options, Renderer, Rendering};
use angioray::scene::{
    ClipPlane, Filter, Mode, Picture, Refill, SamplingMethod, Scene, ScreenError, Sparse,
    SparseGrid, Traverse, srgb_from_linear,
};
use angioray::volume::Volume;
use glam::DVec3;

use super::invariance::{pictures, tubes};
use crate::common;

/// No multiple of any spacing, nor of a tile.
const SIZE_PX: u32 = 89;

fn sparse(spacing: u32, threshold: f64, refill: Refill) -> Sparse {
    let has_threshold = matches!(refill, Refill::Gradient | Refill::Flood);
    let grid = SparseGrid::new(spacing, has_threshold.then_some(threshold)).unwrap();
    let nothing = (refill == Refill::Certified).then(|| ScreenError::new(0.0).unwrap());
    Sparse::new(Some(grid), Some(refill), nothing, Mode::Iso).unwrap()
}

fn with(scene: &Scene, sparse: Sparse) -> Scene {
    Scene {
        sparse: Some(sparse),
        ..scene.clone()
    }
}

fn scenes(volume: &Volume) -> Vec<Scene> {
    let pictures = pictures(volume.range().max).into_iter();
    let scene = |picture| common::scene(volume, SIZE_PX, picture);
    let mut scenes: Vec<Scene> = pictures.map(scene).collect();
    let mut exact = scenes[0].clone();
    exact.sampling.method = SamplingMethod::Exact;
    scenes.push(exact);
    scenes
}

/// The grid lines along an axis of so many pixels.
fn lines(spacing: u32, extent: u32) -> Vec<u32> {
    let mut lines: Vec<u32> = (0..extent).step_by(spacing as usize).collect();
    if lines.last() != Some(&(extent - 1)) {
        lines.push(extent - 1);
    }
    lines
}

/// A block's first and last pixel along both axes.
type Block = [u32; 4];

fn blocks(spacing: u32, frame: &Frame) -> Vec<Block> {
    let of = |extent| {
        let lines = lines(spacing, extent);
        let pairs = lines.windows(2).map(|pair| [pair[0], pair[1]]);
        pairs.collect::<Vec<_>>()
    };
    let (columns, rows) = (of(frame.size.width()), of(frame.size.height()));
    let both = |[y0, y1]: [u32; 2]| columns.iter().map(move |&[x0, x1]| [x0, x1, y0, y1]);
    rows.into_iter().flat_map(both).collect()
}

fn corners([x0, x1, y0, y1]: Block, width: u32) -> [usize; 4] {
    [[x0, y0], [x1, y0], [x0, y1], [x1, y1]].map(|[x, y]| (y * width + x) as usize)
}

fn encoded([r, g, b, a]: [f32; 4]) -> [f64; 4] {
    let [r, g, b] = [r, g, b].map(|c| srgb_from_linear(f64::from(c)));
    [r, g, b, f64::from(a)]
}

fn apart(a: [f32; 4], b: [f32; 4]) -> f64 {
    let (a, b) = (encoded(a), encoded(b));
    let channels = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    channels.fold(0.0, f64::max)
}

fn render(renderer: &mut Renderer, scene: &Scene) -> Rendering {
    renderer.render(scene, Wanted::ALL).unwrap()
}

fn was_cast(frame: &Frame) -> Vec<bool> {
    let marks = frame.plane(CAST).expect("a sparse picture has the layer");
    assert!(marks.iter().all(|&mark| mark <= 1));
    marks.iter().map(|&mark| mark == 1).collect()
}

/// Every cast pixel is, to the last bit, the whole picture's.
fn assert_cast_as_whole(sparse: &Frame, whole: &Frame, cast: &[bool]) {
    let all = (0..cast.len() as u32).filter(|&pixel| cast[pixel as usize]);
    let listed: Vec<u32> = all.collect();
    for chunk in listed.chunks(8192) {
        let (mut a, mut b) = (sparse.picked(chunk).unwrap(), whole.picked(chunk).unwrap());
        a.layers.take(CAST);
        b.layers.take(CAST);
        assert!(a.bit_equal(&b));
    }
}

/// Takes the counters of a picture out of it.
fn without_counters(frame: &mut Frame) {
    for key in [STEPS, NODES] {
        frame.layers.take(key);
    }
}

#[test]
fn the_blocks_whose_corners_differ_are_cast_once() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut others = 0;
    for scene in scenes(&volume) {
        let whole = render(&mut renderer, &scene).frame;
        for (spacing, threshold) in [(2, 0.02), (3, 0.05), (4, 0.05), (8, 0.3)] {
            let rule = sparse(spacing, threshold, Refill::Gradient);
            let rendering = render(&mut renderer, &with(&scene, rule));
            let (frame, cast) = (&rendering.frame, was_cast(&rendering.frame));
            let rounds = &rendering.rays_per_round;
            assert_eq!(
                rounds.iter().sum::<u64>(),
                cast.iter().filter(|&&c| c).count() as u64
            );
            let grid = lines(spacing, SIZE_PX).len() as u64;
            assert_eq!(rounds[0], grid * grid);
            assert!(rounds.len() <= 2);
            assert_cast_as_whole(frame, &whole, &cast);

            let mut expected: BTreeSet<usize> = BTreeSet::new();
            let mut in_doubt: BTreeSet<usize> = BTreeSet::new();
            for block in blocks(spacing, &whole) {
                let [x0, x1, y0, y1] = block;
                let corners = corners(block, SIZE_PX);
                expected.extend(corners);
                let pairs = corners.iter().flat_map(|&a| corners.map(|b| (a, b)));
                let pairs = pairs.map(|(a, b)| apart(whole.color[a], whole.color[b]));
                let differs = pairs.fold(0.0, f64::max) - threshold;
                let all =
                    (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| (y * SIZE_PX + x) as usize));
                if differs.abs() < 1e-5 {
                    in_doubt.extend(all);
                } else if differs > 0.0 {
                    expected.extend(all);
                }
            }
            for (pixel, &cast) in cast.iter().enumerate() {
                let right = cast == expected.contains(&pixel) || in_doubt.contains(&pixel);
                assert!(right, "{:?} {spacing} {pixel}", scene.picture.mode());
            }
            assert!(in_doubt.len() < 200);
        }
        let mut count = |rule| was_cast(&render(&mut renderer, &with(&scene, rule)).frame);
        let few = count(sparse(4, 0.5, Refill::Gradient));
        others += usize::from(count(sparse(4, 0.05, Refill::Gradient)) != few);
    }
    // The control: another threshold casts other pixels.
    assert!(others > 3, "{others}");
}

/// The weights of a block's corners at a pixel, in the order of [`corners`].
fn weights([x0, x1, y0, y1]: Block, x: u32, y: u32) -> [f64; 4] {
    let u = f64::from(x - x0) / f64::from(x1 - x0);
    let v = f64::from(y - y0) / f64::from(y1 - y0);
    [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v]
}

/// The mean of corners' numbers; one without weight may be infinite.
fn mean(corners: [usize; 4], weights: [f64; 4], of: impl Fn(usize) -> f64) -> f64 {
    let parts = corners.into_iter().zip(weights);
    let parts = parts.map(|(corner, w)| if w > 0.0 { w * of(corner) } else { 0.0 });
    parts.sum::<f64>() / weights.iter().sum::<f64>()
}

/// Whether every normal is of unit length, or 0.
fn has_unit_normals(frame: &Frame) -> bool {
    let normals = frame.plane(NORMAL).into_iter().flatten();
    let mut lengths = normals.map(|normal| DVec3::from(normal.map(f64::from)).length());
    lengths.all(|length| length == 0.0 || (length - 1.0).abs() < 1e-5)
}

/// Whether an interpolated number is the expected one. A mean has no depth: both are infinite.
fn is_near(expected: f64, number: f32) -> bool {
    let number = f64::from(number);
    expected == number || (expected - number).abs() < 1e-5 * expected.abs().max(1.0)
}

#[test]
fn what_is_not_cast_is_interpolated_in_its_block() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut wrong = 0;
    for scene in scenes(&volume) {
        let is_projection = matches!(scene.picture, Picture::Projection { .. });
        let has_kind = !matches!(scene.picture, Picture::Emission(_));
        let whole = render(&mut renderer, &scene).frame;
        let frame = render(&mut renderer, &with(&scene, sparse(4, 0.0, Refill::None))).frame;
        let cast = was_cast(&frame);
        let scalars = |frame: &Frame, key| frame.plane(key).unwrap().to_vec();
        let (value, depth): (Vec<f32>, Vec<f32>) = (scalars(&whole, VALUE), scalars(&whole, DEPTH));
        let (values, depths): (Vec<f32>, Vec<f32>) =
            (scalars(&frame, VALUE), scalars(&frame, DEPTH));
        let (kind, kinds) = (whole.plane(KIND).unwrap(), frame.plane(KIND).unwrap());
        for block in blocks(4, &whole) {
            let [x0, x1, y0, y1] = block;
            let corners = corners(block, SIZE_PX);
            let met = corners.map(|corner| kind[corner] != Kind::Nothing as u32);
            for (x, y) in (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| (x, y))) {
                let pixel = (y * SIZE_PX + x) as usize;
                if cast[pixel] {
                    continue;
                }
                let weights = weights(block, x, y);
                let of_met = [0, 1, 2, 3].map(|n| if met[n] { weights[n] } else { 0.0 });
                if !is_projection {
                    for channel in 0..4 {
                        let of = |corner: usize| f64::from(whole.color[corner][channel]);
                        let light = mean(corners, weights, of);
                        assert!((light - f64::from(frame.color[pixel][channel])).abs() < 2e-6);
                    }
                }
                if has_kind {
                    let greatest = weights.iter().copied().fold(0.0, f64::max);
                    let nearest = weights.iter().position(|&w| w == greatest).unwrap();
                    assert_eq!(kinds[pixel], kind[corners[nearest]]);
                }
                if kinds[pixel] == Kind::Nothing as u32 {
                    assert_eq!((values[pixel], depths[pixel]), (0.0, f32::INFINITY));
                } else if met.iter().any(|&met| met) {
                    let mean = |plane: &[f32]| mean(corners, of_met, |c| f64::from(plane[c]));
                    let mode = scene.picture.mode();
                    for (of, seen) in [(&value, values[pixel]), (&depth, depths[pixel])] {
                        assert!(
                            is_near(mean(of), seen),
                            "{mode} {pixel}: {} {seen}",
                            mean(of)
                        );
                    }
                }
                // The control: what is interpolated is not what would have been cast.
                wrong += usize::from(frame.color[pixel] != whole.color[pixel]);
            }
        }
        assert!(has_unit_normals(&frame));
    }
    assert!(wrong > 1000, "{wrong}");
}

#[test]
fn a_flood_ends_where_nothing_on_an_edge_differs() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let (mut spread, mut rounds) = (0, 0);
    for scene in scenes(&volume) {
        let whole = render(&mut renderer, &scene).frame;
        for spacing in [3, 8] {
            let rule = |refill| with(&scene, sparse(spacing, 0.05, refill));
            let once = was_cast(&render(&mut renderer, &rule(Refill::Gradient)).frame);
            let rendering = render(&mut renderer, &rule(Refill::Flood));
            let cast = was_cast(&rendering.frame);
            assert_cast_as_whole(&rendering.frame, &whole, &cast);
            assert!(once.iter().zip(&cast).all(|(once, cast)| cast | !once));
            spread += cast.iter().filter(|&&c| c).count() - once.iter().filter(|&&c| c).count();
            rounds = rounds.max(rendering.rays_per_round.len());
            for block in blocks(spacing, &whole) {
                let [x0, x1, y0, y1] = block;
                let at = |x: u32, y: u32| (y * SIZE_PX + x) as usize;
                let mut all = (y0..=y1).flat_map(|y| (x0..=x1).map(move |x| at(x, y)));
                if all.all(|pixel| cast[pixel]) {
                    continue;
                }
                let edges = [
                    ((x0..=x1).map(|x| at(x, y0)).collect::<Vec<_>>()),
                    ((x0..=x1).map(|x| at(x, y1)).collect()),
                    ((y0..=y1).map(|y| at(x0, y)).collect()),
                    ((y0..=y1).map(|y| at(x1, y)).collect()),
                ];
                for edge in edges {
                    let (first, last) = (
                        encoded(whole.color[edge[0]]),
                        encoded(whole.color[edge[edge.len() - 1]]),
                    );
                    for (n, &pixel) in edge.iter().enumerate().filter(|(_, pixel)| cast[**pixel]) {
                        let share = n as f64 / (edge.len() - 1) as f64;
                        let seen = encoded(whole.color[pixel]);
                        for channel in 0..4 {
                            let between = first[channel] + (last[channel] - first[channel]) * share;
                            assert!((seen[channel] - between).abs() < 0.05 + 1e-5);
                        }
                    }
                }
            }
        }
    }
    // The control: there was something to spread to.
    assert!(spread > 1000 && rounds > 3, "{spread} {rounds}");
}

#[test]
fn a_certified_picture_is_the_whole_one() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let mut left_out = 0;
    for (base, scene) in [0, scenes(&volume).len() - 1].map(|n| (n, scenes(&volume).swap_remove(n)))
    {
        let clipped = Scene {
            clip_planes: vec![ClipPlane::new(DVec3::new(0.3, 1.0, 0.2), -25.0).unwrap()],
            ..scene.clone()
        };
        let mut nearest = scene.clone();
        nearest.sampling.filter = Filter::Nearest;
        let inside = Scene {
            camera: common::camera(&volume, DVec3::new(0.2, -0.3, 0.1)),
            ..scene.clone()
        };
        for scene in [scene, clipped, nearest, inside] {
            let mut whole = render(&mut renderer, &scene).frame;
            without_counters(&mut whole);
            let before = whole.layers.take(CERTIFICATE);
            for spacing in SparseGrid::SPACINGS {
                let rule = sparse(spacing, 0.0, Refill::Certified);
                let mut frame = render(&mut renderer, &with(&scene, rule)).frame;
                let cast = was_cast(&frame);
                // How much rays look at depends on their company, and they begin where their blocks do.
                without_counters(&mut frame);
                left_out += cast.iter().filter(|&&cast| !cast).count();
                // What is proven of the whole picture is proven here; of what rays begin behind, and of an empty block, more
                // may be.
                let proven = frame.layers.take(CERTIFICATE);
                for (proven, &before) in proven.iter().flatten().zip(before.iter().flatten()) {
                    assert!(*proven == before || before == Certificate::Undecided as u32);
                }
                assert_cast_as_whole(&frame, &whole, &cast);
                for layer in [DEPTH, VALUE] {
                    assert_eq!(frame.plane(layer), whole.plane(layer), "{base} {spacing}");
                }
                assert_eq!(frame.color, whole.color);
                assert_eq!(frame.plane(KIND), whole.plane(KIND));
                assert_eq!(frame.plane(NORMAL), whole.plane(NORMAL));
            }
        }
    }
    assert!(left_out > 20_000, "{left_out}");
    // The control: a grid that is interpolated loses some.
    let scene = scenes(&volume).swap_remove(0);
    let whole = render(&mut renderer, &scene).frame;
    let frame = render(&mut renderer, &with(&scene, sparse(4, 0.0, Refill::None))).frame;
    assert_ne!(frame.plane(KIND), whole.plane(KIND));
}

#[test]
fn nothing_else_changes_a_bit_of_a_sparse_picture() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let octree = common::octree(&volume);
    let coarse = Octree::build(&volume, Leaf::new(7).unwrap(), &Silent).unwrap();
    let picture = |octree: &Octree, options: Options, scene: &Scene| {
        let mut renderer = Renderer::new(&device, &volume, octree, options).unwrap();
        let mut frame = render(&mut renderer, scene).frame;
        without_counters(&mut frame);
        frame
    };
    let surface = scenes(&volume).pop().unwrap();
    let maximum = scenes(&volume).swap_remove(1);
    for (scene, rule) in [
        (&surface, sparse(4, 0.0, Refill::Certified)),
        (&surface, sparse(3, 0.05, Refill::Flood)),
        (&maximum, sparse(3, 0.05, Refill::Flood)),
    ] {
        let scene = with(scene, rule);
        let base = picture(&octree, Options::default(), &scene);
        for lanes in [Lanes::ONE, Lanes::new(8).unwrap()] {
            let options = Options {
                lanes: Some(lanes),
                work_group: Some([2, 3]),
            };
            assert!(
                base.bit_equal(&picture(&octree, options, &scene)),
                "{rule:?} {lanes}"
            );
        }
        assert!(
            base.bit_equal(&picture(&coarse, Options::default(), &scene)),
            "{rule:?}"
        );
        let mut walked = scene.clone();
        walked.sampling.traverse = Traverse::Hierarchical;
        assert!(
            base.bit_equal(&picture(&octree, Options::default(), &walked)),
            "{rule:?}"
        );
        // The control: another spacing is another picture.
        let other = with(&scene, Sparse { spacing: 2, ..rule });
        assert!(
            !base.bit_equal(&picture(&octree, Options::default(), &other)),
            "{rule:?}"
        );
    }
}
