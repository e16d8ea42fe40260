//! `angioray info`.

use std::io;

use serde::Serialize;

use crate::error::Result;
use crate::octree::Octree;
use crate::scene::options::concise;
use crate::scene::options::group::group;
use crate::scene::{Switch, VolumeOptions};

use super::load::{Loaded, Source};
use super::percentiles::percentiles;
use super::progress::Bars;
use super::scene::SceneArgument;
use super::stats::VolumeStats;
use super::terminal::{Lines, json_to_stdout, lines_to_stdout};

/// Columns of the printed histogram.
const WIDTH: usize = 60;

/// Print what a volume is: geometry, values, a suggested iso value, the size of its octree
#[derive(clap::Args)]
#[command(override_usage = "angioray info VOLUME [OPTIONS]")]
#[command(after_help = "Example:
  angioray info head.nrrd
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
        let source = Source::of(&options)?;
        let bars = Bars::new();
        let loaded = source.load(&bars)?;
        let octree = Octree::build(&loaded.volume, source.leaf, &bars)?;
        let info = Info::of(&source, &loaded, &octree);
        if form.json.is_some_and(Switch::is_on) {
            return json_to_stdout(&info);
        }
        let histogram = loaded.histogram.text(WIDTH);
        lines_to_stdout(|out| info.print(out, histogram.trim_end()))
    }
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
    /// Values above which all but 1, 50, 99 and 99.9 percent of the voxels lie.
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
        let [p1, p50, p99, p99_9] = percentiles(volume, &loaded.histogram, [1.0, 50.0, 99.0, 99.9]);
        Self {
            volume: VolumeStats::of(&source.path, volume, loaded.non_finite),
            size_mm,
            center_mm: loaded.subject.center_world.to_array(),
            bytes,
            otsu: loaded.subject.otsu,
            suggested_iso: loaded.subject.suggested_iso,
            percentiles: Percentiles {
                p1,
                p50,
                p99,
                p99_9,
            },
            octree: OctreeInfo {
                leaf: source.leaf.edge(),
                levels: octree.levels().len(),
                bytes: octree.bytes(),
                share_of_volume: octree.bytes() as f64 / bytes as f64,
            },
        }
    }

    fn print(&self, out: &mut Lines, histogram: &str) -> io::Result<()> {
        let volume = &self.volume;
        let triple = |each: [f64; 3]| each.map(fine).join(" ");
        let mut row = |name: &str, value: String| out.line(format_args!("{name:<14} {value}"));
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
        row(
            "values",
            format!(
                "{} to {}",
                concise(volume.range[0]),
                concise(volume.range[1])
            ),
        )?;
        row("non-finite", format!("{} voxels", volume.non_finite))?;
        let p = &self.percentiles;
        row(
            "percentiles",
            format!(
                "1%: {}  50%: {}  99%: {}  99.9%: {}",
                concise(p.p1),
                concise(p.p50),
                concise(p.p99),
                concise(p.p99_9)
            ),
        )?;
        row("suggested iso", concise(self.suggested_iso))?;
        row("otsu", concise(self.otsu))?;
        let tree = &self.octree;
        row(
            "octree",
            format!(
                "{} levels, leaves of {} voxels, {} bytes: {:.2} % of the volume",
                tree.levels,
                tree.leaf,
                tree.bytes,
                100.0 * tree.share_of_volume
            ),
        )?;
        out.line("")?;
        out.line("share of the voxels by value, from each line's on; the bars are logarithmic")?;
        out.block(histogram)
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
