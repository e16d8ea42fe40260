//! `angioray info`.

use std::io;

use serde::Serialize;

use crate::error::Result;
use crate::extent::Range;
use crate::number_text::{concise, concise_within};
use crate::octree::Octree;
use crate::options::group::group;
use crate::options::help::completed;
use crate::options::{SceneOptions, Switch, VolumeOptions};
use crate::volume::{Histogram, percentiles};

use super::carried::Carried;
use super::progress::Bars;
use super::scene::SceneArgument;
use super::source::{Loaded, Source};
use super::stats::VolumeStats;
use super::terminal::{Lines, json_to_stdout, lines_to_stdout};

/// Columns of the printed histogram.
const WIDTH: usize = 60;

/// Print what a volume is, or the scene that a picture carries
///
/// Of a volume: geometry, values, a suggested iso value, the size of its octree. Of a .png or .exr that
/// angioray wrote: the scene, as --scene takes it, and what it was made by.
#[derive(clap::Args)]
#[command(override_usage = "angioray info VOLUME|IMAGE [OPTIONS]")]
#[command(mut_args(completed))]
#[command(after_help = "Example:
  angioray info head.nrrd
  angioray info head.png
  angioray info head_256x256x256_u8.raw --raw-size 256x256x256 --raw-type u8 --json")]
pub struct InfoArguments {
    #[command(flatten)]
    volume: VolumeOptions,

    #[command(flatten)]
    scene: SceneArgument,

    #[command(flatten)]
    form: FormOptions,
}

group! {
    /// How it is printed.
    #[command(next_help_heading = "Output")]
    pub struct FormOptions {
        /// Print JSON
        #[arg(long, value_name = "on|off", num_args = 0..=1, require_equals = true,
            default_missing_value = "on")]
        json: Switch,
    }
}

impl InfoArguments {
    pub fn run(self) -> Result<()> {
        let file = self.scene.open()?;
        let options = self.volume.over(VolumeOptions::of_file(&file)?);
        let form = self.form.over(file.group()?);
        let json = form.json.is_some_and(Switch::is_on);
        let file = options.volume.as_ref();
        if let Some(carried) = file.map(|file| Carried::of(&file.0)).transpose()?.flatten() {
            return print_carried(&carried, json);
        }
        let source = Source::of(&options)?;
        let bars = Bars::new();
        let loaded = source.load(None, &bars)?;
        let octree = Octree::build(&loaded.volume, source.leaf, &bars)?;
        let info = Info::of(&source, &loaded, &octree);
        if json {
            return json_to_stdout(&info);
        }
        lines_to_stdout(|out| info.print(out, &loaded.histogram))
    }
}

/// Prints what a picture carries: the program and volume that made it, then the scene as a scene file.
fn print_carried(carried: &Carried, json: bool) -> Result<()> {
    let picture = carried.picture.display();
    if json {
        // Its numbers and lists as a program reads them.
        let scene = SceneOptions::parse(&carried.scene, &format!("{picture} (its scene)"))?;
        let about = serde_json::json!({
            "file": picture.to_string(),
            "version": carried.version,
            "device": carried.device,
            "content": carried.content,
            "scene": scene,
        });
        return json_to_stdout(&about);
    }
    lines_to_stdout(|out| {
        // Comments, so that all of it is a scene file.
        out.line(format_args!("# {picture}"))?;
        for (name, value) in [
            ("made by angioray", &carried.version),
            ("on", &carried.device),
            ("of a volume with the content", &carried.content),
        ] {
            if let Some(value) = value {
                out.line(format_args!("# {name} {value}"))?;
            }
        }
        out.block(carried.scene.trim_end())
    })
}

#[derive(Serialize)]
struct Info {
    #[serde(flatten)]
    volume: VolumeStats,
    /// Extent of the voxel centres' box along the index axes, mm.
    size_mm: [f64; 3],
    center_mm: [f64; 3],
    bytes: u64,
    otsu: f64,
    suggested_iso: f64,
    /// The range without a few far-away values and padding: what defaults are made for.
    robust_range: [f64; 2],
    /// The smallest voxel values that 1, 50, 99 and 99.9 percent of the voxels do not exceed.
    percentiles: Percentiles,
    octree: OctreeInfo,
}

#[derive(Serialize)]
struct Percentiles {
    p1: f64,
    p50: f64,
    p99: f64,
    #[serde(rename = "p99.9")]
    p99_9: f64,
}

#[derive(Serialize)]
struct OctreeInfo {
    leaf: u32,
    levels: usize,
    bytes: u64,
    share_of_volume: f64,
}

impl Info {
    fn of(source: &Source, loaded: &Loaded, octree: &Octree) -> Self {
        let volume = &loaded.volume;
        let bytes = volume.voxels().bytes().len() as u64;
        let spacing = volume.geometry().spacing_mm().to_array();
        let domain = volume.dims().domain();
        let mut size_mm = [0.0; 3];
        for (axis, size) in size_mm.iter_mut().enumerate() {
            *size = (domain[axis].1 - domain[axis].0) * spacing[axis];
        }
        let at = percentiles(volume, &[1.0, 50.0, 99.0, 99.9]);
        Self {
            volume: VolumeStats::of(&source.path, volume, loaded.non_finite),
            size_mm,
            center_mm: loaded.subject.sphere.center_world.to_array(),
            bytes,
            otsu: loaded.subject.otsu,
            suggested_iso: loaded.subject.suggested_iso,
            robust_range: [
                loaded.subject.robust_range.min,
                loaded.subject.robust_range.max,
            ],
            percentiles: Percentiles {
                p1: at[0],
                p50: at[1],
                p99: at[2],
                p99_9: at[3],
            },
            octree: OctreeInfo {
                leaf: source.leaf.edge(),
                levels: octree.levels().len(),
                bytes: octree.bytes(),
                share_of_volume: octree.bytes() as f64 / bytes as f64,
            },
        }
    }

    fn print(&self, out: &mut Lines, histogram: &Histogram) -> io::Result<()> {
        let volume = &self.volume;
        let [min, max] = volume.range;
        let value = |value| concise_within(value, Range { min, max });
        let triple = |each: [f64; 3]| each.map(fine).join(" ");
        let mut row = |name: &str, text: String| out.line(format_args!("{name:<14} {text}"));
        row("file", volume.file.clone())?;
        let [nx, ny, nz] = volume.dims;
        row(
            "voxels",
            format!("{nx}x{ny}x{nz} {}, {} bytes", volume.kind, self.bytes),
        )?;
        row("spacing", format!("{} mm", triple(volume.spacing_mm)))?;
        row("size", format!("{} mm", triple(self.size_mm)))?;
        row("origin", format!("{} mm (LPS)", triple(volume.origin_mm)))?;
        row("center", format!("{} mm", triple(self.center_mm)))?;
        for (axis, name) in ["x axis", "y axis", "z axis"].into_iter().enumerate() {
            row(name, triple(volume.direction.map(|world| world[axis])))?;
        }
        row("values", format!("{} to {}", value(min), value(max)))?;
        row("non-finite", format!("{} voxels", volume.non_finite))?;
        let p = &self.percentiles;
        row(
            "percentiles",
            format!(
                "1%: {}  50%: {}  99%: {}  99.9%: {}",
                value(p.p1),
                value(p.p50),
                value(p.p99),
                value(p.p99_9)
            ),
        )?;
        row("suggested iso", value(self.suggested_iso))?;
        row("otsu", value(self.otsu))?;
        let tree = &self.octree;
        row(
            "octree",
            format!(
                "{} levels, leaves of {} cells, {} bytes: {:.2} % of the volume",
                tree.levels,
                tree.leaf,
                tree.bytes,
                100.0 * tree.share_of_volume
            ),
        )?;
        out.line("")?;
        out.line("share of the voxels by value, from each line's on; the bars are logarithmic")?;
        if [histogram.range.min, histogram.range.max] != volume.range {
            out.line("the first and the last line count what lies beyond")?;
        }
        out.block(histogram.text(WIDTH).trim_end())
    }
}

/// A length in mm or a part of a direction, to a millionth.
fn fine(value: f64) -> String {
    // Adding 0 takes the sign off a zero.
    let millionths = (value * 1e6).round() / 1e6 + 0.0;
    concise(if millionths.is_finite() {
        millionths
    } else {
        value
    })
}
