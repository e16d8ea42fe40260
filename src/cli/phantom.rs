//! `angioray phantom`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::builder::PossibleValue;

use crate::error::{Error, Result};
use crate::extent::Dims;
use crate::output::write_atomically;
use crate::scene::SpacingMm;
use crate::volume::{PhantomKind, PhantomSpec, VesselTree, VoxelType, phantom, write_nrrd};

use super::outputs;
use super::terminal::{message, note};

/// Make a test volume whose field is known
///
/// Kinds: sphere, slab, ramp, gaussian, marschner-lobb, voxel, noise, and vessels: a seeded tree
/// that branches by Murray's law, whose centrelines and radii go into FILE.tree.json.
#[derive(clap::Args)]
#[command(after_help = "Example:
  angioray phantom vessels -o vessels.nrrd --size 256 --seed 7
  angioray phantom sphere -o sphere.nrrd --size 64x64x32 --spacing 1,1,2 --type f32")]
pub struct PhantomArguments {
    /// What it contains
    #[arg(value_name = "KIND", value_parser = kinds(), ignore_case = false)]
    kind: String,

    /// The NRRD file to write
    #[arg(short, long, value_name = "FILE.nrrd")]
    output: PathBuf,

    /// Voxels along each axis [default: 128; 41 for marschner-lobb]
    #[arg(long, value_name = "N|NXxNYxNZ")]
    size: Option<GridSize>,

    /// Voxel spacing in mm
    #[arg(long, value_name = "S|SX,SY,SZ", default_value = "1")]
    spacing: SpacingMm,

    /// Voxel type: u8, u16, i16 or f32
    #[arg(long = "type", value_name = "TYPE", default_value = "u8", value_parser = voxel_type)]
    voxel_type: VoxelType,

    /// Decides the vessel tree and all noise
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,

    /// Standard deviation of noise added to every voxel, as a share of the value range
    #[arg(long, value_name = "SHARE", default_value_t = 0.0)]
    noise: f64,

    /// Compress the voxels with gzip (such a file cannot be mapped when it is read)
    #[arg(long)]
    gzip: bool,

    /// Sphere: its radius; vessels: the root's radius, mm [default: by the size]
    #[arg(long, value_name = "MM", help_heading = "Shape")]
    radius: Option<f64>,

    /// Vessels: the radius of the finest tips, mm [default: half a voxel]
    #[arg(long, value_name = "MM", help_heading = "Shape")]
    tip_radius: Option<f64>,

    /// Slab: its thickness, mm [default: by the size]
    #[arg(long, value_name = "MM", help_heading = "Shape")]
    thickness: Option<f64>,

    /// Slab: the axis it lies across [default: z]
    #[arg(long, value_name = "x|y|z", help_heading = "Shape", value_parser = axis)]
    axis: Option<usize>,

    /// Gaussian: its standard deviation, mm [default: by the size]
    #[arg(long, value_name = "MM", help_heading = "Shape")]
    sigma: Option<f64>,
}

impl PhantomArguments {
    pub fn run(self) -> Result<()> {
        if !self
            .output
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("nrrd"))
        {
            return Err(Error::usage(format!(
                "{}: phantoms are written as NRRD",
                self.output.display()
            ))
            .hint("end the name in .nrrd"));
        }
        outputs::check(&self.output, &[])?;
        let kind: PhantomKind = self.kind.parse()?;
        let dims = match self.size {
            Some(GridSize(dims)) => dims,
            None => Dims::new([u64::from(kind.default_size()); 3])?,
        };
        let spec = PhantomSpec {
            spacing_mm: self.spacing.0.into(),
            voxel_type: self.voxel_type,
            seed: self.seed,
            radius_mm: self.radius,
            tip_radius_mm: self.tip_radius,
            thickness_mm: self.thickness,
            axis: self.axis,
            sigma_mm: self.sigma,
            noise: self.noise,
            ..PhantomSpec::new(kind, dims)
        };
        let made = phantom(&spec)?;
        made.volume.notes().iter().for_each(note);
        if let Some(tree) = &made.tree {
            let path = self.output.with_extension("tree.json");
            outputs::check(&path, &[])?;
            write_tree(&path, tree)?;
            message(format_args!(
                "wrote {}: {} vessel segments",
                path.display(),
                tree.segments.len()
            ));
        }
        write_nrrd(&made.volume, &self.output, self.gzip)?;
        message(format_args!(
            "wrote {}: {dims} {}; {}",
            self.output.display(),
            self.voxel_type,
            made.truth
        ));
        Ok(())
    }
}

fn write_tree(path: &Path, tree: &VesselTree) -> Result<()> {
    write_atomically(path, |out| {
        serde_json::to_writer_pretty(&mut *out, tree)
            .map_err(std::io::Error::from)
            .and_then(|()| writeln!(out))
            .map_err(|cause| Error::io(path, "write", &cause))
    })
}

fn kinds() -> Vec<PossibleValue> {
    PhantomKind::ALL
        .into_iter()
        .map(|kind| PossibleValue::new(kind.name()).help(kind.description()))
        .collect()
}

/// `NXxNYxNZ`, or `N` for a cube.
#[derive(Debug, Clone, Copy)]
struct GridSize(Dims);

impl FromStr for GridSize {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "'{text}' is not a volume size: write N, or NXxNYxNZ such as 64x64x32"
            ))
        };
        let sides: Vec<u64> = text
            .split('x')
            .map(|side| side.parse().map_err(|_| wrong()))
            .collect::<Result<_>>()?;
        let dims = match sides[..] {
            [n] => [n; 3],
            [nx, ny, nz] => [nx, ny, nz],
            _ => return Err(wrong()),
        };
        Dims::new(dims).map(Self)
    }
}

fn voxel_type(text: &str) -> Result<VoxelType> {
    VoxelType::ALL
        .into_iter()
        .find(|t| t.name() == text)
        .ok_or_else(|| Error::usage("a voxel is u8, u16, i16 or f32"))
}

fn axis(text: &str) -> Result<usize> {
    match text {
        "x" => Ok(0),
        "y" => Ok(1),
        "z" => Ok(2),
        _ => Err(Error::usage("an axis is x, y or z")),
    }
}
