//! What is changed, and how it is read.

use std::ffi::OsStr;
use std::fs;
use std::io::{Cursor, Read, Write};
use std::path::{Path, PathBuf};

use angioray::extent::{ImageSize, Range};
use angioray::frame::{Encoding, Format, Frame, Wanted, read_metadata, write};
use angioray::octree::{Leaf, Octree};
use angioray::options::SceneOptions;
use angioray::progress::Silent;
use angioray::scene::TransferFile;
use angioray::volume::{Histogram, RawLayout, ReadOptions, read, suggested_iso};
use angioray::{Content, Sphere, Subject};
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;
use flate2::{Compression, Crc};
use glam::DVec3;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::campaign::Outcome;
use super::changes::{Rng, change};
use super::{copies, fixtures, write_anew};

const SCENES: [&str; 4] = [
    "mode = \"iso\"\niso = 120\nsize = \"64x48\"\nview = \"left\"\nazimuth = 30\nelevation = -20\nroll = 5\nzoom = 1.5\nfov = 30\nsampling = \"exact\"\nshading = \"phong\"\nambient = 0.2\nlight = \"headlight\"\nbackground = \"0.1,0.2,0.3\"\n",
    "mode = \"dvr\"\ntf = \"cta\"\nquad = \"simpson\"\nstep = 0.5\nfilter = \"linear\"\ntraverse = \"distance\"\neye = [1, -200, 3]\ntarget = [0, 0, 0]\nup = [0, 0, 1]\northo = 120\nclip-plane = [\"1,0,0,20\", \"0,1,0,-3\"]\n",
    "mode = \"mip\"\nwindow = \"10%,99%\"\ncarm = \"LAO 30 CRA 20\"\nbrightness = 0.1\ncontrast = 1.2\ngamma = 2.2\n",
    "mode = \"lmip\"\nlmip-threshold = \"otsu\"\nsize = \"16\"\nstep = 1\nprobe = \"off\"\n",
];

/// As measured of a small volume.
const SPHERE: Sphere = Sphere {
    center_world: DVec3::new(1.0, 2.0, 3.0),
    radius_mm: 10.0,
};

const SUBJECT: Subject = Subject {
    sphere: SPHERE,
    content: Content::around(SPHERE),
    spacing_mm: DVec3::new(0.5, 0.5, 2.0),
    range: Range {
        min: -100.0,
        max: 300.0,
    },
    robust_range: Range {
        min: -90.0,
        max: 250.0,
    },
    otsu: 42.5,
    suggested_iso: 120.0,
};

/// How a volume's bytes lie in its file.
#[derive(Clone, Copy, PartialEq)]
enum Wrapping {
    Plain,
    Gzip,
    /// As the arrays of an archive.
    Npz,
}

enum Kind {
    Volume(Wrapping),
    Name,
    Scene,
    Transfer,
    Picture,
}

struct Original {
    kind: Kind,
    /// For the figures.
    label: &'static str,
    /// Of the file that is read.
    name: String,
    bytes: Vec<u8>,
}

/// Everything that is changed.
pub struct Subjects {
    originals: Vec<Original>,
    /// All words of the texts among them.
    words: Vec<String>,
    folder: tempfile::TempDir,
}

impl Subjects {
    /// Kinds that are counted separately in the figures.
    pub const KINDS: usize = 9;

    pub fn new() -> Self {
        let folder = copies();
        let mut originals = volumes();
        originals.push(Original {
            kind: Kind::Name,
            label: "raw name",
            name: "head-and_5x4x3_uint16be.raw".into(),
            bytes: (0..=255).collect(),
        });
        for text in SCENES {
            originals.push(original(Kind::Scene, "scene", text.into()));
        }
        let presets = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/scene/presets");
        for name in ["cta.toml", "mra.toml"] {
            let text = fs::read(presets.join(name)).unwrap();
            originals.push(original(Kind::Transfer, "transfer", text));
        }
        for name in ["a.png", "a.exr"] {
            let path = folder.path().join(name);
            let encoding = Encoding::new(Format::from_path(&path).unwrap());
            let frame = Frame::blank(ImageSize::new(3, 2).unwrap(), Wanted::DISPLAY).unwrap();
            write(
                &path,
                &frame,
                &encoding,
                &[("scene", SCENES[0]), ("version", "1")],
            )
            .unwrap();
            originals.push(Original {
                name: name.into(),
                ..original(Kind::Picture, "picture", fs::read(&path).unwrap())
            });
        }
        let words = words(&originals);
        Self {
            originals,
            words,
            folder,
        }
    }

    /// Makes the case of that number and reads it.
    pub fn check(&self, case: u64) -> Outcome {
        let mut rng = Rng::of(case);
        // Volumes are most of the originals; every eighth case is another thing.
        let others = self.originals.len() - self.volumes();
        let at = if rng.one_in(8) {
            self.volumes() + rng.below(others)
        } else {
            rng.below(self.volumes())
        };
        let original = &self.originals[at];
        let mut bytes = original.bytes.clone();
        let mut name = original.name.clone().into_bytes();
        let changed = match original.kind {
            Kind::Name => &mut name,
            _ => &mut bytes,
        };
        for _ in 0..rng.below(4).max(1) {
            change(changed, &self.words, &mut rng);
        }
        let outcome = |bytes: usize, was_read| Outcome {
            kind: original.label,
            was_read,
            bytes,
        };
        let text = || String::from_utf8_lossy(&bytes).into_owned();
        match original.kind {
            Kind::Scene => outcome(bytes.len(), scene_is_read(&text())),
            Kind::Transfer => outcome(bytes.len(), transfer_is_read(&text())),
            Kind::Picture => {
                if rng.one_in(2) {
                    mend_checksums(&mut bytes);
                }
                let path = self.write(&original.name, &bytes);
                outcome(bytes.len(), read_metadata(&path).is_ok())
            }
            Kind::Name => {
                let path = self.folder.path().join(file_name(&name));
                write_anew(&path, &bytes);
                let was_read = volume_is_read(&path, &mut rng);
                let _ = fs::remove_file(&path);
                outcome(bytes.len(), was_read)
            }
            Kind::Volume(wrapping) => {
                let bytes = match wrapping {
                    Wrapping::Plain => bytes,
                    Wrapping::Gzip => zipped(&bytes),
                    Wrapping::Npz => archived(&bytes, &mut rng),
                };
                let path = self.write(&original.name, &bytes);
                let was_read = volume_is_read(&path, &mut rng);
                // It may be another's data.
                if wrapping == Wrapping::Plain {
                    write_anew(&path, &original.bytes);
                }
                outcome(bytes.len(), was_read)
            }
        }
    }

    fn volumes(&self) -> usize {
        let is_volume = |original: &&Original| matches!(original.kind, Kind::Volume(_));
        self.originals.iter().filter(is_volume).count()
    }

    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.folder.path().join(name);
        write_anew(&path, bytes);
        path
    }
}

fn original(kind: Kind, label: &'static str, bytes: Vec<u8>) -> Original {
    Original {
        kind,
        label,
        name: "unnamed".into(),
        bytes,
    }
}

/// The fixtures as they are, those in gzip once more without it, so that what is inside can be changed
/// too, and arrays once more in archives.
fn volumes() -> Vec<Original> {
    let mut originals = Vec::new();
    for path in fixtures() {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let bytes = fs::read(&path).unwrap();
        let label = label(&name);
        let mut add = |name: String, wrapping, label, bytes| {
            originals.push(Original {
                kind: Kind::Volume(wrapping),
                label,
                name,
                bytes,
            });
        };
        if name.ends_with(".gz") {
            let mut inside = Vec::new();
            // One of them ends in padding, which is not part of the data.
            let _ = MultiGzDecoder::new(&bytes[..]).read_to_end(&mut inside);
            assert!(!inside.is_empty(), "{name}");
            add(format!("within_{name}"), Wrapping::Gzip, label, inside);
        }
        if let Some(stem) = name.strip_suffix(".npy") {
            add(
                format!("within_{stem}.npz"),
                Wrapping::Npz,
                "npz",
                bytes.clone(),
            );
        }
        add(name, Wrapping::Plain, label, bytes);
    }
    originals
}

/// The format, for the figures.
fn label(name: &str) -> &'static str {
    let plain = name.strip_suffix(".gz").unwrap_or(name);
    match plain.rsplit_once('.').unwrap().1 {
        "nrrd" | "nhdr" | "bin" => "nrrd",
        "mha" | "mhd" | "zraw" => "metaimage",
        "nii" | "hdr" | "img" => "nifti",
        "npy" => "npy",
        "npz" => "npz",
        _ => "raw name",
    }
}

fn words(originals: &[Original]) -> Vec<String> {
    let mut words: Vec<String> = originals
        .iter()
        .flat_map(|original| {
            let head = &original.bytes[..original.bytes.len().min(700)];
            let text = String::from_utf8_lossy(head).into_owned();
            let plain = text.split(|c: char| !c.is_ascii_graphic());
            plain.map(str::to_owned).collect::<Vec<_>>()
        })
        .filter(|word| (1..40).contains(&word.len()))
        .collect();
    words.sort();
    words.dedup();
    words
}

/// Reads as `info` does, now and then with what flags may say.
fn volume_is_read(path: &Path, rng: &mut Rng) -> bool {
    let mut options = ReadOptions::default();
    if rng.one_in(8) {
        options.frame = rng.below(4) as u32;
    }
    if rng.one_in(16) {
        options.raw = RawLayout {
            size: "5x4x3".parse().ok(),
            element: "f32be".parse().ok(),
            spacing_mm: None,
            offset_bytes: [None, Some(1), Some(u64::MAX)][rng.below(3)],
        };
    }
    let volume = match read(path, &options, &Silent) {
        Ok(volume) => volume,
        Err(error) => {
            assert!(matches!(error.exit_code(), 2 | 65), "{error}");
            return false;
        }
    };
    let range = volume.range();
    assert!(range.min.is_finite() && range.max.is_finite());
    assert!(volume.geometry().spacing_mm().min_element() > 0.0);
    let (center, radius) = volume.bounding_sphere();
    assert!(!center.is_nan() && !radius.is_nan());
    // Tables of a fixed size, which are dear beside the rest.
    if rng.one_in(16) {
        let histogram = Histogram::of(&volume, 64);
        assert_eq!(histogram.total(), volume.dims().voxels());
        assert!(suggested_iso(&histogram).is_finite() && histogram.otsu().is_finite());
        Octree::build(&volume, Leaf::default(), &Silent).unwrap();
    }
    true
}

fn scene_is_read(text: &str) -> bool {
    let resolved = SceneOptions::parse(text, "a scene")
        .and_then(SceneOptions::checked)
        .and_then(|options| options.resolve(&SUBJECT));
    match resolved {
        Ok(resolved) => {
            let scene = resolved.scene;
            let ray = scene.camera.ray(scene.size, 0.5, 0.5);
            assert!(
                !ray.origin_world.is_nan() && !ray.dir_world.is_nan(),
                "{text}"
            );
            true
        }
        Err(_) => false,
    }
}

fn transfer_is_read(text: &str) -> bool {
    TransferFile::parse(text, "a transfer function")
        .and_then(|file| file.transfer_function(SUBJECT.range))
        .is_ok()
}

/// Any bytes as the name of a file.
fn file_name(bytes: &[u8]) -> &OsStr {
    use std::os::unix::ffi::OsStrExt;
    const LONGEST: usize = 200;
    let end = bytes.iter().position(|&b| b == b'/' || b == 0);
    let name = &bytes[..end.unwrap_or(bytes.len()).min(LONGEST)];
    match name {
        b"" | b"." | b".." => OsStr::new("5x4x3"),
        _ => OsStr::from_bytes(name),
    }
}

fn zipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// An archive of one to three times the same array.
fn archived(bytes: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let methods = [CompressionMethod::Stored, CompressionMethod::Deflated];
    for n in 0..1 + rng.below(3) {
        let method = methods[rng.below(2)];
        let options = SimpleFileOptions::default().compression_method(method);
        archive.start_file(format!("arr_{n}.npy"), options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// Gives every chunk of a PNG the checksum that it should have, so that more than checksums is tried.
fn mend_checksums(png: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = png.get(at..at + 4) {
        let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let Some(chunk) = png.get(at + 4..(at + 8).saturating_add(length)) else {
            return;
        };
        let mut sum = Crc::new();
        sum.update(chunk);
        let sum_at = at + 8 + length;
        let Some(place) = png.get_mut(sum_at..sum_at + 4) else {
            return;
        };
        place.copy_from_slice(&sum.sum().to_be_bytes());
        at = sum_at + 4;
    }
}
