//! The structs shared with the kernels have the same layout on both sides.

mod common;

use angioray::extent::ImageSize;
use angioray::gpu::{Args, Buffer, Pass, Timings};
use angioray::octree::Leaf;
use angioray::render::{Lanes, Variant, struct_layouts};
use angioray::scene::{Filter, Storage};
use angioray::volume::VoxelType;

#[test]
fn every_struct_has_the_same_layout_on_the_device() {
    let Some(device) = common::device() else {
        return;
    };
    let variant = Variant {
        voxel: VoxelType::U8,
        filter: Filter::Linear,
        leaf: Leaf::default(),
        wide_index: false,
        lanes: Lanes::ONE,
        storage: Storage::Buffer,
    };
    let pass = Pass::new("test", "abi", variant.defines(), [1, 1]);
    let host: Vec<u32> = struct_layouts()
        .into_iter()
        .flat_map(|(_, layout)| layout)
        .collect();
    let mut layout = Buffer::upload(&device, "layout", &vec![u32::MAX; host.len() + 1]).unwrap();
    let mut timings = Timings::default();
    let args = Args::new().write("layout", &mut layout);
    let size = ImageSize::new(1, 1).unwrap();
    timings.add(pass.launch(&device, args, size, Some([1, 1])).unwrap());
    timings.finish(&device).unwrap();
    let on_device = layout.download(&device).unwrap();
    let mut rest = &on_device[..];
    for (name, host) in struct_layouts() {
        let (own, after) = rest.split_at(host.len());
        assert_eq!(own, host, "{name}");
        rest = after;
    }
    // Nothing more was written: the device has no field that the host forgot.
    assert_eq!(rest, [u32::MAX]);
    // The comparison sees one moved field.
    let mut moved = host.clone();
    moved[3] += 4;
    assert_ne!(on_device[..host.len()], moved[..]);
}
