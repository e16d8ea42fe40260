//! The memory that building an octree takes.

use angioray::extent::Dims;
use angioray::octree::{Leaf, Octree};
use angioray::progress::Silent;
use angioray::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};

use super::memory::max_held;

fn built(edge: u32) -> (Octree, isize) {
    let dims = Dims::new([256, 256, 256]).unwrap();
    let voxels = Voxels::from(vec![7_u8; dims.voxels() as usize]);
    let (geometry, rescale) = (Geometry::default(), Rescale::IDENTITY);
    let volume = Volume::new(dims, voxels, geometry, rescale, NonFinite::Refuse).unwrap();
    max_held(|| Octree::build(&volume, Leaf::new(edge).unwrap(), &Silent).unwrap())
}

/// A node is twelve bytes, and eight more while the tree is built: of a volume of bytes and leaves of
/// four cells 0.37 of the volume, 192 MB for one of 512 MiB.
#[test]
fn an_octree_is_built_in_its_place() {
    for edge in [4, 8] {
        let (octree, held) = built(edge);
        let (nodes, held) = (octree.ranges().len() as u64, held as u64);
        assert_eq!(octree.bytes(), 12 * nodes);
        let max = octree.bytes() + 8 * nodes + (1 << 16);
        assert!(held >= octree.bytes(), "{held} of {nodes} nodes");
        assert!(held <= max, "{held} of {nodes} nodes, at most {max}");
    }
    let (octree, held) = built(4);
    assert!((held as f64) < 0.38 * 256.0 * 256.0 * 256.0);
    // The control: the smaller tree's limit would not do for the larger tree.
    assert!(held as u64 > 20 * built(8).0.ranges().len() as u64 + (1 << 16));
    drop(octree);
}
