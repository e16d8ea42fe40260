//! The switches that reshape an inner loop, and the constants that kernels take from the host.

use crate::frame::{Certificate, Kind};
use crate::gpu::Defines;
use crate::octree::{Leaf, Octree};
use crate::scene::{
    ClipPlane, Filter, Gradient, Phong, QuadratureMethod, Refine, RefineMethod, Reflection,
    Sampling, Storage, Traverse,
};
use crate::volume::{Volume, VoxelType};

use super::cells;
use super::classify::Class;
use super::lanes::Lanes;
use super::medium;
use super::reach::{CLASS_BITS, REACH_MOST};

/// What every pass over a volume is built for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Variant {
    pub voxel: VoxelType,
    pub filter: Filter,
    pub leaf: Leaf,
    /// More voxels than 32 bits count.
    pub wide_index: bool,
    pub lanes: Lanes,
    pub storage: Storage,
}

/// The OpenCL name of a voxel type.
pub fn voxel_cl_name(voxel: VoxelType) -> &'static str {
    match voxel {
        VoxelType::U8 => "uchar",
        VoxelType::U16 => "ushort",
        VoxelType::I16 => "short",
        VoxelType::F32 => "float",
    }
}

impl Variant {
    /// Vectors index voxels by 32 bits: larger volumes are cast ray by ray.
    pub fn of(volume: &Volume, octree: &Octree, sampling: &Sampling, lanes: Lanes) -> Self {
        let wide_index = volume.dims().voxels() > u64::from(u32::MAX);
        Self {
            voxel: volume.voxels().voxel_type(),
            filter: sampling.filter,
            leaf: octree.leaf(),
            wide_index,
            lanes: if wide_index { Lanes::ONE } else { lanes },
            storage: sampling.voxels,
        }
    }

    /// The constants of this variant and those common to all.
    pub fn defines(self) -> Defines {
        let defines = Defines::default()
            .with("VOXEL", voxel_cl_name(self.voxel))
            .with("INDEX", if self.wide_index { "ulong" } else { "uint" })
            .with("LEAF", format!("{}u", self.leaf))
            .with("FILTER_LINEAR", u32::from(self.filter == Filter::Linear))
            .with("STORAGE", storage_constant(self.storage));
        CONSTANTS.iter().fold(defines, |defines, &(name, number)| {
            defines.with(name, number)
        })
    }
}

const fn storage_constant(storage: Storage) -> u32 {
    match storage {
        Storage::Buffer => 0,
        Storage::Image => 1,
        Storage::Filtered => 2,
    }
}

const TRAVERSE_OFF: u32 = 0;

/// How the kernels are told to traverse; `TRAVERSE_OFF` samples everything.
pub fn traverse_number(sampling: &Sampling) -> u32 {
    if sampling.skip {
        traverse_constant(sampling.traverse)
    } else {
        TRAVERSE_OFF
    }
}

/// The same where every leaf must be met: without skipping, one leaf after the other.
pub fn traverse_through_leaves(sampling: &Sampling) -> u32 {
    traverse_constant(if sampling.skip {
        sampling.traverse
    } else {
        Traverse::Uniform
    })
}

const fn traverse_constant(traverse: Traverse) -> u32 {
    match traverse {
        Traverse::Uniform => 1,
        Traverse::KdRestart => 2,
        Traverse::Hierarchical => 3,
        Traverse::Revelles => 4,
        Traverse::Distance => 5,
    }
}

pub fn refine_number(refine: Refine) -> u32 {
    refine_constant(refine.method())
}

const fn refine_constant(method: RefineMethod) -> u32 {
    match method {
        RefineMethod::None => 0,
        RefineMethod::Bisection => 1,
        RefineMethod::RegulaFalsi => 2,
        RefineMethod::Illinois => 3,
        RefineMethod::Newton => 4,
    }
}

pub const GRADIENT_PRECOMPUTED: u32 = 3;

/// How the kernels are told to find gradients.
pub const fn gradient_constant(gradient: Gradient) -> u32 {
    match gradient {
        Gradient::Central => 0,
        Gradient::Forward => 1,
        Gradient::FourthOrder => 2,
        Gradient::Precomputed(_) => GRADIENT_PRECOMPUTED,
    }
}

const REFLECTION_NONE: u32 = 0;

pub fn reflection_number(phong: Option<Phong>) -> u32 {
    phong.map_or(REFLECTION_NONE, |phong| {
        reflection_constant(phong.reflection)
    })
}

const fn reflection_constant(reflection: Reflection) -> u32 {
    match reflection {
        Reflection::Phong => 1,
        Reflection::BlinnPhong => 2,
    }
}

pub const fn quadrature_constant(method: QuadratureMethod) -> u32 {
    match method {
        QuadratureMethod::Riemann => 0,
        QuadratureMethod::Midpoint => 1,
        QuadratureMethod::Simpson => 2,
        QuadratureMethod::Romberg => 3,
        QuadratureMethod::Rk4 => 4,
        QuadratureMethod::Preintegrated => 5,
        QuadratureMethod::Adaptive => 6,
    }
}

/// The loops of `cast_maximum`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ProjectionLoop {
    Extremum = 0,
    Mean = 1,
    Local = 2,
}

/// How often the adaptive quadrature halves a monotone piece of a cell.
const ADAPTIVE_HALVINGS: u32 = 10;

/// The most samples of a ray: single precision counts no further.
pub const MOST_SAMPLES: u32 = 1 << 24;

const CONSTANTS: &[(&str, u32)] = &[
    ("LATTICE_MOST_SAMPLES", MOST_SAMPLES),
    ("BRICK", cells::BRICK as u32),
    ("CLIP_MOST_PLANES", ClipPlane::MAX_COUNT as u32),
    ("ADAPTIVE_HALVINGS", ADAPTIVE_HALVINGS),
    ("TRANSFER_MOST_KNOTS", medium::MOST_KNOTS),
    ("KIND_NOTHING", Kind::Nothing as u32),
    ("KIND_SURFACE", Kind::Surface as u32),
    ("KIND_CAP", Kind::Cap as u32),
    ("STORAGE_BUFFER", storage_constant(Storage::Buffer)),
    ("STORAGE_IMAGE", storage_constant(Storage::Image)),
    ("STORAGE_FILTERED", storage_constant(Storage::Filtered)),
    ("TRAVERSE_OFF", TRAVERSE_OFF),
    ("TRAVERSE_UNIFORM", traverse_constant(Traverse::Uniform)),
    (
        "TRAVERSE_KD_RESTART",
        traverse_constant(Traverse::KdRestart),
    ),
    (
        "TRAVERSE_HIERARCHICAL",
        traverse_constant(Traverse::Hierarchical),
    ),
    ("TRAVERSE_REVELLES", traverse_constant(Traverse::Revelles)),
    ("TRAVERSE_DISTANCE", traverse_constant(Traverse::Distance)),
    ("CLASS_BITS", CLASS_BITS),
    ("REACH_MOST", REACH_MOST),
    ("CERTIFICATE_MISS", Certificate::Miss as u32),
    ("CERTIFICATE_HIT", Certificate::Hit as u32),
    ("CERTIFICATE_UNDECIDED", Certificate::Undecided as u32),
    ("CLASS_BELOW", Class::Below as u32),
    ("CLASS_ABOVE", Class::Above as u32),
    ("CLASS_VISIT", Class::Visit as u32),
    ("CLASS_HOMOGENEOUS", Class::Homogeneous as u32),
    (
        "QUADRATURE_RIEMANN",
        quadrature_constant(QuadratureMethod::Riemann),
    ),
    (
        "QUADRATURE_MIDPOINT",
        quadrature_constant(QuadratureMethod::Midpoint),
    ),
    (
        "QUADRATURE_SIMPSON",
        quadrature_constant(QuadratureMethod::Simpson),
    ),
    (
        "QUADRATURE_ROMBERG",
        quadrature_constant(QuadratureMethod::Romberg),
    ),
    ("QUADRATURE_RK4", quadrature_constant(QuadratureMethod::Rk4)),
    (
        "QUADRATURE_PREINTEGRATED",
        quadrature_constant(QuadratureMethod::Preintegrated),
    ),
    ("REFINE_NONE", refine_constant(RefineMethod::None)),
    ("REFINE_BISECTION", refine_constant(RefineMethod::Bisection)),
    (
        "REFINE_REGULA_FALSI",
        refine_constant(RefineMethod::RegulaFalsi),
    ),
    ("REFINE_ILLINOIS", refine_constant(RefineMethod::Illinois)),
    ("REFINE_NEWTON", refine_constant(RefineMethod::Newton)),
    ("GRADIENT_CENTRAL", gradient_constant(Gradient::Central)),
    ("GRADIENT_FORWARD", gradient_constant(Gradient::Forward)),
    (
        "GRADIENT_FOURTH_ORDER",
        gradient_constant(Gradient::FourthOrder),
    ),
    ("GRADIENT_PRECOMPUTED", GRADIENT_PRECOMPUTED),
    ("REFLECTION_NONE", REFLECTION_NONE),
    ("REFLECTION_PHONG", reflection_constant(Reflection::Phong)),
    (
        "REFLECTION_BLINN_PHONG",
        reflection_constant(Reflection::BlinnPhong),
    ),
    ("PROJECTION_EXTREMUM", ProjectionLoop::Extremum as u32),
    ("PROJECTION_MEAN", ProjectionLoop::Mean as u32),
    ("PROJECTION_LOCAL", ProjectionLoop::Local as u32),
];
