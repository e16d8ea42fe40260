//! `angioray render`.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Instant;

use crate::error::{Error, Result};
use crate::frame::{self, BitDepth, Encoding, Format, Frame, Wanted};
use crate::gpu::Device;
use crate::octree::Octree;
use crate::progress::Progress;
use crate::reference;
use crate::render::{Options, Renderer};
use crate::scene::{Scene, SceneOptions};
use crate::volume::Volume;

use super::load::{self, Source, ms_since};
use super::outputs::{self, Layers};
use super::progress::Bars;
use super::stats::{Counts, DeviceStats, Memory, PassStats, Stats, Times, VolumeStats};
use super::terminal::{message, note};

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Render a volume to a picture
#[derive(clap::Args)]
#[command(after_help = "Example:
  angioray render head.nrrd -o head.png
  angioray render head.nrrd -o head.png --mode mip --view left --zoom 1.5
  angioray render cta.nii.gz -o cta.png --mode dvr --tf cta --shading phong --carm 'LAO 30 CRA 20'
  angioray render head.nrrd -o head.exr --iso 50% --aov all --stats head.json --device reference")]
pub struct RenderArguments {
    #[command(flatten)]
    options: SceneOptions,

    /// Take options from a TOML file: the flags' names as keys; flags win over it
    #[arg(long, value_name = "FILE.toml", help_heading = "Scene")]
    scene: Option<PathBuf>,

    /// The picture: .png, .jpg, .webp for display, .exr, .npy for measuring
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,

    /// Layers beside the colour, in .exr and .npy: depth, normal, value, steps, nodes, cast, kind,
    /// with commas between, or all
    #[arg(long, value_name = "LIST|all", help_heading = "Output")]
    aov: Option<Layers>,

    /// Bits per channel of a .png: 8 or 16 [default: 8]
    #[arg(long, value_name = "8|16", help_heading = "Output", value_parser = bit_depth)]
    bit_depth: Option<BitDepth>,

    /// Quality of a .jpg, 1 to 100 [default: 92]
    #[arg(long, value_name = "N", help_heading = "Output")]
    quality: Option<u8>,

    /// Write what was rendered and how long it took as JSON
    #[arg(long, value_name = "FILE.json", help_heading = "Output")]
    stats: Option<PathBuf>,

    /// An OpenCL device by its number, part of its name, cpu or gpu; or reference: the
    /// double-precision renderer, which needs none [default: the first GPU, else the first device]
    #[arg(
        long,
        value_name = "ID|NAME|cpu|gpu|reference",
        help_heading = "Device"
    )]
    device: Option<String>,

    /// Work items of a group; never changes the picture [default: by the device]
    #[arg(long, value_name = "WxH", help_heading = "Device")]
    work_group: Option<WorkGroup>,
}

impl RenderArguments {
    pub fn run(self) -> Result<()> {
        let encoding = self.encoding()?;
        let options = load::options(self.options.clone(), self.scene.as_deref())?;
        let source = Source::of(&options.volume)?;
        self.check_files(&source.path)?;
        let engine = Engine::open(self.device.as_deref(), self.work_group)?;

        let bars = Bars::new();
        let loaded = source.load(&bars)?;
        let resolved = options.resolve(&loaded.subject)?;
        resolved.notes.iter().for_each(note);

        let wanted = Wanted::for_encoding(&encoding, self.stats.is_some());
        let rendered = engine.render(&loaded.volume, &source, &resolved.scene, wanted, &bars)?;

        let began = Instant::now();
        let scene_text = resolved.options.to_toml()?;
        let metadata = [("scene", scene_text.as_str()), ("version", VERSION)];
        frame::write(&self.output, &rendered.frame, &encoding, &metadata)?;
        let times_ms = Times {
            read: loaded.read_ms,
            smooth: loaded.smooth_ms,
            encode: ms_since(began),
            ..rendered.times_ms
        };
        message(format_args!(
            "wrote {}: {} {}, {:.1} ms on {}",
            self.output.display(),
            resolved.scene.picture.mode(),
            resolved.scene.size,
            times_ms.render,
            rendered.device.name
        ));
        let Some(path) = &self.stats else {
            return Ok(());
        };
        let stats = Stats {
            version: VERSION,
            command: "render",
            scene: &resolved.options,
            volume: VolumeStats::of(&source.path, &loaded.volume, loaded.non_finite),
            device: rendered.device,
            channels: frame::channels(&encoding),
            times_ms,
            passes: rendered.passes,
            counts: Counts::of(&rendered.frame, &resolved.scene.picture),
            memory: Memory::now(rendered.device_bytes),
        };
        stats.write(path)
    }

    fn encoding(&self) -> Result<Encoding> {
        let format = Format::from_path(&self.output)?;
        if self.quality.is_some() && format != Format::Jpeg {
            return Err(Error::usage("'--quality' is for .jpg files only"));
        }
        let encoding = Encoding {
            format,
            bit_depth: self.bit_depth.unwrap_or(BitDepth::Eight),
            quality: self.quality.unwrap_or(Encoding::DEFAULT_QUALITY),
            layers: self.aov.clone().map_or(Vec::new(), |Layers(layers)| layers),
        };
        encoding.check()?;
        Ok(encoding)
    }

    /// That what is to be written can be, before hours of work.
    fn check_files(&self, volume: &Path) -> Result<()> {
        let mut inputs = vec![volume];
        inputs.extend(self.scene.as_deref());
        outputs::check(&self.output, &inputs)?;
        if let Some(stats) = &self.stats {
            outputs::check(stats, &inputs)?;
            if *stats == self.output {
                return Err(Error::usage(format!(
                    "{}: the picture and the statistics need a file each",
                    stats.display()
                )));
            }
        }
        Ok(())
    }
}

/// What renders.
enum Engine {
    Reference,
    Device {
        device: Device,
        work_group: Option<WorkGroup>,
    },
}

/// A frame and how it came about.
struct Rendered {
    frame: Frame,
    device: DeviceStats,
    /// Without reading and encoding.
    times_ms: Times,
    passes: Vec<PassStats>,
    device_bytes: u64,
}

impl Engine {
    fn open(choice: Option<&str>, work_group: Option<WorkGroup>) -> Result<Self> {
        if choice != Some("reference") {
            let device = Device::select(choice.unwrap_or(""))?;
            return Ok(Self::Device { device, work_group });
        }
        match work_group {
            None => Ok(Self::Reference),
            Some(_) => Err(Error::usage(
                "'--work-group' is for OpenCL devices; the reference has none",
            )),
        }
    }

    fn render(
        &self,
        volume: &Volume,
        source: &Source,
        scene: &Scene,
        wanted: Wanted,
        progress: &dyn Progress,
    ) -> Result<Rendered> {
        match self {
            Self::Reference => by_reference(volume, scene, wanted, progress),
            Self::Device { device, work_group } => {
                let began = Instant::now();
                let octree = Octree::build(volume, source.leaf, progress)?;
                let octree_ms = ms_since(began);
                let options = Options {
                    work_group: work_group.map(|WorkGroup(sides)| sides),
                };
                let rendering =
                    Renderer::new(device, volume, &octree, options)?.render(scene, wanted)?;
                let info = device.info();
                Ok(Rendered {
                    frame: rendering.frame,
                    device: DeviceStats {
                        name: info.name.clone(),
                        platform: info.platform.clone(),
                        driver: info.driver.clone(),
                    },
                    times_ms: Times {
                        octree: octree_ms,
                        build: rendering.build_ms,
                        upload: rendering.upload_ms,
                        render: rendering.render_ms,
                        ..Times::default()
                    },
                    passes: rendering
                        .passes
                        .into_iter()
                        .map(|pass| PassStats {
                            name: pass.name.to_owned(),
                            ms: pass.ms,
                        })
                        .collect(),
                    device_bytes: rendering.device_bytes,
                })
            }
        }
    }
}

fn by_reference(
    volume: &Volume,
    scene: &Scene,
    wanted: Wanted,
    progress: &dyn Progress,
) -> Result<Rendered> {
    let began = Instant::now();
    let frame = reference::render(volume, scene, wanted, progress)?;
    let render_ms = ms_since(began);
    Ok(Rendered {
        frame,
        device: DeviceStats {
            name: "reference".into(),
            platform: "host".into(),
            driver: format!("angioray {VERSION}"),
        },
        times_ms: Times {
            render: render_ms,
            ..Times::default()
        },
        passes: vec![PassStats {
            name: "reference".into(),
            ms: render_ms,
        }],
        device_bytes: 0,
    })
}

/// `WxH` work items.
#[derive(Debug, Clone, Copy)]
struct WorkGroup([usize; 2]);

impl FromStr for WorkGroup {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let side = |side: &str| side.parse().ok().filter(|n| (1..=4096).contains(n));
        text.split_once('x')
            .and_then(|(w, h)| Some(Self([side(w)?, side(h)?])))
            .ok_or_else(|| {
                Error::usage(format!(
                    "'{text}' is not a work group: write WxH, such as 8x8"
                ))
            })
    }
}

fn bit_depth(text: &str) -> Result<BitDepth> {
    match text {
        "8" => Ok(BitDepth::Eight),
        "16" => Ok(BitDepth::Sixteen),
        _ => Err(Error::usage("a .png has 8 or 16 bits per channel")),
    }
}
