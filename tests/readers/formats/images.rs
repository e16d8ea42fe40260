//! The formats of medical images: NRRD, MetaImage and NIfTI, with their encodings and geometry.

use angioray::volume::{ReadOptions, VoxelType};
use glam::{DMat3, DVec3};

use super::{Expected, LEFT_HANDED, ORIGIN, SPACING, oblique, read_fixture};

#[test]
fn nrrd_encodings_byte_orders_and_skips() {
    let spaced = Expected::ramp(DMat3::IDENTITY, SPACING, DVec3::ZERO);
    for name in [
        "pynrrd_raw.nrrd",
        "pynrrd_gzip.nrrd",
        "pynrrd_bzip2.nrrd",
        "pynrrd_ascii.nrrd",
        "pynrrd_raw_big.nrrd",
        "pynrrd_gzip_big.nrrd",
        "pynrrd_bzip2_big.nrrd",
        "pynrrd_detached.nhdr",
    ] {
        spaced.check(name);
    }
    for name in [
        "skip.nhdr",
        "from_end.nhdr",
        "skip_gz.nhdr",
        "list.nhdr",
        "pattern.nhdr",
        "crlf.nrrd",
    ] {
        Expected::nowhere().check(name);
    }
    Expected::nowhere()
        .of(VoxelType::F32, 0.25)
        .check("pynrrd_ascii_f32.nrrd");
    Expected::nowhere()
        .of(VoxelType::F32, -0.125)
        .check("pynrrd_f64_big.nrrd");
}

#[test]
fn nrrd_geometry_is_in_lps() {
    Expected::placed(oblique()).check("sitk_oblique.nrrd");
    Expected::placed(oblique()).check("sitk_detached.nhdr");
    Expected::placed(LEFT_HANDED).check("sitk_left_handed.nrrd");
    Expected::placed(oblique()).check("pynrrd_scanner-xyz.nrrd");
    let mirrored = |signs: DVec3| {
        Expected::ramp(
            DMat3::from_diagonal(signs) * oblique(),
            SPACING,
            signs * ORIGIN,
        )
    };
    mirrored(DVec3::new(-1.0, -1.0, 1.0)).check("pynrrd_right-anterior-superior.nrrd");
    mirrored(DVec3::new(1.0, -1.0, 1.0)).check("pynrrd_left-anterior-superior.nrrd");
}

#[test]
fn metaimage_variants() {
    for name in ["sitk_oblique.mha", "sitk_detached.mhd", "sitk_packed.mhd"] {
        Expected::placed(oblique()).check(name);
    }
    Expected::placed(LEFT_HANDED).check("sitk_left_handed.mha");
    for name in [
        "big.mha",
        "big_packed.mha",
        "list.mhd",
        "pattern.mhd",
        "from_end.mhd",
        "skip.mhd",
        "ascii.mha",
    ] {
        Expected::placed(DMat3::IDENTITY).check(name);
    }
}

#[test]
fn nifti_geometry_from_sform_qform_or_neither() {
    for name in [
        "sitk_oblique.nii",
        "nib_both.nii",
        "nib_meter.nii",
        "nib_micron.nii",
    ] {
        Expected::placed(oblique()).check(name);
    }
    for name in ["sitk_left_handed.nii.gz", "nib_qform.nii"] {
        Expected::placed(LEFT_HANDED).check(name);
    }
    let sheared = DMat3::from_cols(
        DVec3::new(-2.0, 0.0, 0.0),
        DVec3::new(-1.0, -2.0, 0.0),
        DVec3::new(0.0, 0.0, 3.0),
    );
    Expected::ramp(sheared, DVec3::ONE, DVec3::ZERO).check("nib_sheared.nii");
    Expected::ramp(DMat3::IDENTITY, SPACING, DVec3::ZERO).check("nib_uncoded.nii");
}

#[test]
fn a_nifti_pair_is_found_from_either_part() {
    for name in [
        "nib_pair.hdr",
        "nib_pair.img",
        "nib_pair_gz.hdr.gz",
        "nib_pair_gz.img.gz",
    ] {
        Expected::placed(oblique()).check(name);
    }
}

#[test]
fn slope_and_intercept_make_physical_values() {
    let physical = |name: &str, stored: f64| {
        let volume = read_fixture(name, &ReadOptions::default());
        let index = (0..60).find(|&i| {
            let [x, y, z] = [i % 5, i / 5 % 4, i / 20];
            (x + 10 * y + 100 * z) as f64 + 20.0 == stored
        });
        let value = volume.voxels().stored(index.unwrap());
        (volume.rescale().physical(value), volume.range())
    };
    let (value, range) = physical("slope_rising.nii", 132.0);
    assert_eq!(value, 2.0 * 132.0 - 1024.0);
    assert_eq!((range.min, range.max), (-984.0, 2.0 * 254.0 - 1024.0));
    let (value, range) = physical("slope_falling.nii", 132.0);
    assert_eq!(value, 3.0 - 66.0);
    assert_eq!((range.min, range.max), (3.0 - 127.0, 3.0 - 10.0));
    // A slope of 0 is none at all.
    assert_eq!(physical("slope_none.nii", 132.0).0, 132.0);
    let rising = read_fixture("slope_rising.nii", &ReadOptions::default());
    assert_eq!(rising.voxels().voxel_type(), VoxelType::U8);
}

#[test]
fn a_negative_spacing_is_an_axis_turned_round() {
    let turned = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    Expected::placed(turned).check("negative.mha");
}
