//! Headers as programs in the field write them, and what ITK (or the NIfTI library) makes of them.

use std::fs::{self, File};
use std::path::Path;

use angioray::progress::Silent;
use angioray::volume::{Geometry, ReadOptions, Volume, VoxelType, read};
use glam::{DMat3, DVec3};

const SPACING: DVec3 = DVec3::new(0.7, 0.8, 1.5);
const ORIGIN: DVec3 = DVec3::new(10.0, -20.0, 30.0);

fn case(name: &str) -> Volume {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/cases");
    read(&folder.join(name), &ReadOptions::default(), &Silent)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// A file written here and read at once.
fn written(name: &str, contents: &[u8]) -> Result<Volume, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, contents).unwrap();
    let options = ReadOptions::default();
    read(&path, &options, &Silent).map_err(|error| error.to_string())
}

fn lies_at(volume: &Volume, origin: DVec3, direction: DMat3, spacing: DVec3) -> bool {
    let right = Geometry::new(origin, direction, spacing)
        .unwrap()
        .world_from_index();
    let found = volume.geometry().world_from_index();
    let ends = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    ends.iter().all(|&p| {
        found
            .transform_point3(p)
            .distance(right.transform_point3(p))
            < 1e-5
    })
}

/// The cases' voxels: their size and range, and four in a row as SimpleITK reads them.
fn is_the_ball(volume: &Volume) -> bool {
    let at = |x: usize, y: usize, z: usize| volume.voxels().stored(x + 20 * (y + 16 * z));
    let range = volume.range();
    volume.dims().array() == [20, 16, 12]
        && volume.voxels().voxel_type() == VoxelType::I16
        && (range.min, range.max) == (-100.0, 200.0)
        && [5, 6, 7, 8].map(|x| at(x, 4, 3)) == [0.0, 1.0, 27.0, 53.0]
}

#[test]
fn metaimage_keys_may_be_anything() {
    for name in ["dicomtags.mha", "usertags.mha", "spacekey.mha"] {
        let volume = case(name);
        assert!(is_the_ball(&volume), "{name}");
        assert!(lies_at(&volume, ORIGIN, DMat3::IDENTITY, SPACING), "{name}");
    }
    // The same with what else MetaIO takes: ':' for '=', comments, empty lines, bytes that are no
    // UTF-8, CRLF, tabs, words that it does not know.
    let header =
        b"# made by hand\r\nObjectType = Image\r\n\r\nNDims : 3\r\nM\xfcller's note = \xe4\xf6\r\n\
        only words\r\nDimSize\t=\t2 1 1\r\nElementType: MET_UCHAR\r\nPosition = 1 2 3\r\n\
        0008|0030 = 10:20:30\r\nElementSize = 4 5 6\r\nElementDataFile = LOCAL\r\n";
    let volume = written("a.mha", &[&header[..], &[7, 9]].concat()).unwrap();
    assert_eq!([0, 1].map(|i| volume.voxels().stored(i)), [7.0, 9.0]);
    let (origin, spacing) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0));
    assert!(lies_at(&volume, origin, DMat3::IDENTITY, spacing));
}

#[test]
fn a_metaimage_without_data_file_is_refused_in_true_words() {
    let header = "ObjectType = Image\nNDims = 3\nDimSize = 2 1 1\nElementType = MET_UCHAR\n";
    let short = written("a.mha", header.as_bytes()).unwrap_err();
    assert!(short.contains("ends without 'ElementDataFile'"), "{short}");
    let long = format!("{header}{}", "Comment = more\n".repeat(80_000));
    let long = written("a.mha", long.as_bytes()).unwrap_err();
    assert!(
        long.contains("no 'ElementDataFile' in its first 1048576 bytes"),
        "{long}"
    );
}

#[test]
fn negative_spacings_turn_their_axis_round() {
    let volume = case("negsp.mha");
    let turned = DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
    assert!(is_the_ball(&volume));
    assert!(lies_at(&volume, ORIGIN, turned, SPACING));
    // The control: the comparison sees the turn.
    assert!(!lies_at(&volume, ORIGIN, DMat3::IDENTITY, SPACING));
    let header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 1 1\nspacings: -0.7 0.8 -1.5\nencoding: raw\n\n\x01\x02";
    let volume = written("a.nrrd", header.as_bytes()).unwrap();
    let turned = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, -1.0));
    assert!(lies_at(&volume, DVec3::ZERO, turned, SPACING));
    let none = header.replace("-0.7", "0");
    assert!(written("a.nrrd", none.as_bytes()).is_err());
}

#[test]
fn axes_of_none_are_read_as_the_nifti_library_does() {
    let volume = case("dim4zero.nii");
    assert!(is_the_ball(&volume));
    assert!(lies_at(&volume, ORIGIN, DMat3::IDENTITY, SPACING));
    assert!(volume.notes().is_empty(), "{:?}", volume.notes());
    // The first axis must have voxels.
    let name = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/cases/dim4zero.nii");
    let mut bytes = fs::read(name).unwrap();
    bytes[42] = 0;
    assert!(written("a.nii", &bytes).is_err());
}

#[test]
fn an_sform_that_disagrees_is_reported_with_its_distance() {
    let volume = case("pixconflict.nii");
    assert!(is_the_ball(&volume));
    assert!(lies_at(&volume, ORIGIN, DMat3::IDENTITY, SPACING));
    // 19 · 2.3, 15 · 2.2 and 11 · 1.5 mm.
    let apart = (19.0_f64 * 2.3).hypot(15.0 * 2.2).hypot(11.0 * 1.5);
    assert_eq!(
        volume.notes(),
        [format!(
            "the file's sform (voxels of 0.7 x 0.8 x 1.5 mm) and its voxel sizes (pixdim) (3 x 3 x 3 mm) place the volume differently, its corners up to {:.3} mm apart: the sform is taken",
            apart
        )]
    );
    // A qform that shifts the volume by 7 mm; and one that agrees, as the control.
    let name = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/cases/dim4zero.nii");
    let mut bytes = fs::read(name).unwrap();
    let shifted = |bytes: &[u8]| written("a.nii", bytes).unwrap().notes().join("\n");
    assert_eq!(shifted(&bytes), "");
    let put = |bytes: &mut Vec<u8>, at: usize, value: f32| {
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
    };
    put(&mut bytes, 276, 37.0);
    let note = shifted(&bytes);
    assert!(
        note.contains("and the qform (0.7 x 0.8 x 1.5 mm)"),
        "{note}"
    );
    assert!(note.contains("up to 7 mm apart"), "{note}");
}

#[test]
fn nrrd_bytes_may_be_written_in_hexadecimal() {
    let volume = case("hex.nrrd");
    assert!(is_the_ball(&volume));
    assert!(lies_at(&volume, DVec3::ZERO, DMat3::IDENTITY, SPACING));
    let header = "NRRD0004\ntype: uint16\ndimension: 1\nsizes: 2\nencoding: hex\nendian: big\n\n";
    let volume = written("a.nrrd", format!("{header}01 02fF\n00").as_bytes()).unwrap();
    assert_eq!([0, 1].map(|i| volume.voxels().stored(i)), [258.0, 65_280.0]);
    for (digits, says) in [
        ("0102ff", "after 3 of 4 bytes"),
        ("0102xx00", "'x' is not a hex"),
    ] {
        let error = written("a.nrrd", format!("{header}{digits}").as_bytes()).unwrap_err();
        assert!(error.contains(says), "{error}");
    }
}

#[test]
fn whole_numbers_of_headers_have_64_bits() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("far.raw");
    let file = File::create(&data).unwrap();
    // 2^31 bytes that take no room, then 64 of zeros.
    file.set_len((1 << 31) + 64).unwrap();
    let header = |skip: &str| {
        let path = folder.path().join("far.nhdr");
        let rest = "data file: far.raw\n";
        let text = format!(
            "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\nbyte skip: {skip}\n{rest}"
        );
        fs::write(&path, text).unwrap();
        read(&path, &ReadOptions::default(), &Silent).map_err(|error| error.to_string())
    };
    let volume = header("2147483648").unwrap();
    assert_eq!(volume.dims().array(), [4, 4, 4]);
    assert!(volume.notes().is_empty(), "{:?}", volume.notes());
    let beyond = header("2147483649").unwrap_err();
    assert!(
        beyond.contains("64 bytes of voxels announced, but only 63 are there"),
        "{beyond}"
    );
    for (skip, says) in [
        ("99999999999999999999", "is not a whole number of 64 bits"),
        ("-2", "'byte skip: -2' makes no sense"),
        (
            "9000000000000000000",
            "should start 9000000000000000000 bytes in",
        ),
    ] {
        let error = header(skip).unwrap_err();
        assert!(error.contains(says), "{error}");
    }
}
