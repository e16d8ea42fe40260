//! Rays from a list of pixels and from buffers find what a camera's rays find.

use angioray::frame::{CERTIFICATE, Certificate, Kind, Wanted};
use angioray::lab::bench::aimed::{Target, rays, target};
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::render::{FirstCrossing, IndexRay, Options, RayCaster, Renderer};
use angioray::scene::{ClipPlane, SamplingMethod, Scene};
use glam::DVec3;

use super::invariance::{pictures, tubes};
use crate::common::{self, hash};

const SIZE_PX: u32 = 53; // rows end within a tile

/// Every picture, by fixed steps and exactly.
fn scenes() -> Vec<Scene> {
    let volume = tubes();
    let pictures = pictures(volume.range().max);
    let both = |picture| {
        let fixed = common::scene(&volume, SIZE_PX, picture);
        let mut exact = fixed.clone();
        exact.sampling.method = SamplingMethod::Exact;
        [fixed, exact]
    };
    pictures.into_iter().flat_map(both).collect()
}

#[test]
fn listed_pixels_are_those_of_the_whole_picture_and_others_are_empty() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let is_listed = |pixel: &u32| hash(f64::from(*pixel), 3.0, 5.0) < 0.3;
    let all: Vec<u32> = (0..SIZE_PX * SIZE_PX).rev().collect();
    let (listed, others): (Vec<u32>, Vec<u32>) = all.iter().partition(|pixel| is_listed(pixel));
    for scene in scenes() {
        let whole = renderer.render(&scene, Wanted::ALL).unwrap().frame;
        let by_pixels = renderer.render_pixels(&scene, Wanted::ALL, &all).unwrap();
        assert!(whole.bit_equal(&by_pixels.frame), "{:?}", scene.picture);

        let some = renderer.render_pixels(&scene, Wanted::ALL, &listed);
        let some = some.unwrap().frame;
        let seen = whole.picked(&listed).unwrap();
        assert!(seen.bit_equal(&some.picked(&listed).unwrap()));
        // Other pixels are as where everything is clipped away, but that nothing is proven of them.
        let mut clipped = scene.clone();
        clipped.clip_planes = vec![ClipPlane::new(DVec3::X, -1e6).unwrap()];
        let mut nothing = renderer.render(&clipped, Wanted::ALL).unwrap().frame;
        if let Some(certificates) = nothing.plane_mut(CERTIFICATE) {
            certificates.fill(Certificate::Undecided as u32);
        }
        let unseen = nothing.picked(&others).unwrap();
        assert!(unseen.bit_equal(&some.picked(&others).unwrap()));
        // The control: they are not empty in the whole picture.
        assert!(!unseen.bit_equal(&whole.picked(&others).unwrap()));
    }
}

#[test]
fn a_pixel_outside_the_picture_is_refused() {
    let Some(device) = common::device() else {
        return;
    };
    let volume = tubes();
    let octree = common::octree(&volume);
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default()).unwrap();
    let scene = &scenes()[0];
    let last = SIZE_PX * SIZE_PX - 1;
    assert!(renderer.render_pixels(scene, Wanted::ALL, &[last]).is_ok());
    let refused = renderer.render_pixels(scene, Wanted::ALL, &[0, last + 1]);
    let message = refused.err().unwrap().to_string();
    assert!(
        message.contains(&format!("pixel {}", last + 1)),
        "{message}"
    );
    assert!(renderer.render_pixels(scene, Wanted::ALL, &[]).is_err());
}

/// Targets of every kind of voxel, each with rays aimed where casts fail.
fn aimed() -> Vec<(Target, Vec<IndexRay>)> {
    let of = |number| {
        let target = target(16, number).unwrap();
        let aimed = rays(&target, 16 + u64::from(number), 3000);
        let forward = aimed
            .iter()
            .map(|ray| IndexRay::forward(ray.origin, ray.dir));
        let forward = forward.collect();
        (target, forward)
    };
    (0..6).map(of).collect()
}

fn cast(caster: &mut RayCaster, target: &Target, rays: &[IndexRay]) -> Vec<FirstCrossing> {
    let Target { volume, iso, caps } = target;
    let octree = Octree::build(volume, Leaf::new(4).unwrap(), &Silent).unwrap();
    caster.cast(volume, &octree, *iso, *caps, rays).unwrap()
}

#[test]
fn rays_find_the_same_in_whatever_company() {
    let Some(device) = common::device() else {
        return;
    };
    let mut caster = RayCaster::new(&device, None);
    let mut hits = 0;
    for (target, rays) in aimed() {
        let found = cast(&mut caster, &target, &rays);
        // In strides: neighbours in a work-item have nothing in common.
        let order: Vec<usize> = (0..rays.len()).map(|n| n * 1009 % rays.len()).collect();
        let apart: Vec<IndexRay> = order.iter().map(|&n| rays[n]).collect();
        let apart = cast(&mut caster, &target, &apart);
        let expected: Vec<FirstCrossing> = order.iter().map(|&n| found[n]).collect();
        assert_eq!(apart, expected);
        // The control: another order is another answer.
        assert_ne!(apart, found);
        hits += found.iter().filter(|one| one.kind != Kind::Nothing).count();
    }
    assert!(hits > 3000, "{hits}");
}

#[test]
fn a_ray_is_cast_from_its_smallest_t_to_its_greatest() {
    let Some(device) = common::device() else {
        return;
    };
    let mut caster = RayCaster::new(&device, None);
    let (mut ended, mut again, mut later) = (0, 0, 0);
    for (target, rays) in aimed() {
        let found = cast(&mut caster, &target, &rays);
        let hits = rays.iter().zip(&found);
        // Before a proven crossing rounding finds no other.
        let proven = |one: &FirstCrossing| one.certificate == Certificate::Hit;
        let hits = hits.filter(|(_, one)| one.kind == Kind::Surface && proven(one) && one.t > 0.1);
        let (rays, hits): (Vec<IndexRay>, Vec<&FirstCrossing>) = hits.unzip();
        let with = |t: fn(f32) -> [f32; 2]| -> Vec<IndexRay> {
            let parts = rays.iter().zip(&hits);
            parts
                .map(|(&ray, hit)| IndexRay { t: t(hit.t), ..ray })
                .collect()
        };
        let before = cast(&mut caster, &target, &with(|t| [0.0, 0.99 * t]));
        assert!(before.iter().all(|one| one.kind == Kind::Nothing));
        let beyond = cast(&mut caster, &target, &with(|t| [0.0, 1.01 * t]));
        // Where a ray ends within a cell its cubic has other coefficients, rounded otherwise: near a double root the
        // root moves by the square root of that, and where the field stays within rounding of the iso value
        // nothing is decided before it leaves it.
        for (one, hit) in beyond.iter().zip(&hits) {
            let close = (one.t - hit.t).abs() <= 3e-4 * (1.0 + hit.t);
            let same = close && one.kind == hit.kind;
            assert!(
                same || one.certificate == Certificate::Undecided,
                "{one:?} {hit:?}"
            );
            again += usize::from(same);
        }
        ended += before.len();
        let behind = cast(&mut caster, &target, &with(|t| [1.01 * t, f32::INFINITY]));
        for (one, hit) in behind.iter().zip(&hits) {
            assert!(one.kind != Kind::Cap && one.t >= 1.01 * hit.t, "{one:?}");
            later += usize::from(one.kind == Kind::Surface);
        }
    }
    assert!(ended > 1000 && later > 100, "{ended} {later}");
    assert!(again > ended - ended / 100, "{again} of {ended}");
}
