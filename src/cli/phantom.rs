//! `angioray phantom`.

use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, StringValueParser, TypedValueParser};

use crate::error::{Error, Result};
use crate::extent::Dims;
use crate::lab::hardcases::HardCase;
use crate::number_text::whole;
use crate::options::group::{Keys, group};
use crate::options::text_form::readable;
use crate::options::{FilePath, SpacingMm, Switch};
use crate::output::write_atomically;
use crate::volume::{PhantomKind, PhantomSpec, VesselTree, VoxelType, phantom, write_nrrd};

use super::hardcase::{self, Chosen};
use super::outputs;
use super::scene::SceneArgument;
use super::terminal::{message, note};

const EXAMPLE: &str = "Example:
  angioray phantom vessels -o vessels.nrrd --size 256 --seed 7
  angioray phantom sphere -o sphere.nrrd --size 64x64x32 --spacing 1,1,2 --type f32
  angioray phantom hardcase:thin-vessels -o thin.nrrd";

/// Make a test volume whose field is known
///
/// Kinds: sphere, slab, ramp, gaussian, marschner-lobb, voxel, noise, and vessels: a seeded tree
/// that branches by Murray's law, whose centrelines and radii go into FILE.tree.json.
///
/// hardcase:NAME makes a volume on which renderers fail, with the scenes that go with it and the
/// right answer (listed below).
#[derive(clap::Args)]
#[command(override_usage = "angioray phantom KIND -o FILE.nrrd [OPTIONS]")]
#[command(after_help = EXAMPLE, after_long_help = format!("{}{EXAMPLE}", hardcase::help() + "\n"))]
pub struct PhantomArguments {
    #[command(flatten)]
    phantom: PhantomOptions,

    #[command(flatten)]
    shape: ShapeOptions,

    #[command(flatten)]
    scene: SceneArgument,
}

group! {
    /// The options of a phantom: what it contains, and its voxels.
    pub struct PhantomOptions {
        /// What it contains: a kind, or hardcase:NAME
        #[arg(value_name = "KIND", value_parser = Kinds)]
        kind: Kind,

        /// The NRRD file to write
        #[arg(short, long, value_name = "FILE.nrrd")]
        output: FilePath,

        /// Voxels along each axis [default: 128; 41 for marschner-lobb]
        #[arg(long, value_name = "N|NXxNYxNZ", allow_hyphen_values = true)]
        size: GridSize,

        /// Voxel spacing in mm [default: 1]
        #[arg(long, value_name = "S|SX,SY,SZ", allow_hyphen_values = true)]
        spacing: SpacingMm,

        /// Voxel type: u8, u16, i16 or f32 [default: u8]
        #[arg(id = "type", long = "type", value_name = "TYPE")]
        #[serde(rename = "type")]
        voxel_type: VoxelName,

        /// Decides the vessel tree and all noise [default: 1]
        #[arg(long, value_name = "S", allow_hyphen_values = true)]
        seed: Seed,

        /// Standard deviation of noise added to every voxel, as a share of the value range
        /// [default: 0]
        #[arg(long, value_name = "SHARE", allow_hyphen_values = true)]
        noise: f64,

        /// Compress the voxels with gzip (such a file cannot be mapped when it is read)
        #[arg(long, value_name = "on|off", num_args = 0..=1, require_equals = true,
            default_missing_value = "on")]
        gzip: Switch,
    }
}

group! {
    /// The shape of what is in it.
    #[command(next_help_heading = "Shape")]
    pub struct ShapeOptions {
        /// Sphere: its radius; vessels: the root's radius, mm [default: by the size]
        #[arg(long, value_name = "MM", allow_hyphen_values = true)]
        radius: f64,

        /// Vessels: the radius of the finest tips, mm [default: half a voxel]
        #[arg(long, value_name = "MM", allow_hyphen_values = true)]
        tip_radius: f64,

        /// Slab: its thickness, mm [default: by the size]
        #[arg(long, value_name = "MM", allow_hyphen_values = true)]
        thickness: f64,

        /// Slab: the axis it lies across [default: z]
        #[arg(long, value_name = "x|y|z")]
        axis: Axis,

        /// Gaussian: its standard deviation, mm [default: by the size]
        #[arg(long, value_name = "MM", allow_hyphen_values = true)]
        sigma: f64,
    }
}

impl PhantomArguments {
    pub fn run(self) -> Result<()> {
        let file = self.scene.open()?;
        let mut from_file = file.group::<PhantomOptions>()?;
        from_file.output = from_file.output.map(|path| file.named_here(path));
        // Another kind than the file's has another shape.
        let shape = match self.phantom.kind {
            Some(kind) if from_file.kind.is_some_and(|other| other != kind) => {
                ShapeOptions::default()
            }
            _ => file.group()?,
        };
        let options = self.phantom.over(from_file);
        let shape = self.shape.over(shape);

        let Some(kind) = options.kind else {
            let kinds = PhantomKind::ALL.map(PhantomKind::name).join(", ");
            return Err(Error::usage("no kind of phantom was named")
                .hint(format!("write one of {kinds}, or hardcase:NAME")));
        };
        let output = options.output_file()?;
        let inputs: Vec<&Path> = self.scene.path().into_iter().collect();
        outputs::check(&output, &inputs)?;
        match kind {
            Kind::Phantom(kind) => write_phantom(kind, &options, &shape, &output, &inputs),
            Kind::Hard(chosen) => {
                check_strays(&options, &shape)?;
                hardcase::write(chosen, &output, options.is_gzipped(), &inputs)
            }
        }
    }
}

impl PhantomOptions {
    fn output_file(&self) -> Result<PathBuf> {
        let Some(FilePath(output)) = self.output.clone() else {
            return Err(Error::usage("no file to write was named")
                .hint("give it with '--output', or as 'output' in the scene file"));
        };
        let extension = output.extension();
        if extension.is_some_and(|e| e.eq_ignore_ascii_case("nrrd")) {
            return Ok(output);
        }
        Err(Error::usage(format!(
            "{}: phantoms are written as NRRD",
            output.display()
        ))
        .hint("end the name in .nrrd"))
    }

    fn is_gzipped(&self) -> bool {
        self.gzip.is_some_and(Switch::is_on)
    }

    /// The phantom of a kind that these options and its shape's describe.
    fn spec(&self, kind: PhantomKind, shape: &ShapeOptions) -> Result<PhantomSpec> {
        let dims = match self.size {
            Some(GridSize(dims)) => dims,
            None => Dims::new([u64::from(kind.default_size()); 3])?,
        };
        let default = PhantomSpec::new(kind, dims);
        Ok(PhantomSpec {
            spacing_mm: self
                .spacing
                .map_or(default.spacing_mm, |SpacingMm(each)| each.into()),
            voxel_type: self
                .voxel_type
                .map_or(default.voxel_type, |VoxelName(voxel_type)| voxel_type),
            seed: self.seed.map_or(default.seed, |Seed(seed)| seed),
            radius_mm: shape.radius,
            tip_radius_mm: shape.tip_radius,
            thickness_mm: shape.thickness,
            axis: shape.axis.map(|Axis(axis)| axis),
            sigma_mm: shape.sigma,
            noise: self.noise.unwrap_or(default.noise),
            ..default
        })
    }
}

/// Checks that nothing is given that a hard case has no use for.
fn check_strays(options: &PhantomOptions, shape: &ShapeOptions) -> Result<()> {
    let given = options.given().into_iter().chain(shape.given());
    let mut strays = given.filter(|key| !["kind", "output", "gzip"].contains(&&**key));
    match strays.next() {
        Some(key) => Err(Error::usage(format!(
            "'{}' cannot be combined with a hard case: its voxels are what makes it hard",
            key.replace("voxel-type", "type")
        ))),
        None => Ok(()),
    }
}

fn write_phantom(
    kind: PhantomKind,
    options: &PhantomOptions,
    shape: &ShapeOptions,
    output: &Path,
    inputs: &[&Path],
) -> Result<()> {
    let tree_file = output.with_extension("tree.json");
    if kind == PhantomKind::Vessels {
        outputs::check(&tree_file, inputs)?;
    }
    let spec = options.spec(kind, shape)?;
    let made = phantom(&spec)?;
    made.volume.notes().iter().for_each(note);
    write_nrrd(&made.volume, output, options.is_gzipped())?;
    message(format_args!(
        "wrote {}: {} {}; {}",
        output.display(),
        spec.dims,
        spec.voxel_type,
        made.definition
    ));
    if let Some(tree) = &made.tree {
        write_tree(&tree_file, tree)?;
        message(format_args!(
            "wrote {}: {} vessel segments",
            tree_file.display(),
            tree.segments.len()
        ));
    }
    Ok(())
}

fn write_tree(path: &Path, tree: &VesselTree) -> Result<()> {
    write_atomically(path, |out| {
        serde_json::to_writer_pretty(&mut *out, tree)
            .map_err(std::io::Error::from)
            .and_then(|()| writeln!(out))
            .map_err(|cause| Error::writing(path, "write", &cause))
    })
}

/// The kind of volume that is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    Phantom(PhantomKind),
    Hard(Chosen),
}

impl FromStr for Kind {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let Some(name) = hardcase::name(text) else {
            return text.parse().map(Self::Phantom);
        };
        // Parsers of flags and of scene files pass on no hint.
        let (case, member) = HardCase::named(name).map_err(|error| {
            let hint = error.hint_text().unwrap_or_default();
            Error::usage(format!("{error}: {hint}"))
        })?;
        Ok(Self::Hard(Chosen { case, member }))
    }
}

/// The kinds by name, each with its sentence in the help, and hard cases.
#[derive(Clone)]
struct Kinds;

impl TypedValueParser for Kinds {
    type Value = Kind;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        text: &OsStr,
    ) -> std::result::Result<Kind, clap::Error> {
        if hardcase::name(&text.to_string_lossy()).is_some() {
            let parser = StringValueParser::new().try_map(|text| text.parse::<Kind>());
            return parser.parse_ref(command, argument, text);
        }
        let parser = PossibleValuesParser::new(PhantomKind::ALL.map(PhantomKind::name));
        let parser = parser.try_map(|name| name.parse::<Kind>());
        parser.parse_ref(command, argument, &text.to_ascii_lowercase())
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let kinds =
            PhantomKind::ALL.map(|kind| PossibleValue::new(kind.name()).help(kind.description()));
        let hard = PossibleValue::new("hardcase:NAME").help("A hard case (listed below).");
        Some(Box::new(kinds.into_iter().chain([hard])))
    }
}

/// `NXxNYxNZ`, or `N` for a cube.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridSize(Dims);

impl FromStr for GridSize {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::usage(format!(
                "'{text}' is not a volume size: write N, or NXxNYxNZ such as 64x64x32"
            ))
        };
        let sides: Vec<u64> = text
            .split(['x', 'X', ','])
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

/// The voxel type, as given by `--type`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VoxelName(VoxelType);

impl FromStr for VoxelName {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let is_it = |t: &VoxelType| t.name().eq_ignore_ascii_case(text.trim());
        let found = VoxelType::ALL.into_iter().find(is_it);
        found.map(Self).ok_or_else(|| {
            Error::usage(format!(
                "'{text}' is not a voxel type: write u8, u16, i16 or f32"
            ))
        })
    }
}

/// The seed, as given by `--seed`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seed(pub u64);

impl FromStr for Seed {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        whole(text, 0).map(Self)
    }
}

/// `--axis`: of the index space, 0 to 2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis(usize);

impl FromStr for Axis {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let is_it = |name: &&str| name.eq_ignore_ascii_case(text.trim());
        let found = ["x", "y", "z"].iter().position(is_it);
        found
            .map(Self)
            .ok_or_else(|| Error::usage(format!("'{text}' is not an axis: write x, y or z")))
    }
}

readable!(Kind, GridSize, VoxelName, Seed, Axis);
