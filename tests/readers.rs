//! Volume files written by SimpleITK, nibabel, pynrrd and NumPy (tests/data/make_volumes.py), read
//! and compared with what was put in: the ramp's formula and the geometry, in LPS.

use std::path::{Path, PathBuf};

use angioray::error::ErrorKind;
use angioray::progress::Silent;
use angioray::volume::{RawLayout, ReadOptions, Volume, VoxelType, read};
use glam::{DAffine3, DMat3, DVec3};

const SPACING: DVec3 = DVec3::new(0.5, 0.75, 2.0);
const ORIGIN: DVec3 = DVec3::new(10.0, -20.0, 30.5);

fn oblique() -> DMat3 {
    DMat3::from_rotation_z(0.3) * DMat3::from_rotation_x(0.5)
}

/// x runs to +z, y to -x, z to +y of the world.
const LEFT_HANDED: DMat3 = DMat3::from_cols(DVec3::Z, DVec3::NEG_X, DVec3::Y);

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/volumes")
        .join(name)
}

fn frame(frame: u32) -> ReadOptions {
    ReadOptions {
        frame,
        ..ReadOptions::default()
    }
}

fn read_fixture(name: &str, options: &ReadOptions) -> Volume {
    read(&fixture(name), options, &Silent).unwrap_or_else(|error| panic!("{error}"))
}

/// What a fixture should read as: physical value = x + 10 y + 100 z + offset.
#[derive(Clone, Copy)]
struct Expected {
    dims: [u32; 3],
    voxel_type: VoxelType,
    offset: f64,
    world_from_index: DAffine3,
}

impl Expected {
    /// The usual ramp in i16.
    fn ramp(direction: DMat3, spacing: DVec3, origin: DVec3) -> Self {
        Self {
            dims: [5, 4, 3],
            voxel_type: VoxelType::I16,
            offset: -30_000.0,
            world_from_index: DAffine3 {
                matrix3: direction * DMat3::from_diagonal(spacing),
                translation: origin,
            },
        }
    }

    fn placed(direction: DMat3) -> Self {
        Self::ramp(direction, SPACING, ORIGIN)
    }

    fn nowhere() -> Self {
        Self::ramp(DMat3::IDENTITY, DVec3::ONE, DVec3::ZERO)
    }

    fn of(self, voxel_type: VoxelType, offset: f64) -> Self {
        Self {
            voxel_type,
            offset,
            ..self
        }
    }

    /// The first difference: the judge of all tests here.
    fn difference(&self, volume: &Volume) -> Option<String> {
        let dims = volume.dims().array();
        if dims != self.dims {
            return Some(format!("dims {dims:?}"));
        }
        if volume.voxels().voxel_type() != self.voxel_type {
            return Some(format!("type {}", volume.voxels().voxel_type()));
        }
        let found = volume.geometry().world_from_index();
        // Headers in single precision (NIfTI-1) keep seven digits.
        let columns = |a: DAffine3| [a.x_axis, a.y_axis, a.z_axis, a.translation];
        for (found, expected) in columns(found)
            .into_iter()
            .zip(columns(self.world_from_index))
        {
            if found.distance(expected) > 1e-6 * (1.0 + expected.length()) {
                return Some(format!("geometry {found} instead of {expected}"));
            }
        }
        let [nx, ny, nz] = self.dims;
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    let index = (x + nx * (y + ny * z)) as usize;
                    let found = volume.rescale().physical(volume.voxels().stored(index));
                    let expected = f64::from(x + 10 * y + 100 * z) + self.offset;
                    if found != expected {
                        return Some(format!("({x},{y},{z}) is {found} instead of {expected}"));
                    }
                }
            }
        }
        None
    }

    fn check_with(&self, name: &str, options: &ReadOptions) {
        if let Some(difference) = self.difference(&read_fixture(name, options)) {
            panic!("{name}: {difference}");
        }
    }

    fn check(&self, name: &str) {
        self.check_with(name, &ReadOptions::default());
    }
}

/// Each stored type, the type it is read as, and the fixtures' offset.
const TYPES: [(&str, VoxelType, f64); 10] = [
    ("u8", VoxelType::U8, 20.0),
    ("i8", VoxelType::F32, -110.0),
    ("u16", VoxelType::U16, 60_000.0),
    ("i16", VoxelType::I16, -30_000.0),
    ("u32", VoxelType::F32, 3_000_000.0),
    ("i32", VoxelType::F32, -2_000_000.0),
    ("u64", VoxelType::F32, 5_000_000.0),
    ("i64", VoxelType::F32, -6_000_000.0),
    ("f32", VoxelType::F32, 0.25),
    ("f64", VoxelType::F32, -0.125),
];

#[test]
fn the_judge_sees_every_kind_of_difference() {
    let volume = read_fixture("sitk_oblique.nrrd", &ReadOptions::default());
    let right = Expected::placed(oblique());
    assert_eq!(right.difference(&volume), None);
    let wrong = [
        Expected {
            dims: [4, 5, 3],
            ..right
        },
        right.of(VoxelType::U16, right.offset),
        right.of(VoxelType::I16, right.offset + 1.0),
        Expected::placed(oblique().transpose()),
        Expected::placed(LEFT_HANDED),
        Expected::ramp(oblique(), SPACING * 1.001, ORIGIN),
        Expected::ramp(oblique(), SPACING, -ORIGIN),
    ];
    for wrong in wrong {
        assert!(wrong.difference(&volume).is_some());
    }
}

#[test]
fn every_number_type_of_every_format() {
    for (name, voxel_type, offset) in TYPES {
        let placed = Expected::placed(DMat3::IDENTITY).of(voxel_type, offset);
        placed.check(&format!("sitk_{name}.nrrd"));
        placed.check(&format!("sitk_{name}.mha"));
        let placed = Expected::placed(oblique()).of(voxel_type, offset);
        placed.check(&format!("nib1_{name}.nii"));
        placed.check(&format!("nib2_{name}.nii.gz"));
        Expected::nowhere()
            .of(voxel_type, offset)
            .check(&format!("np_{name}.npy"));
    }
}

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
fn flat_images_are_volumes_of_one_slice() {
    let flat = Expected {
        dims: [5, 4, 1],
        ..Expected::ramp(
            DMat3::IDENTITY,
            DVec3::new(0.5, 0.75, 1.0),
            DVec3::new(10.0, -20.0, 0.0),
        )
    }
    .of(VoxelType::I16, -29_900.0);
    flat.check("sitk_flat.nrrd");
    flat.check("sitk_flat.mha");
    Expected {
        world_from_index: DAffine3::IDENTITY,
        ..flat
    }
    .check("np_flat.npy");
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
fn frames_are_picked_wherever_their_axis_stands() {
    let cases = [
        ("sitk_series.nrrd", 3, Expected::nowhere()),
        ("sitk_series.mha", 3, Expected::nowhere()),
        ("sitk_two.nrrd", 2, Expected::placed(DMat3::IDENTITY)),
        ("sitk_two.mha", 2, Expected::placed(DMat3::IDENTITY)),
        ("pynrrd_list_first.nrrd", 3, Expected::placed(oblique())),
        ("pynrrd_time_first.nrrd", 3, Expected::placed(oblique())),
        ("pynrrd_time_third.nrrd", 3, Expected::nowhere()),
        ("pynrrd_series.nrrd", 3, Expected::nowhere()),
        ("nib_series.nii.gz", 3, Expected::placed(oblique())),
        ("np_series.npy", 3, Expected::nowhere()),
        ("np_series_fortran.npy", 3, Expected::nowhere()),
    ];
    for (name, frames, expected) in cases {
        for t in 0..frames {
            let expected = expected.of(VoxelType::I16, f64::from(1000 * t));
            expected.check_with(name, &frame(t));
            let notes = read_fixture(name, &frame(t)).notes().join("\n");
            assert!(
                notes.contains(&format!("frame {t} of {frames}")),
                "{name}: {notes}"
            );
        }
        let error = read(&fixture(name), &frame(frames), &Silent).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage, "{error}");
        assert!(error.to_string().contains(&format!("0 to {}", frames - 1)));
    }
    let error = read(&fixture("sitk_u8.nrrd"), &frame(1), &Silent).unwrap_err();
    assert!(error.to_string().contains("one volume"), "{error}");
}

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

#[test]
fn contents_count_and_names_do_not() {
    for name in ["wrapped.mha.gz", "really_nrrd.nii", "really_nifti.raw"] {
        Expected::placed(oblique()).check(name);
    }
    Expected::placed(DMat3::IDENTITY).check("wrapped.nrrd.gz");
    Expected::placed(oblique()).check("members.nii.gz");
}

#[test]
fn plain_native_voxels_stay_in_the_file() {
    let is_mapped = |name: &str, options: &ReadOptions| {
        format!("{:?}", read_fixture(name, options).voxels()).contains("mapped")
    };
    if cfg!(target_endian = "little") {
        assert!(is_mapped("sitk_detached.mhd", &ReadOptions::default()));
        assert!(is_mapped("np_f32.npy", &ReadOptions::default()));
        assert!(is_mapped("np_series.npy", &frame(2)));
    }
    assert!(!is_mapped(
        "ramp_5x4x3_uint16be.raw",
        &ReadOptions::default()
    ));
    assert!(!is_mapped(
        "ramp_5x4x3_int16.raw.gz",
        &ReadOptions::default()
    ));
    assert!(!is_mapped("np_i32.npy", &ReadOptions::default()));
}
