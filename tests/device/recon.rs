//! The filter applied at hits alone (`--recon adaptive`): what it does to a hit's depth, and what never changes a bit
//! of it.

use crate::common;

use angioray::frame::{DEPTH, Frame, KIND, NODES, STEPS, VALUE, Wanted};
use angioray::gpu::Device;
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::render::{Lanes, Options, Renderer};
use angioray::scene::{
    ClipPlane, Filter, Picture, Reconstruction, Refine, Rgb, Scene, StepVoxels, Storage, Traverse,
};
use angioray::volume::Volume;
use common::{hash, volume_of};
use glam::DVec3;

use super::invariance::tubes;

/// No multiple of a tile.
const SIZE_PX: u32 = 131;
const STEP_VOXELS: f64 = 0.25;
const ISO: f64 = 100.0;

/// A ball whose value falls by 12 a voxel, 100 at 14 voxels from its centre.
fn ball() -> Volume {
    let middle = DVec3::new(19.3, 20.1, 18.6);
    volume_of([40, 41, 38], |x, y, z| {
        let from_surface = 14.0 - DVec3::new(x, y, z).distance(middle);
        (ISO + 12.0 * from_surface).clamp(0.0, 255.0) as f32
    })
}

fn surface(caps: bool) -> Picture {
    Picture::Surface {
        iso: ISO,
        caps,
        refine: Refine::default(),
        color: Rgb([0.9; 3]),
        phong: None,
    }
}

/// Fixed steps and nothing between them.
fn scene(volume: &Volume, recon: Reconstruction) -> Scene {
    let mut scene = common::scene(volume, SIZE_PX, surface(true));
    scene.sampling.step = StepVoxels::new(STEP_VOXELS).unwrap();
    scene.sampling.probe = false;
    scene.sampling.recon = recon;
    scene
}

#[test]
fn hits_of_a_ball_are_near_the_surface_and_most_are_on_it() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = ball();
    let scenes = [Reconstruction::Adaptive, Reconstruction::Full].map(|how| scene(&volume, how));
    let frames = common::on_device(&device, &volume, &scenes);
    let truth = common::on_reference(&volume, &scenes[0]);
    let (truth, truth_kind) = (truth.plane(DEPTH).unwrap(), truth.plane(KIND).unwrap());
    let apart = |frame: &Frame| {
        let pairs = truth.iter().zip(frame.plane(DEPTH).unwrap());
        let both = pairs.filter(|(a, b)| a.is_finite() && b.is_finite());
        let mut apart: Vec<f32> = both.map(|(a, b)| (a - b).abs()).collect();
        apart.sort_by(f32::total_cmp);
        apart
    };
    let (adaptive, full) = (apart(&frames[0]), apart(&frames[1]));
    let at = |share: f64| adaptive[(share * (adaptive.len() - 1) as f64) as usize];
    assert!(adaptive.len() > 1000);
    println!(
        "adaptive: p50 {} p99 {} max {}; full: max {}",
        at(0.5),
        at(0.99),
        at(1.0),
        full[full.len() - 1]
    );
    assert!(f64::from(at(1.0)) <= STEP_VOXELS + 0.5, "{}", at(1.0));
    assert!(at(0.9) < 2e-3, "{}", at(0.9));
    // Only at the silhouette do nearest voxels and the field disagree on whether there is a hit.
    let kinds = truth_kind.iter().zip(frames[0].plane(KIND).unwrap());
    let wrong = kinds.filter(|(a, b)| a != b).count();
    assert!(wrong * 20 < adaptive.len(), "{wrong} of {}", adaptive.len());
    // The control: it is another picture than the filter's at every sample, whose hits are all on the surface.
    assert!(!frames[0].bit_equal(&frames[1]));
    assert!(f64::from(full[full.len() - 1]) < 2e-2);
}

#[test]
fn a_ray_takes_more_samples_only_where_nearest_voxels_and_the_field_may_disagree() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = ball();
    let scenes = [Reconstruction::Adaptive, Reconstruction::Full].map(|how| scene(&volume, how));
    let frames = common::on_device(&device, &volume, &scenes);
    let plane = |frame: usize, layer| frames[frame].plane(layer).unwrap();
    let (kinds, steps) = (
        [plane(0, KIND), plane(1, KIND)],
        [plane(0, STEPS), plane(1, STEPS)],
    );
    let (mut missed, mut same) = (0, 0);
    for pixel in 0..scenes[0].size.pixels() {
        let hit = [kinds[0][pixel] != 0, kinds[1][pixel] != 0];
        if hit == [false; 2] && steps[1][pixel] > 0 {
            assert!(steps[0][pixel] >= steps[1][pixel], "pixel {pixel}");
            same += usize::from(steps[0][pixel] == steps[1][pixel]);
            missed += 1;
        }
        // A hit takes one more at each sample between the nearest voxels' surface and the field's.
        if hit == [true; 2] {
            let budget = steps[1][pixel] + 2 * 5 + 4 + 8 + 2 * (2.0 / STEP_VOXELS) as u32;
            assert!(steps[0][pixel] <= budget, "pixel {pixel}");
        }
    }
    assert!(2 * same > missed && missed > 0, "{same} of {missed}");
}

/// Depth, value and kind.
fn bits(frame: &Frame) -> Vec<u32> {
    let floats = [DEPTH, VALUE].map(|layer| frame.plane(layer).unwrap().iter());
    let mut all: Vec<u32> = floats.into_iter().flatten().map(|v| v.to_bits()).collect();
    all.extend(frame.plane(KIND).unwrap());
    all
}

/// The picture by as many lanes, and a leaf's edge.
fn cast(device: &Device, volume: &Volume, scene: &Scene, lanes: Lanes, leaf: u32) -> Frame {
    let octree = Octree::build(volume, Leaf::new(leaf).unwrap(), &Silent).unwrap();
    let options = Options {
        lanes: Some(lanes),
        ..Options::default()
    };
    let mut renderer = Renderer::new(device, volume, &octree, options).unwrap();
    renderer.render(scene, Wanted::ALL).unwrap().frame
}

fn assert_same_whatever_the_way(volume: &Volume, scene: &Scene) {
    let Some(device) = common::device() else {
        return;
    };
    let mut unskipped = scene.clone();
    unskipped.sampling.skip = false;
    let expected = cast(&device, volume, &unskipped, Lanes::ONE, 8);
    let hits = expected.plane(KIND).unwrap().iter().filter(|&&k| k != 0);
    assert!(hits.count() > 50);
    let nodes = expected.plane(NODES).unwrap();
    assert!(nodes.iter().all(|&n| n == 0));
    let mut ways = vec![(Lanes::ONE, Traverse::Uniform, 5)];
    for lanes in Lanes::ALL {
        ways.extend([Traverse::KdRestart, Traverse::Distance].map(|by| (lanes, by, 8)));
    }
    for (lanes, traverse, leaf) in ways {
        let mut by = scene.clone();
        by.sampling.traverse = traverse;
        let frame = cast(&device, volume, &by, lanes, leaf);
        assert!(bits(&frame) == bits(&expected), "{traverse}, {lanes} lanes");
    }
    if common::has_images(&device).is_ok() {
        let mut by = scene.clone();
        by.sampling.voxels = Storage::Image;
        let frame = cast(&device, volume, &by, Lanes::of(device.info()), 8);
        assert!(bits(&frame) == bits(&expected), "image");
    }
}

#[test]
fn no_traversal_and_no_number_of_lanes_changes_a_bit() {
    let volume = tubes();
    let mut scene = scene(&volume, Reconstruction::Adaptive);
    assert_same_whatever_the_way(&volume, &scene);
    let (normal, middle) = (DVec3::new(0.3, 1.0, -0.2), volume.bounding_sphere().0);
    let cut = ClipPlane::new(normal, -normal.dot(middle)).unwrap();
    scene.clip_planes = vec![cut];
    scene.sampling.step = StepVoxels::new(1.7).unwrap();
    assert_same_whatever_the_way(&volume, &scene);
}

#[test]
fn nor_do_they_in_noise() {
    let volume = volume_of([19, 33, 26], |x, y, z| (255.0 * hash(x, y, z)) as u8);
    let mut scene = scene(&volume, Reconstruction::Adaptive);
    scene.picture = surface(false);
    assert_same_whatever_the_way(&volume, &scene);
    // The control: with the nearest filter a hit's value is a voxel's, and the picture another.
    let Some(device) = common::device() else {
        return;
    };
    let mut nearest = scene.clone();
    nearest.sampling.filter = Filter::Nearest;
    let frames = common::on_device(&device, &volume, &[scene, nearest]);
    assert!(bits(&frames[0]) != bits(&frames[1]));
}
