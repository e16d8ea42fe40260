//! EXR and NPY: every layer, exactly, and the names of their channels.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use angioray::frame::{
    CERTIFICATE, COC, COVERAGE, DEPTH, Encoding, Format, Frame, KIND, Layer, NODES, NORMAL,
    OCCLUSION, OCCLUSION_BOUND, STEPS, THICK, VALUE, VISIBILITY, channels, write,
};

use super::{METADATA, all_layers, picture};

/// The channel of [`picture`] with that name, straight from its planes.
fn plane(frame: &Frame, name: &str) -> Vec<f32> {
    let count = |key| {
        frame
            .plane(key)
            .unwrap()
            .iter()
            .map(|n| *n as f32)
            .collect()
    };
    let normal = |i: usize| {
        frame
            .plane(NORMAL)
            .into_iter()
            .flatten()
            .map(|n| n[i])
            .collect()
    };
    match name {
        "R" => frame.color.iter().map(|c| c[0]).collect(),
        "G" => frame.color.iter().map(|c| c[1]).collect(),
        "B" => frame.color.iter().map(|c| c[2]).collect(),
        "A" => frame.color.iter().map(|c| c[3]).collect(),
        "depth.Z" => frame.plane(DEPTH).unwrap().to_vec(),
        "normal.X" => normal(0),
        "normal.Y" => normal(1),
        "normal.Z" => normal(2),
        "value.V" => frame.plane(VALUE).unwrap().to_vec(),
        "steps.N" => count(STEPS),
        "nodes.N" => count(NODES),
        "kind.V" => count(KIND),
        "certificate.V" => count(CERTIFICATE),
        "coverage.V" => frame.plane(COVERAGE).unwrap().to_vec(),
        "occlusion.V" => frame.plane(OCCLUSION).unwrap().to_vec(),
        "occlusion_bound.V" => frame.plane(OCCLUSION_BOUND).unwrap().to_vec(),
        "visibility.V" => frame.plane(VISIBILITY).unwrap().to_vec(),
        "thick.V" => frame.plane(THICK).unwrap().to_vec(),
        "coc.V" => frame.plane(COC).unwrap().to_vec(),
        "cast.V" => vec![1.0; frame.size.pixels()],
        other => panic!("no channel {other}"),
    }
}

/// All f32 channels of an EXR by name, and the number of its parts.
fn read_exr(path: &Path) -> (BTreeMap<String, Vec<f32>>, usize) {
    use exr::prelude::*;
    let image = read_all_flat_layers_from_file(path).unwrap();
    let channels = image.layer_data[0]
        .channel_data
        .list
        .iter()
        .map(|channel| match &channel.sample_data {
            FlatSamples::F32(samples) => (channel.name.to_string(), samples.clone()),
            other => panic!("{} is not f32: {other:?}", channel.name),
        })
        .collect();
    (channels, image.layer_data.len())
}

#[test]
fn exr_holds_every_layer_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let frame = picture();
    write(&path, &frame, &all_layers(Format::Exr), &METADATA).unwrap();

    let (read, parts) = read_exr(&path);
    assert_eq!(parts, 1);
    let mut names = channels(&all_layers(Format::Exr));
    names.sort();
    assert_eq!(read.keys().cloned().collect::<Vec<_>>(), names);
    assert_eq!(names.len(), 20);
    for (name, samples) in &read {
        let bits = |s: &[f32]| s.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(samples), bits(&plane(&frame, name)), "{name}");
    }
    assert_eq!(read["depth.Z"][0], f32::INFINITY);
    assert_eq!(read["depth.Z"][13], 246.912);
    assert_eq!(read["nodes.N"][1], 16_777_215.0);
    // Channels are distinguished: zeros are not compared with zeros.
    assert_ne!(read["R"], read["G"]);
    assert_ne!(read["normal.X"], read["normal.Y"]);

    let meta = exr::meta::MetaData::read_from_file(&path, true).unwrap();
    let header = &meta.headers[0];
    assert!(header.compression == exr::compression::Compression::ZIP16);
    let texts: Vec<_> = header
        .own_attributes
        .other
        .keys()
        .map(|k| k.to_string())
        .collect();
    assert_eq!(texts.len(), 2);
    assert!(texts.contains(&"scene".to_owned()), "{texts:?}");
    assert!(texts.contains(&"angioray.version".to_owned()), "{texts:?}");
}

#[test]
fn exr_without_layers_is_the_colour_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write(&path, &picture(), &Encoding::new(Format::Exr), &[]).unwrap();
    let (read, _) = read_exr(&path);
    assert_eq!(read.keys().collect::<Vec<_>>(), ["A", "B", "G", "R"]);
}

#[test]
fn npy_has_numpys_header_and_the_channels_last() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npy");
    let frame = picture();
    let encoding = all_layers(Format::Npy);
    write(&path, &frame, &encoding, &METADATA).unwrap();
    let bytes = fs::read(&path).unwrap();

    // As numpy 2.4 writes np.zeros((3, 5, 20), '<f4').
    let mut expected = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    expected.extend(b"{'descr': '<f4', 'fortran_order': False, 'shape': (3, 5, 20), }");
    expected.resize(127, b' ');
    expected.push(b'\n');
    assert_eq!(bytes[..128], expected);

    let names = channels(&encoding);
    let values: Vec<_> = bytes[128..]
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(values.len(), 3 * 5 * 20);
    for (channel, name) in names.iter().enumerate() {
        let samples: Vec<_> = values
            .iter()
            .skip(channel)
            .step_by(names.len())
            .copied()
            .collect();
        assert_eq!(samples, plane(&frame, name), "{name}");
    }
}

#[test]
fn channel_names_keep_one_order() {
    let shuffled = Encoding {
        layers: vec![Layer::Kind, Layer::Depth, Layer::Normal, Layer::Depth],
        ..Encoding::new(Format::Npy)
    };
    assert_eq!(
        channels(&shuffled),
        [
            "R", "G", "B", "A", "depth.Z", "normal.X", "normal.Y", "normal.Z", "kind.V"
        ]
    );
    assert_eq!(
        channels(&all_layers(Format::Exr))[8..],
        [
            "value.V",
            "steps.N",
            "nodes.N",
            "cast.V",
            "kind.V",
            "certificate.V",
            "coverage.V",
            "occlusion.V",
            "occlusion_bound.V",
            "visibility.V",
            "thick.V",
            "coc.V"
        ]
    );
    assert_eq!(channels(&Encoding::new(Format::Jpeg)), ["R", "G", "B"]);
}
