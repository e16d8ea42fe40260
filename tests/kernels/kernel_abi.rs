//! The structs shared with the kernels have the same layout on both sides.

use crate::common;

use angioray::extent::ImageSize;
use angioray::gpu::{Buffer, Pass, Timings, output};
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
    let signature = vec![output::<u32>("layout")];
    let pass = Pass::new("test", "abi", variant.defines(), signature);
    let pass = pass.built(&device).unwrap();
    let host: Vec<u32> = struct_layouts()
        .into_iter()
        .flat_map(|(_, layout)| layout)
        .collect();
    let mut layout = Buffer::upload(&device, "layout", &vec![u32::MAX; host.len() + 1]).unwrap();
    let mut timings = Timings::default();
    pass.launch(&device)
        .output(&mut layout)
        .run(ImageSize::new(1, 1).unwrap(), Some([1, 1]), &mut timings)
        .unwrap();
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
