//! What renders: an OpenCL device or the reference.

use std::convert::Infallible;
use std::str::FromStr;
use std::time::Instant;

use crate::VERSION;
use crate::error::{Error, Result};
use crate::frame::{Frame, Wanted};
use crate::gpu::{Device, DeviceInfo};
use crate::octree::Octree;
use crate::options::group::{Keys, group};
use crate::options::rules::{Group, Need, has_needs, unmet};
use crate::options::text_form::readable;
use crate::progress::{Progress, UNKNOWN_TOTAL};
use crate::reference;
use crate::render::{GradientFigures, Lanes, Options, Renderer, SampleCheck, check_volume};
use crate::scene::Scene;
use crate::volume::Volume;

use super::progress::Bars;
use super::source::{Source, ms_since};
use super::stats::{DeviceStats, PassStats, Times};
use super::terminal::note;

group! {
    /// The options that choose the device and how it is used.
    #[command(next_help_heading = "Device")]
    pub struct DeviceOptions {
        /// An OpenCL device by its number, part of its name, cpu or gpu; or reference: the
        /// double-precision renderer, which needs none [default: the first GPU, else the first
        /// device]
        #[arg(long, value_name = "ID|NAME|cpu|gpu|reference")]
        device: DeviceName,

        /// Work items of a group; never changes the picture [default: by the device]
        #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
        work_group: WorkGroup,

        /// Rays that a work item follows side by side: 1, 8 or 16; never changes the picture [default:
        /// by the device: 8 or 16 on a CPU, as its vectors are wide, 1 on a GPU]
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        lanes: Lanes,
    }
}

impl DeviceOptions {
    /// Lays these flags over a scene file's options: what a device needs goes where the flag is the
    /// reference.
    pub fn over_file(self, file: Self) -> Self {
        let remaining =
            file.retaining(|option| has_needs(Group::Device, option, |need| self.meets(need)));
        self.over(remaining)
    }

    /// Whether the named device meets this need.
    fn meets(&self, need: Need) -> bool {
        let is_reference = self.device.as_ref().is_some_and(DeviceName::is_reference);
        need != Need::OpenCl || !is_reference
    }
}

/// The device's name, as given by `--device`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeviceName(String);

impl DeviceName {
    /// A device by its whole name.
    pub fn of(name: &str) -> Self {
        Self(name.to_owned())
    }

    fn is_reference(&self) -> bool {
        self.0.eq_ignore_ascii_case("reference")
    }
}

impl FromStr for DeviceName {
    type Err = Infallible;

    fn from_str(text: &str) -> std::result::Result<Self, Infallible> {
        Ok(Self(text.to_owned()))
    }
}

/// The size of a work group, as given by `--work-group`: `WxH` work items.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WorkGroup([usize; 2]);

impl From<WorkGroup> for [usize; 2] {
    fn from(WorkGroup(sides): WorkGroup) -> Self {
        sides
    }
}

impl FromStr for WorkGroup {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let side = |side: &str| side.parse().ok().filter(|n| (1..=4096).contains(n));
        text.split_once(['x', 'X', ','])
            .and_then(|(w, h)| Some(Self([side(w)?, side(h)?])))
            .ok_or_else(|| {
                Error::usage(format!(
                    "'{text}' is not a work group: write WxH, such as 8x8"
                ))
            })
    }
}

readable!(DeviceName, WorkGroup, Lanes);

pub enum Backend {
    Reference,
    Device {
        device: Box<Device>,
        options: Options,
    },
}

/// A frame and how it came about.
pub struct Rendered {
    pub frame: Frame,
    /// The rays of each round of casting.
    pub rays_per_round: Vec<u64>,
    /// How much adaptive anti-aliasing may differ from the whole of it.
    pub sample_check: Option<SampleCheck>,
    /// How far away the focal plane of the lens is along the view axis, mm; of a single picture.
    pub focus_mm: Option<f64>,
    pub device: DeviceStats,
    /// The times of the frame, without reading and encoding.
    pub times_ms: Times,
    pub passes: Vec<PassStats>,
    /// The cost and error of the gradients, if they were precomputed.
    pub gradients: Option<GradientFigures>,
    pub device_bytes: u64,
    /// The bytes uploaded from host to device.
    pub uploaded_bytes: u64,
}

impl Rendered {
    /// All rays that were cast.
    pub fn rays(&self) -> u64 {
        self.rays_per_round.iter().sum()
    }
}

impl Backend {
    /// Opens what the options name: the reference, or a device.
    ///
    /// # Errors
    /// Usage: work groups for the reference. No device of that name, or none at all.
    pub fn open(options: &DeviceOptions) -> Result<Self> {
        match &options.device {
            Some(name) if name.is_reference() => {
                let given = options.given();
                match unmet(Group::Device, &given, |need| options.meets(need)) {
                    None => Ok(Self::Reference),
                    Some((option, _)) => Err(Error::usage(format!(
                        "'--{option}' is for OpenCL devices; the reference has none"
                    ))),
                }
            }
            name => {
                let choice = name.as_ref().map_or("", |DeviceName(name)| name);
                let device = Device::select(choice)?.heard_by(Bars::new());
                device.note().iter().for_each(note);
                let options = Options {
                    work_group: options.work_group.map(Into::into),
                    lanes: options.lanes,
                };
                Ok(Self::Device {
                    device: Box::new(device),
                    options,
                })
            }
        }
    }

    /// The device, for the statistics.
    pub fn device(&self) -> DeviceStats {
        match self {
            Self::Reference => reference_stats(),
            Self::Device { device, .. } => device.info().into(),
        }
    }

    /// The OpenCL device; none where the reference renders.
    pub fn device_info(&self) -> Option<&DeviceInfo> {
        match self {
            Self::Reference => None,
            Self::Device { device, .. } => Some(device.info()),
        }
    }

    /// Prepares what the device needs beside the volume itself; nothing for the reference.
    pub fn prepare(
        &self,
        volume: &Volume,
        source: &Source,
        progress: &dyn Progress,
    ) -> Result<Prepared> {
        match self {
            Self::Reference => Ok(Prepared::Nothing),
            Self::Device { device, .. } => {
                // Smoothing may have made it larger than what was read.
                check_volume(device.info(), volume.dims(), volume.voxels().voxel_type())?;
                let began = Instant::now();
                let octree = Octree::build(volume, source.leaf, progress)?;
                Ok(Prepared::Octree {
                    octree,
                    octree_ms: ms_since(began),
                })
            }
        }
    }

    /// Ready for any scene of the volume, which is uploaded once.
    pub fn caster<'a>(&'a self, volume: &'a Volume, prepared: &'a Prepared) -> Result<Caster<'a>> {
        match (self, prepared) {
            (Self::Device { device, options }, Prepared::Octree { octree, octree_ms }) => {
                Ok(Caster::Device {
                    device,
                    renderer: Box::new(Renderer::new(device, volume, octree, *options)?),
                    octree_ms: *octree_ms,
                })
            }
            _ => Ok(Caster::Reference { volume }),
        }
    }
}

/// What a [`Backend`] has prepared from a volume.
pub enum Prepared {
    Nothing,
    Octree { octree: Octree, octree_ms: f64 },
}

/// One volume, and what renders it.
pub enum Caster<'a> {
    Reference {
        volume: &'a Volume,
    },
    Device {
        device: &'a Device,
        renderer: Box<Renderer<'a>>,
        octree_ms: f64,
    },
}

impl Caster<'_> {
    pub fn render(
        &mut self,
        scene: &Scene,
        wanted: Wanted,
        progress: &dyn Progress,
    ) -> Result<Rendered> {
        match self {
            Self::Reference { volume } => by_reference(volume, scene, wanted, progress),
            Self::Device {
                device,
                renderer,
                octree_ms,
            } => {
                progress.begin("rendering", UNKNOWN_TOTAL);
                let rendering = renderer.render(scene, wanted)?;
                progress.end();
                Ok(Rendered {
                    frame: rendering.frame,
                    rays_per_round: rendering.rays_per_round,
                    sample_check: rendering.sample_check,
                    focus_mm: rendering.focus_mm,
                    device: device.info().into(),
                    times_ms: Times {
                        octree: *octree_ms,
                        classify: rendering.classify_ms,
                        build: rendering.build_ms,
                        upload: rendering.upload_ms,
                        render: rendering.render_ms,
                        read_back: rendering.read_back_ms,
                        gradient: rendering.gradients.map_or(0.0, |figures| figures.ms),
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
                    gradients: rendering.gradients,
                    device_bytes: rendering.device_bytes,
                    uploaded_bytes: rendering.uploaded_bytes,
                })
            }
        }
    }
}

fn reference_stats() -> DeviceStats {
    DeviceStats {
        name: "reference".into(),
        platform: "host".into(),
        driver: format!("angioray {VERSION}"),
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
    let rays = u64::from(scene.anti_aliasing.rays()) * frame.size.pixels() as u64;
    Ok(Rendered {
        frame,
        rays_per_round: vec![rays],
        sample_check: None,
        focus_mm: None,
        device: reference_stats(),
        times_ms: Times {
            render: render_ms,
            ..Times::default()
        },
        passes: vec![PassStats {
            name: "reference".into(),
            ms: render_ms,
        }],
        gradients: None,
        device_bytes: 0,
        uploaded_bytes: 0,
    })
}
