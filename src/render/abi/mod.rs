//! What host and kernels agree on: structs, constants, the switches of a build, and units.

mod constants;
mod convert;
mod lanes;
mod shading;
mod structs;
mod variant;

pub use constants::{
    BLURRED_SQUARE, BRICK, CHECKED_OF, CLASS_BITS, Class, Filling, KernelEnum, LISTED_SQUARE,
    MARK_CAST, MARK_NEXT, MAX_DISTANCE, MAX_SAMPLES, ProjectionLoop, RAY_SETS, Rays,
    SECTION_SQUARE, SECTORS, SMOOTH_PARTS, SeenBy,
};
pub use convert::{StoredIso, jitter, step_mm, stored, stored_window, struct_layouts, tone};
pub use lanes::Lanes;
pub use shading::{Material, covector_scale, shading};
pub use structs::{
    EmissionCast, Jitter, LightGrid, ProjectionCast, RayGrid, Shading, SurfaceCast, Tone,
    VolumeGrid,
};
pub use variant::{Variant, voxel_cl_name};
