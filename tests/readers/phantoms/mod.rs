//! Phantoms against their closed forms, written out here a second time.

mod closed_forms;
mod noise;
mod nrrd;
mod vessels;

use angioray::error::ErrorKind;
use angioray::extent::Dims;
use angioray::volume::{PhantomKind, PhantomSpec, Volume, VoxelType, phantom};
use glam::DVec3;
use proptest::prelude::*;

pub fn spec(kind: PhantomKind, dims: [u64; 3]) -> PhantomSpec {
    PhantomSpec::new(kind, Dims::new(dims).unwrap())
}

pub fn stored(volume: &Volume, [i, j, k]: [u32; 3]) -> f64 {
    let [nx, ny, _] = volume.dims().usize();
    volume
        .voxels()
        .stored((k as usize * ny + j as usize) * nx + i as usize)
}

/// Trilinear interpolation at an index inside the domain.
pub fn trilinear(volume: &Volume, p_index: DVec3) -> f64 {
    let n = volume.dims().array();
    let mut value = 0.0;
    for corner in 0..8_u32 {
        let mut weight = 1.0;
        let mut at = [0; 3];
        for axis in 0..3 {
            let low = (p_index[axis].floor() as u32).min(n[axis].saturating_sub(2));
            let t = p_index[axis] - f64::from(low);
            let up = corner >> axis & 1;
            at[axis] = (low + up).min(n[axis] - 1);
            weight *= if up == 1 { t } else { 1.0 - t };
        }
        value += weight * stored(volume, at);
    }
    value
}

#[test]
fn senseless_shapes_are_refused() {
    let refused = |kind, change: &dyn Fn(&mut PhantomSpec)| {
        let mut spec = spec(kind, [8, 8, 8]);
        change(&mut spec);
        phantom(&spec).err().map(|error| error.kind())
    };
    use PhantomKind::{Blob, Noise, Slab, Sphere, Vessels};
    let usage = Some(ErrorKind::Usage);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(refused(Sphere, &|s| s.radius_mm = Some(bad)), usage);
        assert_eq!(refused(Slab, &|s| s.thickness_mm = Some(bad)), usage);
        assert_eq!(refused(Blob, &|s| s.sigma_mm = Some(bad)), usage);
        assert_eq!(refused(Vessels, &|s| s.tip_radius_mm = Some(bad)), usage);
        assert_eq!(refused(Sphere, &|s| s.spacing_mm.y = bad), usage);
    }
    assert_eq!(refused(Sphere, &|s| s.noise = -0.1), usage);
    assert_eq!(refused(Noise, &|s| s.noise = 0.1), usage);
    assert_eq!(refused(Slab, &|s| s.axis = Some(3)), usage);
    assert_eq!(refused(Sphere, &|s| s.axis = Some(1)), usage);
    assert_eq!(refused(Slab, &|s| s.radius_mm = Some(1.0)), usage);
    assert_eq!(refused(Vessels, &|s| s.radius_mm = Some(5.0)), usage);
    assert_eq!(refused(Vessels, &|s| s.tip_radius_mm = Some(3.0)), usage);
    assert_eq!(refused(Vessels, &|s| s.tip_radius_mm = Some(1e-9)), usage);
    assert_eq!(refused(Sphere, &|s| s.radius_mm = Some(1e300)), None);
    let huge = PhantomSpec::new(Sphere, Dims::new([1 << 13; 3]).unwrap());
    assert_eq!(phantom(&huge).unwrap_err().kind(), ErrorKind::Usage);
}

#[test]
fn kinds_are_known_by_their_names() {
    for kind in PhantomKind::ALL {
        assert_eq!(kind.name().parse(), Ok(kind));
        assert!(kind.description().ends_with('.'));
    }
    let error = "cube".parse::<PhantomKind>().unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Usage);
    assert!(error.hint_text().unwrap().contains("marschner-lobb"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Any size, spacing and voxel type makes every phantom, with its values in the stated range.
    #[test]
    fn any_grid_will_do(
        dims in prop::array::uniform3(prop_oneof![Just(1_u64), 1_u64..5, 5_u64..14]),
        spacing in prop::array::uniform3(prop_oneof![Just(1.0), 1e-6..1e-3, 0.2..5.0, 1e3..1e6]),
        seed: u64,
        noise in prop_oneof![Just(0.0), 0.0..2.0],
    ) {
        for kind in PhantomKind::ALL {
            for voxel_type in VoxelType::ALL {
                let mut spec = spec(kind, dims);
                spec.spacing_mm = spacing.into();
                spec.voxel_type = voxel_type;
                spec.seed = seed;
                spec.noise = if kind == PhantomKind::Noise { 0.0 } else { noise };
                let made = phantom(&spec).unwrap();
                prop_assert!(!made.definition.is_empty());
                prop_assert_eq!(made.tree.is_some(), kind == PhantomKind::Vessels);
                let centre = DVec3::from_array(dims.map(|n| (n - 1) as f64 / 2.0));
                let world = made.volume.geometry().world_from_index().transform_point3(centre);
                prop_assert!(world.length() <= 1e-9 * spec.spacing_mm.max_element());
                if spec.noise == 0.0 {
                    prop_assert!(made.volume.range().min >= spec.values().min);
                    prop_assert!(made.volume.range().max <= spec.values().max);
                }
            }
        }
    }
}
