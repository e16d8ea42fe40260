//! What reading a volume file says besides the volume: refusals, notes, progress.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use angioray::progress::{Progress, Silent};
use angioray::volume::{NonFinite, ReadOptions, read};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/volumes")
        .join(name)
}

/// The message and the hint of reading `name`.
fn refusal(name: &str) -> String {
    let error = read(&fixture(name), &ReadOptions::default(), &Silent)
        .expect_err(&format!("{name} should be refused"));
    assert!(error.to_string().contains(name), "{error}");
    format!("{error}\n{}", error.hint_text().unwrap_or(""))
}

#[test]
fn what_is_not_supported_is_reported() {
    for name in [
        "sitk_rgb.nrrd",
        "sitk_rgb.mha",
        "nib_rgb.nii.gz",
        "np_rgb.npy",
    ] {
        assert!(
            refusal(name).contains("colour and vector volumes"),
            "{name}"
        );
    }
    assert!(refusal("np_complex.npy").contains("<c8"));
    assert!(refusal("np_none.npz").contains("spacing [3]"));
}

#[test]
fn unusable_paths_and_foreign_formats_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let message = |name: &str, contents: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, contents).unwrap();
        let error = read(&path, &ReadOptions::default(), &Silent).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        format!("{error}\n{}", error.hint_text().unwrap_or(""))
    };
    assert!(message("empty.nrrd", b"").contains("empty"));
    let mut dicom = vec![0; 200];
    dicom[128..132].copy_from_slice(b"DICM");
    assert!(message("a.dcm", &dicom).contains("DICOM"));
    assert!(message("a.tif", b"II*\0abcd").contains("TIFF"));
    assert!(message("a.png", b"\x89PNG\r\n\x1a\nabcd").contains("PNG"));
    assert!(message("a.vtk", b"# vtk DataFile Version 3.0\n").contains("legacy VTK"));
    assert!(
        message(
            "a.vti",
            b"<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\">"
        )
        .contains("VTK XML")
    );
    assert!(message("a.h5", b"\x89HDF\r\n\x1a\n").contains("HDF5"));
    assert!(
        message("a.zip", b"PK\x05\x06\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0")
            .contains("without NumPy")
    );
    // A cube is guessed at in the hint, and only there.
    assert!(message("cube.raw", &[7; 27]).contains("--raw-size 3x3x3 --raw-type u8"));
    assert!(message("cube.raw", &[7; 54]).contains("--raw-size 3x3x3 --raw-type u16"));
    assert!(!message("no_cube.raw", &[7; 55]).contains("would fit"));
    assert!(message("lonely.hdr", &fs::read(fixture("nib_pair.hdr")).unwrap()).contains("no .img"));

    let missing = read(
        &folder.path().join("none.nii"),
        &ReadOptions::default(),
        &Silent,
    );
    assert!(
        missing
            .unwrap_err()
            .to_string()
            .ends_with("none.nii: there is no such file")
    );
    let is_folder = read(folder.path(), &ReadOptions::default(), &Silent).unwrap_err();
    assert!(is_folder.to_string().contains("folder"), "{is_folder}");
}

#[test]
fn lost_digits_and_ignored_bytes_are_noted_once() {
    let folder = tempfile::tempdir().unwrap();
    let notes = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        read(&path, &ReadOptions::default(), &Silent)
            .unwrap_or_else(|error| panic!("{error}"))
            .notes()
            .to_vec()
    };
    let bytes = |numbers: [i32; 4]| numbers.map(i32::to_le_bytes).concat();
    let lossy = notes("a_2x2x1_int32.raw", &bytes([1, 16_777_217, 1 << 30, 4]));
    assert_eq!(lossy.len(), 1, "{lossy:?}");
    assert_eq!(
        lossy[0],
        "1 of 4 voxels lose digits as f32 (the file has i32): at most 1.0e0, which is 9.3e-10 of the value range"
    );
    assert!(notes("a_2x2x1_int32.raw", &bytes([1, 16_777_216, -5, 4])).is_empty());
    // Counted from their middle these lose nothing.
    assert!(notes("a_2x2x1_int32.raw", &bytes([1, 16_777_217, 16_777_219, 4])).is_empty());
    let longer = notes("a_2x2x1_uint8.raw", &[1, 2, 3, 4, 5]);
    assert!(longer[0].contains("1 bytes after"), "{longer:?}");
}

#[test]
fn non_finite_voxels_are_replaced_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a_2x2x1_float32.raw");
    let numbers = [f32::NAN, -3.0, f32::INFINITY, 4.0];
    fs::write(&path, numbers.map(f32::to_le_bytes).concat()).unwrap();
    let volume = read(&path, &ReadOptions::default(), &Silent).unwrap();
    assert_eq!(volume.non_finite(), 2);
    assert_eq!(volume.voxels().stored(0), -3.0);
    let refuse = ReadOptions {
        non_finite: NonFinite::Refuse,
        ..ReadOptions::default()
    };
    assert!(read(&path, &refuse, &Silent).is_err());
}

#[test]
fn progress_counts_the_bytes_of_the_volume() {
    #[derive(Default)]
    struct Heard {
        begun: Mutex<Vec<(String, u64)>>,
        advanced: AtomicU64,
        ended: AtomicU64,
    }
    impl Progress for Heard {
        fn begin(&self, name: &str, total: u64) {
            self.begun.lock().unwrap().push((name.into(), total));
        }
        fn advance(&self, units: u64) {
            self.advanced.fetch_add(units, Relaxed);
        }
        fn end(&self) {
            self.ended.fetch_add(1, Relaxed);
        }
    }
    for name in ["sitk_i16.nrrd", "nib2_i16.nii.gz", "np_fortran.npy"] {
        let heard = Heard::default();
        read(&fixture(name), &ReadOptions::default(), &heard).unwrap();
        let begun = heard.begun.into_inner().unwrap();
        assert_eq!(begun, [("reading".to_owned(), 120)], "{name}");
        assert_eq!(heard.advanced.into_inner(), 120, "{name}");
        assert_eq!(heard.ended.into_inner(), 1, "{name}");
    }
}

#[test]
fn an_extreme_calibration_is_applied_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("extreme.nii");
    let mut bytes = fs::read(fixture("slope_falling.nii")).unwrap();
    let mut with_slope = |slope: f32| {
        bytes[112..116].copy_from_slice(&slope.to_le_bytes());
        fs::write(&path, &bytes).unwrap();
        read(&path, &ReadOptions::default(), &Silent).map(|volume| volume.range())
    };
    let range = with_slope(-1e36).unwrap();
    assert_eq!(range.min, f64::from(-1e36f32) * 254.0 + 3.0);
    assert_eq!(range.max, f64::from(-1e36f32) * 20.0 + 3.0);
    // The same header, another slope: the figures above are not there by themselves.
    assert_ne!(with_slope(-1.0).unwrap(), range);
    // Beyond single precision there is no picture to be had.
    assert_eq!(with_slope(-3e38).unwrap_err().exit_code(), 65);
}
