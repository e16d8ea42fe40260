//! What host and kernels share: the layout of structs, and the arguments of a pass.

use crate::common;

use std::sync::Arc;

use angioray::extent::ImageSize;
use angioray::gpu::{Args, Buffer, Defines, Device, Pass, Timings};
use angioray::octree::Leaf;
use angioray::render::{Lanes, Variant, struct_layouts};
use angioray::scene::{Filter, Storage};
use angioray::volume::VoxelType;

fn defines() -> Defines {
    let variant = Variant {
        voxel: VoxelType::U8,
        filter: Filter::Linear,
        leaf: Leaf::default(),
        wide_index: false,
        lanes: Lanes::ONE,
        storage: Storage::Buffer,
    };
    variant.defines()
}

#[test]
fn every_struct_has_the_same_layout_on_the_device() {
    let Some(device) = common::device() else {
        return;
    };
    let pass = Pass::new("test", "abi", defines(), [1, 1]);
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

/// What comes of launching `kernels/test/color.cl` with these arguments.
fn launched(device: &Device, pass: &Arc<Pass>, args: Args) -> Result<(), String> {
    let size = ImageSize::new(1, 1).unwrap();
    let mut timings = Timings::default();
    let launch = pass.launch(device, args, size, Some([1, 1]));
    timings.add(launch.map_err(|error| error.to_string())?);
    let finished = timings.finish(device);
    finished.map(|_| ()).map_err(|error| error.to_string())
}

#[test]
fn arguments_that_are_not_the_kernels_are_refused() {
    let Some(device) = common::device() else {
        return;
    };
    let pass = || Pass::new("test", "color", defines(), [1, 1]);
    let values = Buffer::upload(&device, "values", &[0.5_f32]).unwrap();
    let counts = Buffer::upload(&device, "values", &[1_u32]).unwrap();
    let mut linear = Buffer::<f32>::new(&device, "linear", 1).unwrap();
    let mut srgb = Buffer::<f32>::new(&device, "srgb", 1).unwrap();
    let begun = || Args::new().value("count", &1_u32);
    let mut written = |args: Args| args.write("linear", &mut linear).write("srgb", &mut srgb);
    for (args, says) in [
        (begun().read("values", &values), "takes 4 arguments"),
        (
            written(begun().read("value", &values)),
            "gives 'float* value'",
        ),
        (
            written(begun().read("values", &counts)),
            "gives 'uint* values'",
        ),
    ] {
        let refused = launched(&device, &pass(), args).unwrap_err();
        assert!(refused.contains(says), "{refused}");
    }
    // The control: its own arguments, which it then expects of every launch.
    let pass = pass();
    let args = written(begun().read("values", &values));
    assert_eq!(launched(&device, &pass, args), Ok(()));
    let args = written(begun().read("values", &counts));
    let refused = launched(&device, &pass, args).unwrap_err();
    assert!(refused.contains("other arguments"), "{refused}");
}
