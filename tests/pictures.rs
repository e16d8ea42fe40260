//! Pictures as files: what other decoders read in them, and what happens when they cannot be
//! written.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use angioray::error::ErrorKind;
use angioray::extent::ImageSize;
use angioray::frame::{
    BitDepth, Encoding, Format, Frame, Layer, Wanted, channels, read_metadata, write,
};
use angioray::scene::srgb_from_linear;

const METADATA: [(&str, &str); 2] = [
    ("scene", "mode = \"iso\"\n# Gefäß, Ω ≥ 300 HU\n"),
    ("version", "0.1.0"),
];

/// 5 x 3 with a different number in every place: two hits, the rest nothing.
fn picture() -> Frame {
    let size = ImageSize::new(5, 3).unwrap();
    let mut frame = Frame::nothing_hit(size, Wanted::ALL);
    for (pixel, hit) in [(1, 1.0_f32), (13, 2.0)] {
        frame.color[pixel] = [0.1 * hit, 0.2 * hit, 0.3 * hit, 0.5 * hit];
        frame.depth.as_mut().unwrap()[pixel] = 123.456 * hit;
        frame.normal.as_mut().unwrap()[pixel] = [0.6, -0.8, 0.0];
        frame.value.as_mut().unwrap()[pixel] = -1024.5 * hit;
        frame.steps.as_mut().unwrap()[pixel] = 1000 + pixel as u32;
        frame.nodes.as_mut().unwrap()[pixel] = 16_777_215;
        frame.kind.as_mut().unwrap()[pixel] = 1 + hit as u32;
    }
    for (pixel, display) in frame.display.as_mut().unwrap().iter_mut().enumerate() {
        let level = |add: usize| (((pixel * 17 + add) % 256) as f64 / 255.0) as f32;
        *display = [level(0), level(85), level(170), 1.0];
    }
    frame
}

/// The bytes that [`picture`]'s display plane is made of.
fn picture_rgb8() -> Vec<u8> {
    (0..15)
        .flat_map(|pixel| [0, 85, 170].map(|add| ((pixel * 17 + add) % 256) as u8))
        .collect()
}

fn all_layers(format: Format) -> Encoding {
    Encoding {
        layers: Layer::ALL.to_vec(),
        ..Encoding::new(format)
    }
}

/// The channel of [`picture`] with that name, straight from its planes.
fn plane(frame: &Frame, name: &str) -> Vec<f32> {
    let count = |plane: &Option<Vec<u32>>| plane.iter().flatten().map(|n| *n as f32).collect();
    let normal = |i: usize| frame.normal.iter().flatten().map(|n| n[i]).collect();
    match name {
        "R" => frame.color.iter().map(|c| c[0]).collect(),
        "G" => frame.color.iter().map(|c| c[1]).collect(),
        "B" => frame.color.iter().map(|c| c[2]).collect(),
        "A" => frame.color.iter().map(|c| c[3]).collect(),
        "depth.Z" => frame.depth.clone().unwrap(),
        "normal.X" => normal(0),
        "normal.Y" => normal(1),
        "normal.Z" => normal(2),
        "value.V" => frame.value.clone().unwrap(),
        "steps.N" => count(&frame.steps),
        "nodes.N" => count(&frame.nodes),
        "kind.V" => count(&frame.kind),
        "cast.V" => vec![1.0; frame.size.pixels()],
        other => panic!("no channel {other}"),
    }
}

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
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
    assert_eq!(names.len(), 13);
    for (name, samples) in &read {
        let bits = |s: &[f32]| s.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(samples), bits(&plane(&frame, name)), "{name}");
    }
    assert_eq!(read["depth.Z"][0], f32::INFINITY);
    assert_eq!(read["depth.Z"][13], 246.912);
    assert_eq!(read["nodes.N"][1], 16_777_215.0);
    // Channels are told apart: this is no comparison of zeros.
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

    // As numpy 2.4 writes np.zeros((3, 5, 13), '<f4').
    let mut expected = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    expected.extend(b"{'descr': '<f4', 'fortran_order': False, 'shape': (3, 5, 13), }");
    expected.resize(127, b' ');
    expected.push(b'\n');
    assert_eq!(bytes[..128], expected);

    let names = channels(&encoding);
    let values: Vec<_> = bytes[128..]
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(values.len(), 3 * 5 * 13);
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
        ["value.V", "steps.N", "nodes.N", "cast.V", "kind.V"]
    );
    assert_eq!(channels(&Encoding::new(Format::Jpeg)), ["R", "G", "B"]);
}

fn decode_png(path: &Path) -> (png::Info<'static>, Vec<u8>) {
    let file = std::io::BufReader::new(fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    (reader.info().clone(), bytes)
}

#[test]
fn png_holds_the_display_plane_as_srgb_with_the_metadata() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    write(&path, &picture(), &Encoding::new(Format::Png), &METADATA).unwrap();
    let (info, bytes) = decode_png(&path);
    assert_eq!((info.width, info.height), (5, 3));
    assert_eq!(info.color_type, png::ColorType::Rgb);
    assert_eq!(info.bit_depth, png::BitDepth::Eight);
    assert!(info.srgb.is_some());
    assert_eq!(bytes, picture_rgb8());

    let sixteen = Encoding {
        bit_depth: BitDepth::Sixteen,
        ..Encoding::new(Format::Png)
    };
    write(&path, &picture(), &sixteen, &METADATA).unwrap();
    let (info, bytes) = decode_png(&path);
    assert_eq!(info.bit_depth, png::BitDepth::Sixteen);
    // k/255 is (257 k)/65535: both bytes are k.
    let doubled: Vec<_> = picture_rgb8().iter().flat_map(|k| [*k, *k]).collect();
    assert_eq!(bytes, doubled);
    let texts: Vec<_> = info
        .utf8_text
        .iter()
        .map(|chunk| (chunk.keyword.as_str(), chunk.get_text().unwrap()))
        .collect();
    assert_eq!(texts, METADATA.map(|(key, text)| (key, text.to_owned())));
}

/// A row with a given linear grey at each of 256 pixels, shown through the closed form of
/// IEC 61966-2-1: the byte is the nearest one.
#[test]
fn srgb_levels_are_the_nearest_at_all_256() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ramp.png");
    let size = ImageSize::new(256, 1).unwrap();
    let mut frame = Frame::nothing_hit(size, Wanted::ALL);
    let linear = |level: usize| {
        let v = level as f64 / 255.0;
        if v <= 0.04045 {
            v / 12.92
        } else {
            ((v + 0.055) / 1.055).powf(2.4)
        }
    };
    let grey: Vec<_> = (0..256)
        .map(|k| srgb_from_linear(linear(k)) as f32)
        .collect();
    frame.display = Some(grey.iter().map(|v| [*v, *v, *v, 1.0]).collect());
    write(&path, &frame, &Encoding::new(Format::Png), &[]).unwrap();
    let (_, bytes) = decode_png(&path);
    let expected: Vec<_> = (0..=255_u8).flat_map(|k| [k; 3]).collect();
    assert_eq!(bytes, expected);
    // Writing the linear values instead would be seen.
    frame.display = Some((0..256).map(|k| [linear(k) as f32; 4]).collect());
    write(&path, &frame, &Encoding::new(Format::Png), &[]).unwrap();
    assert_ne!(decode_png(&path).1, expected);
}

#[test]
fn metadata_comes_back_from_png_and_exr_alone() {
    let folder = tempfile::tempdir().unwrap();
    let expected = METADATA.map(|(key, text)| (key.to_owned(), text.to_owned()));
    for name in ["a.png", "a.exr"] {
        let path = folder.path().join(name);
        let encoding = Encoding::new(Format::from_path(&path).unwrap());
        write(&path, &picture(), &encoding, &METADATA).unwrap();
        assert_eq!(read_metadata(&path).unwrap(), expected, "{name}");
        // A file cut short is refused, or gives all; it never panics or makes up a part.
        let whole = fs::read(&path).unwrap();
        let cut = folder.path().join("cut");
        for length in 0..whole.len() {
            fs::write(&cut, &whole[..length]).unwrap();
            match read_metadata(&cut) {
                Ok(pairs) => assert_eq!(pairs, expected, "{name} cut at {length}"),
                Err(error) => assert_eq!(error.exit_code(), 1),
            }
        }
        fs::write(&cut, &whole[..60]).unwrap();
        assert!(read_metadata(&cut).is_err(), "{name}");

        write(&path, &picture(), &encoding, &[]).unwrap();
        assert_eq!(read_metadata(&path).unwrap(), [], "{name}");
    }
    let path = folder.path().join("a.webp");
    write(&path, &picture(), &Encoding::new(Format::WebP), &METADATA).unwrap();
    let said = read_metadata(&path).unwrap_err().to_string();
    assert!(said.contains("neither a PNG nor an EXR"), "{said}");
}

/// Reading ends, with an answer or a sentence, whatever a byte of the header says.
#[test]
fn spoiled_headers_do_not_bring_the_reader_down() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "a.exr"] {
        let path = folder.path().join(name);
        let encoding = Encoding::new(Format::from_path(&path).unwrap());
        write(&path, &picture(), &encoding, &METADATA).unwrap();
        let whole = fs::read(&path).unwrap();
        let mut refused = 0;
        for at in 0..whole.len().min(500) {
            for spoiled in [0, 0x7f, 0xff, whole[at] ^ 1, whole[at] ^ 0x20] {
                let mut bytes = whole.clone();
                bytes[at] = spoiled;
                fs::write(&path, &bytes).unwrap();
                refused += usize::from(read_metadata(&path).is_err());
            }
        }
        assert!(refused > 20, "{name}: {refused}");
    }
}

#[test]
fn the_same_picture_is_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let metadata = ["one", "two", "three", "four", "five", "six", "seven"].map(|k| (k, "text"));
    for name in ["a.png", "a.exr", "a.jpg", "a.webp", "a.npy"] {
        let path = folder.path().join(name);
        let format = Format::from_path(&path).unwrap();
        let encoding = if format.carries_layers() {
            all_layers(format)
        } else {
            Encoding::new(format)
        };
        let bytes = || {
            write(&path, &picture(), &encoding, &metadata).unwrap();
            fs::read(&path).unwrap()
        };
        let first = bytes();
        for _ in 0..4 {
            assert!(bytes() == first, "{name}");
        }
        let mut other = picture();
        other.color[0][0] = 0.25;
        other.display.as_mut().unwrap()[0][0] = 1.0;
        write(&path, &other, &encoding, &metadata).unwrap();
        assert!(fs::read(&path).unwrap() != first, "{name}");
    }
}

#[test]
fn webp_is_lossless() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.webp");
    write(&path, &picture(), &Encoding::new(Format::WebP), &[]).unwrap();
    let image = image::load_from_memory(&fs::read(&path).unwrap()).unwrap();
    assert_eq!((image.width(), image.height()), (5, 3));
    assert_eq!(image.to_rgb8().into_raw(), picture_rgb8());
}

#[test]
fn webp_says_what_it_cannot_hold() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.webp");
    let size = ImageSize::new(16_384, 1).unwrap();
    let wide = Frame::nothing_hit(size, Wanted::ALL);
    let error = write(&path, &wide, &Encoding::new(Format::WebP), &[]).unwrap_err();
    assert!(error.to_string().contains("16383 pixels"), "{error}");
    assert_eq!(names_in(folder.path()), [""; 0]);
    let size = ImageSize::new(16_383, 1).unwrap();
    let fits = Frame::nothing_hit(size, Wanted::ALL);
    write(&path, &fits, &Encoding::new(Format::WebP), &[]).unwrap();
}

#[test]
fn jpeg_follows_its_quality() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.jpg");
    let size = ImageSize::new(64, 64).unwrap();
    let mut frame = Frame::nothing_hit(size, Wanted::ALL);
    for (pixel, display) in frame.display.as_mut().unwrap().iter_mut().enumerate() {
        let wave = |f: f32| 0.5 + 0.4 * (pixel as f32 * f).sin();
        *display = [wave(0.11), wave(0.017), wave(0.031), 1.0];
    }
    let encode = |quality| {
        let encoding = Encoding {
            quality,
            ..Encoding::new(Format::Jpeg)
        };
        write(&path, &frame, &encoding, &[]).unwrap();
        let bytes = fs::read(&path).unwrap();
        let decoded = image::load_from_memory(&bytes)
            .unwrap()
            .to_rgb8()
            .into_raw();
        let worst = decoded
            .iter()
            .zip(frame.display.iter().flatten().flat_map(|d| d[..3].to_vec()))
            .map(|(byte, exact)| (f32::from(*byte) / 255.0 - exact).abs())
            .fold(0.0, f32::max);
        (bytes.len(), worst)
    };
    let (small, good, default) = (encode(10), encode(100), encode(Encoding::DEFAULT_QUALITY));
    assert!(small.0 < default.0 && default.0 < good.0);
    assert!(good.1 < 0.02, "{}", good.1);
    assert!(small.1 > 0.05, "{}", small.1);
}

#[test]
fn formats_go_by_the_extension() {
    let of = |name: &str| Format::from_path(Path::new(name));
    assert_eq!(of("a.b/c.PNG"), Ok(Format::Png));
    assert_eq!(of("c.Jpeg"), Ok(Format::Jpeg));
    assert_eq!(of("c.jpg"), Ok(Format::Jpeg));
    assert_eq!(of("c.exr"), Ok(Format::Exr));
    assert_eq!(of("c.webp"), Ok(Format::WebP));
    assert_eq!(of("frame.png.npy"), Ok(Format::Npy));
    for bad in ["c.bmp", "c", "png", ".png", "c.png.", "", "/", "c.ｐｎｇ"] {
        let error = of(bad).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Usage, "{bad}");
        let hint = error.hint_text().unwrap();
        for known in [".png", ".exr", ".jpg", ".webp", ".npy"] {
            assert!(hint.contains(known), "{bad}: {hint}");
        }
    }
}

#[test]
fn what_a_format_cannot_do_is_wrong_usage_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        all_layers(Format::Png),
        Encoding {
            bit_depth: BitDepth::Sixteen,
            ..Encoding::new(Format::Jpeg)
        },
        Encoding {
            quality: 0,
            ..Encoding::new(Format::Jpeg)
        },
        Encoding {
            quality: 101,
            ..Encoding::new(Format::Jpeg)
        },
    ];
    for encoding in cases {
        let path = folder.path().join("a.out");
        let error = write(&path, &picture(), &encoding, &[]).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{error}");
    }
    assert_eq!(names_in(folder.path()), [""; 0]);
}

#[test]
fn a_frame_without_the_plane_is_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let size = ImageSize::new(4, 4).unwrap();
    let bare = Frame::nothing_hit(size, Wanted::default());
    for format in [Format::Png, Format::Jpeg, Format::WebP] {
        let path = folder.path().join("a");
        let error = write(&path, &bare, &Encoding::new(format), &[]).unwrap_err();
        assert!(error.to_string().contains("display"), "{error}");
    }
    for layer in Layer::ALL {
        for format in [Format::Exr, Format::Npy] {
            let path = folder.path().join("a");
            let encoding = Encoding {
                layers: vec![layer],
                ..Encoding::new(format)
            };
            let outcome = write(&path, &bare, &encoding, &[]);
            if layer == Layer::Cast {
                // Needs no plane.
                outcome.unwrap();
                fs::remove_file(&path).unwrap();
            } else {
                let said = outcome.unwrap_err().to_string();
                assert!(said.contains(layer.name()), "{said}");
            }
            // What is asked for by the encoding is enough.
            let wanted = Wanted::for_encoding(&encoding, false);
            write(&path, &Frame::nothing_hit(size, wanted), &encoding, &[]).unwrap();
            fs::remove_file(&path).unwrap();
        }
    }
    assert_eq!(names_in(folder.path()), [""; 0]);

    let mut short = picture();
    short.depth.as_mut().unwrap().pop();
    let path = folder.path().join("a.exr");
    let error = write(&path, &short, &all_layers(Format::Exr), &[]).unwrap_err();
    assert!(
        error.to_string().contains("depth plane has 14 entries"),
        "{error}"
    );
}

#[test]
fn an_encoding_names_its_planes() {
    let png = Wanted::for_encoding(&Encoding::new(Format::Png), false);
    assert_eq!(
        png,
        Wanted {
            display: true,
            ..Wanted::default()
        }
    );
    let all = Wanted::for_encoding(&all_layers(Format::Exr), false);
    assert_eq!(
        all,
        Wanted {
            display: false,
            ..Wanted::ALL
        }
    );
    let counted = Wanted::for_encoding(&Encoding::new(Format::Npy), true);
    assert_eq!(
        counted,
        Wanted {
            counters: true,
            kind: true,
            ..Wanted::default()
        }
    );
}

#[test]
fn unwritable_places_leave_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::write(root.join("file"), "x").unwrap();
    fs::create_dir(root.join("taken")).unwrap();
    for name in ["a.png", "a.exr", "a.jpg", "a.webp", "a.npy"] {
        let encoding = Encoding::new(Format::from_path(Path::new(name)).unwrap());
        let places = [
            root.join("missing").join(name),
            root.join("file").join(name),
            root.join("taken"),
        ];
        for path in places {
            let error = write(&path, &picture(), &encoding, &METADATA).unwrap_err();
            assert_eq!(error.exit_code(), 1);
            let said = error.to_string();
            assert!(said.starts_with(path.to_str().unwrap()), "{said}");
            assert!(!said.contains('\n'), "{said}");
        }
        // A full disk.
        let full = PathBuf::from("/dev/full");
        if full.exists() {
            let error = write(&full, &picture(), &encoding, &METADATA).unwrap_err();
            assert!(
                error.to_string().starts_with("/dev/full: cannot write"),
                "{error}"
            );
        }
    }
    assert_eq!(names_in(root), ["file", "taken"]);
    assert_eq!(names_in(&root.join("taken")), [""; 0]);
    assert_eq!(fs::read(root.join("file")).unwrap(), b"x");
}
