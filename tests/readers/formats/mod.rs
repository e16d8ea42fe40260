//! Volume files written by SimpleITK, nibabel, pynrrd and NumPy (tests/data/make_volumes.py), read
//! and compared with what was put in: the ramp's formula and the geometry, in LPS.

mod arrays;
mod cases;
mod images;

use std::path::{Path, PathBuf};

use angioray::error::ErrorKind;
use angioray::progress::Silent;
use angioray::volume::{ReadOptions, Volume, VoxelType, read};
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

    /// The first difference, by which all tests here decide.
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
fn the_comparison_sees_every_kind_of_difference() {
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
