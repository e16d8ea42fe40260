//! The NRRD writer, its files taken apart by hand.

use std::collections::HashMap;
use std::fs;
use std::io::Read;
use std::path::Path;

use angioray::error::ErrorKind;
use angioray::extent::Dims;
use angioray::progress::Silent;
use angioray::volume::{
    Geometry, NonFinite, PhantomKind, ReadOptions, Rescale, Volume, VoxelType, Voxels, phantom,
    read, write_nrrd,
};
use flate2::read::GzDecoder;
use glam::{DMat3, DVec3};

use super::spec;

/// Header fields by name, and the data's bytes as they lie in the file.
fn parse(path: &Path) -> (HashMap<String, String>, Vec<u8>) {
    let bytes = fs::read(path).unwrap();
    let end = bytes.windows(2).position(|two| two == b"\n\n").unwrap();
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    let mut lines = header.lines();
    assert_eq!(lines.next(), Some("NRRD0005"));
    let fields = lines.map(|line| {
        let (name, value) = line.split_once(": ").unwrap();
        (name.to_owned(), value.to_owned())
    });
    (fields.collect(), bytes[end + 2..].to_vec())
}

fn oblique() -> Geometry {
    let direction = DMat3::from_cols(DVec3::NEG_Y, DVec3::new(0.6, 0.0, 0.8), DVec3::X);
    Geometry::new(
        DVec3::new(-1.5, 2e5, 1e-7),
        direction,
        DVec3::new(0.5, 2.0, 3.0),
    )
    .unwrap()
}

#[test]
fn headers_and_data_say_what_the_volume_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a volume.nrrd");
    for (voxel_type, name) in [
        (VoxelType::U8, "uint8"),
        (VoxelType::U16, "uint16"),
        (VoxelType::I16, "int16"),
        (VoxelType::F32, "float"),
    ] {
        for gzip in [false, true] {
            let mut spec = spec(PhantomKind::Noise, [7, 5, 3]);
            spec.voxel_type = voxel_type;
            spec.spacing_mm = DVec3::new(0.25, 1.0, 3.5);
            let volume = phantom(&spec).unwrap().volume;
            // The second pass overwrites the first one's file.
            write_nrrd(&volume, &path, gzip).unwrap();
            let (fields, mut data) = parse(&path);
            let expected = [
                ("type", name),
                ("dimension", "3"),
                ("space", "left-posterior-superior"),
                ("sizes", "7 5 3"),
                ("space directions", "(0.25,0,0) (0,1,0) (0,0,3.5)"),
                ("kinds", "domain domain domain"),
                ("endian", "little"),
                ("encoding", if gzip { "gzip" } else { "raw" }),
                ("space origin", "(-0.75,-2,-3.5)"),
            ];
            assert_eq!(fields.len(), expected.len());
            for (field, value) in expected {
                assert_eq!(fields[field], value, "{field}");
            }
            if gzip {
                let mut inflated = Vec::new();
                GzDecoder::new(&data[..])
                    .read_to_end(&mut inflated)
                    .unwrap();
                data = inflated;
            }
            let mut little: Vec<u8> = Vec::new();
            match volume.voxels() {
                Voxels::U8(v) => little.extend_from_slice(v),
                Voxels::U16(v) => v.iter().for_each(|v| little.extend(v.to_le_bytes())),
                Voxels::I16(v) => v.iter().for_each(|v| little.extend(v.to_le_bytes())),
                Voxels::F32(v) => v.iter().for_each(|v| little.extend(v.to_le_bytes())),
            }
            assert!(data == little);
            little.reverse();
            assert!(data != little);
        }
    }
}

#[test]
fn oblique_geometry_is_written_to_the_last_digit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("oblique.nrrd");
    let make = |rescale| {
        let dims = Dims::new([2, 1, 1]).unwrap();
        Volume::new(
            dims,
            vec![1_u8, 3].into(),
            oblique(),
            rescale,
            NonFinite::Refuse,
        )
        .unwrap()
    };
    write_nrrd(&make(Rescale::IDENTITY), &path, false).unwrap();
    let (fields, data) = parse(&path);
    let numbers = |text: &str| -> Vec<f64> {
        let split = text
            .split(['(', ')', ',', ' '])
            .filter(|part| !part.is_empty());
        split.map(|number| number.parse().unwrap()).collect()
    };
    let matrix = oblique().world_from_index().matrix3;
    assert_eq!(numbers(&fields["space directions"]), matrix.to_cols_array());
    assert_ne!(
        numbers(&fields["space directions"]),
        matrix.transpose().to_cols_array()
    );
    assert_eq!(numbers(&fields["space origin"]), [-1.5, 2e5, 1e-7]);
    assert_eq!(data, [1, 3]);

    // Calibrated volumes are written calibrated.
    let rescale = Rescale {
        slope: 2.5,
        intercept: -1000.0,
    };
    write_nrrd(&make(rescale), &path, false).unwrap();
    let (fields, data) = parse(&path);
    assert_eq!(fields["type"], "float");
    let floats: Vec<f32> = data
        .chunks(4)
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(floats, [-997.5, -992.5]);
}

/// Values far from zero do not fit single precision: they are written, and read, as doubles.
#[test]
fn values_far_from_zero_keep_their_digits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("far.nrrd");
    for (intercept, kind) in [(1e9, "double"), (-1000.0, "float")] {
        let rescale = Rescale {
            slope: 0.1,
            intercept,
        };
        let voxels: Vec<i16> = vec![0, 1, 500, 1026];
        let (dims, geometry) = (Dims::new([4, 1, 1]).unwrap(), Geometry::default());
        let volume = Volume::new(
            dims,
            voxels.clone().into(),
            geometry,
            rescale,
            NonFinite::Refuse,
        )
        .unwrap();
        write_nrrd(&volume, &path, false).unwrap();
        assert_eq!(parse(&path).0["type"], kind);
        let back = read(&path, &ReadOptions::default(), &Silent).unwrap();
        for (i, &voxel) in voxels.iter().enumerate() {
            let found = back.rescale().physical(back.voxels().stored(i));
            let right = 0.1 * f64::from(voxel) + intercept;
            assert!(
                (found - right).abs() < 1e-4,
                "{intercept}: {found} for {right}"
            );
        }
    }
}

#[test]
fn a_failed_write_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let volume = phantom(&spec(PhantomKind::Voxel, [3, 3, 3]))
        .unwrap()
        .volume;
    let entries = || fs::read_dir(folder.path()).unwrap().count();
    let taken = folder.path().join("taken");
    fs::create_dir(&taken).unwrap();
    for path in [
        taken.clone(),
        folder.path().join("missing/a.nrrd"),
        "/".into(),
        "".into(),
    ] {
        let error = write_nrrd(&volume, &path, false).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Resource, "{error}");
    }
    assert_eq!(entries(), 1);
    write_nrrd(&volume, &folder.path().join("good.nrrd"), true).unwrap();
    assert_eq!(entries(), 2);
}

#[cfg(unix)]
#[test]
fn the_file_is_as_readable_as_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    let [written, plain, private] = ["a.nrrd", "b", "c"].map(|name| folder.path().join(name));
    let volume = phantom(&spec(PhantomKind::Voxel, [3, 3, 3]))
        .unwrap()
        .volume;
    write_nrrd(&volume, &written, false).unwrap();
    fs::write(&plain, "").unwrap();
    tempfile::NamedTempFile::new_in(folder.path())
        .unwrap()
        .persist(&private)
        .unwrap();
    assert_eq!(mode(&written), mode(&plain));
    assert_ne!(mode(&private), mode(&plain));
}
