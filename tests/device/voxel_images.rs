//! Voxels in an image: every value comes back as it is stored, and what the device filters is the field
//! within the error of weights of eight bits. `invariance` compares whole pictures from images and buffers.
//! Without a device, or images of it, the tests say so and pass, unless REQUIRE_OPENCL=1.

use crate::common;

use angioray::extent::ImageSize;
use angioray::frame::{VALUE, Wanted};
use angioray::gpu::Device;
use angioray::octree::Octree;
use angioray::render::{Options, Renderer};
use angioray::scene::{
    Camera, Filter, Lens, Picture, Projection, SamplingMethod, Scene, StepVoxels, Storage, Window,
};
use angioray::volume::{Volume, Voxels};
use common::{hash, volume_of};
use glam::DVec3;

/// The device under test, if it has images.
fn device() -> Option<Device> {
    let device = common::device()?;
    match common::has_images(&device) {
        Ok(()) => Some(device),
        Err(error) => {
            common::skip(&error.to_string());
            None
        }
    }
}

fn renderer<'a>(device: &'a Device, volume: &'a Volume, octree: &'a Octree) -> Renderer<'a> {
    Renderer::new(device, volume, octree, Options::default()).unwrap()
}

/// From high above along -z, in parallel rays: pixel (i, j) sees x = i and y = ny - 1 - j, in voxels, of
/// as many pixels as voxels; `aside` moves the eye.
fn from_above(volume: &Volume, size: [u32; 2], aside: DVec3) -> Scene {
    let [nx, ny, nz] = volume.dims().array().map(|n| n as f64);
    let middle = DVec3::new(nx - 1.0, ny - 1.0, nz - 1.0) / 2.0 + aside;
    let (eye, lens) = (
        middle + DVec3::Z * (2.0 * nz + 10.0),
        Lens::Orthographic { height_mm: ny },
    );
    let picture = Picture::Projection {
        of: Projection::Maximum,
        window: Window::new(0.0, 1.0).unwrap(),
    };
    let mut scene = common::scene(volume, 8, picture);
    scene.camera = Camera::look_at(eye, middle, DVec3::Y, lens).unwrap();
    scene.size = ImageSize::new(size[0], size[1]).unwrap();
    scene.sampling.method = SamplingMethod::Fixed;
    scene
}

/// Every value of a type of 16 bits at most, one voxel each, in the order of the image's pixels.
fn comes_back<T: Copy + Into<f64>>(values: impl Iterator<Item = T>)
where
    Voxels: From<Vec<T>>,
{
    let Some(device) = device() else { return };
    let values: Vec<T> = values.collect();
    let (nx, ny) = (256, values.len() / 256);
    let pixel = |x: f64, y: f64| (ny - 1 - y as usize) * nx + x as usize;
    let volume = volume_of([nx as u64, ny as u64, 1], |x, y, _| values[pixel(x, y)]);
    let octree = common::octree(&volume);
    let mut renderer = renderer(&device, &volume, &octree);
    let mut scene = from_above(&volume, [nx as u32, ny as u32], DVec3::ZERO);
    scene.sampling.filter = Filter::Nearest;
    scene.sampling.voxels = Storage::Image;
    let wrong = |scene: &Scene, renderer: &mut Renderer| -> usize {
        let seen = renderer.render(scene, Wanted::ALL).unwrap().frame;
        let seen = seen.plane(VALUE).unwrap();
        let pairs = values.iter().zip(seen);
        pairs
            .filter(|(value, seen)| (**value).into() != f64::from(**seen))
            .count()
    };
    assert_eq!(wrong(&scene, &mut renderer), 0);
    // The control: a voxel aside nearly all are others.
    let aside = from_above(&volume, [nx as u32, ny as u32], DVec3::X);
    scene.camera = aside.camera;
    assert!(wrong(&scene, &mut renderer) > values.len() / 2);
}

#[test]
fn every_u8_comes_back() {
    comes_back((0..1024).map(|n| n as u8));
}

#[test]
fn every_u16_comes_back() {
    comes_back(0..=u16::MAX);
}

#[test]
fn every_i16_comes_back() {
    comes_back(i16::MIN..=i16::MAX);
}

const SIDES: [u64; 3] = [13, 11, 9];

/// Values of Φ, one a point.
struct Samples {
    points: Vec<DVec3>,
    values: Vec<f64>,
}

/// The corners of a point's cell, x fastest, and where the point is in it.
fn corners(volume: &Volume, p: DVec3) -> ([f64; 8], [f64; 3]) {
    let p = p.to_array();
    let cell: [usize; 3] = std::array::from_fn(|axis| {
        let last = SIDES[axis] as usize - 2;
        (p[axis].max(0.0) as usize).min(last)
    });
    let corner = |n: usize| {
        let [x, y, z] = [
            cell[0] + (n & 1),
            cell[1] + (n >> 1 & 1),
            cell[2] + (n >> 2),
        ];
        let place = (z * SIDES[1] as usize + y) * SIDES[0] as usize + x;
        volume.rescale().physical(volume.voxels().stored(place))
    };
    (
        std::array::from_fn(corner),
        std::array::from_fn(|axis| p[axis] - cell[axis] as f64),
    )
}

/// The trilinear field with its weights rounded to so many parts.
fn trilinear(volume: &Volume, p: DVec3, parts: Option<f64>) -> f64 {
    let (corners, in_cell) = corners(volume, p);
    let weight = |t: f64| parts.map_or(t, |parts| (t * parts).round() / parts);
    let [x, y, z] = in_cell.map(weight);
    let lerp = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let along_x: [f64; 4] =
        std::array::from_fn(|row| lerp(corners[2 * row], corners[2 * row + 1], x));
    let y0 = lerp(along_x[0], along_x[1], y);
    let y1 = lerp(along_x[2], along_x[3], y);
    lerp(y0, y1, z)
}

/// How many values are off by more than weights of eight bits explain: each axis's weight may be off by
/// 1/256, which moves the value by as much of the corners' spread; and a point that single precision
/// puts elsewhere by 1e-5 voxel, or into the next cell, as well as a texel's own rounding, by 1e-4 of the
/// range at most.
fn beyond_eight_bits(volume: &Volume, samples: &Samples) -> usize {
    let range = volume.range().max - volume.range().min;
    let pairs = samples.points.iter().zip(&samples.values);
    pairs
        .filter(|&(&p, &value)| {
            let (corners, _) = corners(volume, p);
            let max = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let min = corners.into_iter().fold(f64::INFINITY, f64::min);
            let bound = 3.0 / 256.0 * (max - min) + 1e-4 * range;
            (value - trilinear(volume, p, None)).abs() > bound
        })
        .count()
}

/// One sample a ray, in the middle of the volume's height.
fn in_the_middle(device: &Device, volume: &Volume, storage: Storage) -> Samples {
    let octree = common::octree(volume);
    let mut renderer = renderer(device, volume, &octree);
    let (width, height) = (61, 47);
    let mut scene = from_above(volume, [width, height], DVec3::new(0.1, 0.0, 0.0));
    // Beside the cells' faces, where which cell a point is in would depend on rounding: 7.3 voxels from
    // above, in the middle of the first step.
    scene.sampling.step = StepVoxels::new(7.3).unwrap();
    scene.sampling.voxels = storage;
    let sampled = renderer.sample_field(&scene).unwrap();
    let top = SIDES[2] as f64 - 1.0;
    let mut samples = Samples {
        points: Vec::new(),
        values: Vec::new(),
    };
    for (pixel, &count) in sampled.counts.iter().enumerate() {
        if count != 1 {
            continue;
        }
        let (i, j) = (pixel % width as usize, pixel / width as usize);
        let ray = scene.camera.ray(scene.size, i as f64 + 0.5, j as f64 + 0.5);
        let mut p = ray.origin_world;
        p.z = top - 0.5 * 7.3;
        samples.points.push(p);
        samples.values.push(sampled.means[pixel]);
    }
    samples
}

fn filters_within_eight_bits<T>(voxel: impl Fn(f64) -> T)
where
    Voxels: From<Vec<T>>,
{
    let Some(device) = device() else { return };
    let volume = volume_of(SIDES, |x, y, z| voxel(hash(x, y, z)));
    let filtered = in_the_middle(&device, &volume, Storage::Filtered);
    let count = filtered.points.len();
    assert!(count > 1000, "{count}");
    assert_eq!(beyond_eight_bits(&volume, &filtered), 0);
    // The control: weights of eight bits are within the bound, weights of four are not.
    let of_parts = |parts| Samples {
        points: filtered.points.clone(),
        values: filtered
            .points
            .iter()
            .map(|&p| trilinear(&volume, p, Some(parts)))
            .collect(),
    };
    assert_eq!(beyond_eight_bits(&volume, &of_parts(256.0)), 0);
    assert!(beyond_eight_bits(&volume, &of_parts(16.0)) > count / 20);
}

#[test]
fn u8_is_filtered_within_eight_bits() {
    filters_within_eight_bits(|n| (n * 255.0) as u8);
}

#[test]
fn u16_is_filtered_within_eight_bits() {
    filters_within_eight_bits(|n| (n * 65535.0) as u16);
}

#[test]
fn i16_is_filtered_within_eight_bits() {
    // Its smallest value too, which a signed texel would not distinguish from the next.
    filters_within_eight_bits(|n| (n * 65535.0 - 32768.0) as i16);
}

#[test]
fn f32_is_filtered_within_eight_bits() {
    filters_within_eight_bits(|n| (n * 3.0 - 1.0) as f32);
}

#[test]
fn what_the_device_cannot_filter_is_refused() {
    let Some(device) = device() else { return };
    let volume = volume_of(SIDES, |x, y, z| (hash(x, y, z) * 255.0) as u8);
    let octree = common::octree(&volume);
    let mut renderer = renderer(&device, &volume, &octree);
    let mut scene = from_above(&volume, [8, 8], DVec3::ZERO);
    scene.sampling.voxels = Storage::Filtered;
    assert!(renderer.render(&scene, Wanted::DISPLAY).is_ok());
    let mut nearest = scene.clone();
    nearest.sampling.filter = Filter::Nearest;
    let mut exact = scene.clone();
    exact.sampling.method = SamplingMethod::Exact;
    for (refused, why) in [(nearest, "nearest"), (exact, "exact sampling")] {
        let error = renderer.render(&refused, Wanted::DISPLAY).err().unwrap();
        assert!(error.to_string().contains(why), "{error}");
    }
}

#[test]
fn a_volume_too_long_for_an_image_is_refused() {
    let Some(device) = device() else { return };
    // The longest that a volume may be.
    let volume = volume_of([1 << 16, 2, 2], |x, _, _| x as u8);
    let octree = common::octree(&volume);
    let mut renderer = renderer(&device, &volume, &octree);
    if renderer.check_storage(Storage::Image).is_ok() {
        eprintln!("skipped: the device has images of any volume's length");
        return;
    }
    let mut scene = from_above(&volume, [8, 8], DVec3::ZERO);
    assert!(renderer.render(&scene, Wanted::DISPLAY).is_ok());
    scene.sampling.voxels = Storage::Image;
    let error = renderer.render(&scene, Wanted::DISPLAY).err().unwrap();
    let text = error.to_string();
    assert!(text.contains("larger than an image"), "{text}");
    assert!(renderer.check_storage(Storage::Buffer).is_ok());
}

/// Nothing is held that no picture has needed.
#[test]
fn an_image_takes_the_place_of_the_buffer() {
    let Some(device) = device() else { return };
    let volume = volume_of([40, 40, 40], |x, y, z| (hash(x, y, z) * 255.0) as u8);
    let octree = common::octree(&volume);
    let scene_in = |storage| {
        let mut scene = from_above(&volume, [8, 8], DVec3::ZERO);
        scene.sampling.voxels = storage;
        scene
    };
    let bytes = |renderer: &mut Renderer, storage| {
        let rendering = renderer.render(&scene_in(storage), Wanted::DISPLAY);
        rendering.unwrap().device_bytes
    };
    let of_one = |storage| bytes(&mut renderer(&device, &volume, &octree), storage);
    let buffer = of_one(Storage::Buffer);
    assert_eq!(of_one(Storage::Image), buffer);
    let mut both = renderer(&device, &volume, &octree);
    bytes(&mut both, Storage::Image);
    bytes(&mut both, Storage::Filtered);
    assert_eq!(bytes(&mut both, Storage::Buffer), buffer + 40 * 40 * 40);
}
