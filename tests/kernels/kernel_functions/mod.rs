//! The kernels' functions on the device against counterparts in double precision, written from their
//! definitions.

use crate::common;

mod clip;
mod color;
mod field;
mod gradient;
mod interval;
mod peak;
mod reflection;
mod spans;
mod transfer;

use std::sync::Arc;

use angioray::extent::ImageSize;
use angioray::gpu::{Args, Buffer, Device, Element, Pass, Timings};
use angioray::octree::Leaf;
use angioray::render::{Lanes, Variant};
use angioray::scene::{Filter, Storage};
use angioray::volume::VoxelType;

/// A variant with leaves of `leaf` cells.
fn variant(voxel: VoxelType, filter: Filter, leaf: u32) -> Variant {
    Variant {
        voxel,
        filter,
        leaf: Leaf::new(leaf).unwrap(),
        wide_index: false,
        lanes: Lanes::ONE,
        storage: Storage::Buffer,
    }
}

const U8: VoxelType = VoxelType::U8;

/// `kernels/test/<name>.cl` for `variant`, its samples not shifted.
fn build(name: &'static str, variant: Variant) -> Arc<Pass> {
    let defines = variant.defines().with("JITTERED", 0);
    Pass::new("test", name, defines, [1, 1])
}

fn upload<T: Element>(device: &Device, elements: &[T]) -> Buffer<T> {
    Buffer::upload(device, "test input", elements).unwrap()
}

/// Room for `len` elements, zero.
fn room<T: Element>(device: &Device, len: usize) -> Buffer<T> {
    upload(device, &vec![T::zeroed(); len])
}

/// One work-item for each of `count` inputs.
fn run(device: &Device, pass: &Arc<Pass>, args: Args, count: usize) {
    let size = ImageSize::new(count as u32, 1).unwrap();
    let mut timings = Timings::default();
    timings.add(pass.launch(device, args, size, Some([16, 1])).unwrap());
    timings.finish(device).unwrap();
}

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [low, high), in single precision.
    fn within(&mut self, low: f64, high: f64) -> f32 {
        let unit = (self.bits() >> 11) as f64 / (1u64 << 53) as f64;
        (low + (high - low) * unit) as f32
    }

    fn below(&mut self, n: u32) -> u32 {
        (self.bits() % u64::from(n)) as u32
    }

    /// A direction, uniform on the sphere; w = 0.
    fn direction(&mut self) -> [f32; 4] {
        loop {
            let v: [f32; 3] = std::array::from_fn(|_| self.within(-1.0, 1.0));
            let square: f64 = v.iter().map(|&c| f64::from(c).powi(2)).sum();
            if (0.01..1.0).contains(&square) {
                let len = square.sqrt();
                let [x, y, z] = v.map(|c| (f64::from(c) / len) as f32);
                return [x, y, z, 0.0];
            }
        }
    }
}

/// The x, y, z of a device vector.
fn xyz(v: [f32; 4]) -> [f64; 3] {
    [v[0], v[1], v[2]].map(f64::from)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
