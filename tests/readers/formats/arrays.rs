//! Arrays without a place in the world: NumPy's files and headerless ones.

use angioray::error::ErrorKind;
use angioray::progress::Silent;
use angioray::volume::{RawLayout, ReadOptions, VoxelType, read};
use glam::{DMat3, DVec3};

use super::{Expected, SPACING, fixture, read_fixture};

#[test]
fn numpy_orders_versions_and_archives() {
    for name in [
        "np_big.npy",
        "np_fortran.npy",
        "np_version2.npy",
        "np_version3.npy",
        "np_stored.npz",
        "np_several.npz",
    ] {
        Expected::nowhere().check(name);
    }
    let f32_ramp = Expected::nowhere().of(VoxelType::F32, 0.25);
    f32_ramp.check("np_packed.npz");
    let several = read_fixture("np_several.npz", &ReadOptions::default());
    assert!(
        several
            .notes()
            .join("\n")
            .contains("3 arrays 'volume' is read")
    );

    // Half precision keeps 11 bits: quarters are exact up to 512.
    let half = read_fixture("np_f16.npy", &ReadOptions::default());
    assert_eq!(half.voxels().stored(59), 234.25);
    assert_eq!(half.voxels().voxel_type(), VoxelType::F32);
    let mask = read_fixture("np_bool.npy", &ReadOptions::default());
    assert_eq!(mask.voxels().voxel_type(), VoxelType::U8);
    assert_eq!(
        (mask.voxels().stored(20), mask.voxels().stored(21)),
        (0.0, 1.0)
    );
}

#[test]
fn headerless_files_by_name_or_by_flags() {
    Expected::nowhere()
        .of(VoxelType::U16, 60_000.0)
        .check("ramp_5x4x3_uint16be.raw");
    Expected::nowhere().check("ramp_5x4x3_int16.raw.gz");
    let described = ReadOptions {
        raw: RawLayout {
            size: Some("5x4x3".parse().unwrap()),
            element: Some("i16".parse().unwrap()),
            spacing_mm: Some(SPACING),
            offset_bytes: Some(4),
        },
        ..ReadOptions::default()
    };
    Expected::ramp(DMat3::IDENTITY, SPACING, DVec3::ZERO).check_with("ramp.bin", &described);

    // A flag wins over the name.
    let mut half = ReadOptions::default();
    half.raw.size = Some("5x4x1".parse().unwrap());
    let volume = read_fixture("ramp_5x4x3_uint16be.raw", &half);
    assert_eq!(volume.dims().array(), [5, 4, 1]);
    assert!(
        volume.notes().join("\n").contains("80 bytes after"),
        "{:?}",
        volume.notes()
    );

    let mut incomplete = described;
    incomplete.raw.element = None;
    let error = read(&fixture("ramp.bin"), &incomplete, &Silent).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Usage);
    assert!(error.hint_text().unwrap().contains("--raw-type"));
    let mut short = described;
    short.raw.offset_bytes = Some(5);
    assert!(read(&fixture("ramp.bin"), &short, &Silent).is_err());
    short.raw.offset_bytes = Some(u64::MAX);
    assert!(read(&fixture("ramp.bin"), &short, &Silent).is_err());
}
