//! The numbers that kernels take from the host, each written once: what it is here, and its `-D` name there.

use crate::frame::{Certificate, Kind};
use crate::scene::{
    ClipPlane, DepthCues, DepthOfField, Gradient, Light, LightFrom, QuadratureMethod, Ramp,
    RefineMethod, Reflection, ShadowMethod, Storage, TransferFunction, Traverse,
};

/// An enum that kernels know by numbers.
pub trait KernelEnum: Copy {
    /// Every number under the name that kernels know it by.
    const CONSTANTS: &'static [(&'static str, u32)];

    /// The number of a variant.
    fn number(self) -> u32;
}

/// Gives the variants of an enum their numbers and names in the kernels; after a semicolon a variant whose
/// number no kernel tests, since it has a pass of its own. With `pub enum`, declares the enum too.
macro_rules! kernel_enum {
    (
        $type:ty {
            $($variant:pat => $name:ident = $number:literal),* $(,)?
            $(; $unnamed:pat => $own:literal)?
        }
    ) => {
        impl KernelEnum for $type {
            const CONSTANTS: &'static [(&'static str, u32)] =
                &[$((stringify!($name), $number)),*];

            fn number(self) -> u32 {
                match self {
                    $($variant => $number,)*
                    $($unnamed => $own,)?
                }
            }
        }
    };
    (
        $(#[$doc:meta])*
        pub enum $type:ident: $repr:ident {
            $($(#[$variant_doc:meta])* $variant:ident => $name:ident = $number:literal),* $(,)?
        }
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[repr($repr)]
        pub enum $type { $($(#[$variant_doc])* $variant = $number),* }

        kernel_enum! { $type { $($type::$variant => $name = $number),* } }
    };
}

kernel_enum! {
    Storage {
        Storage::Buffer => STORAGE_BUFFER = 0,
        Storage::Image => STORAGE_IMAGE = 1,
        Storage::Filtered => STORAGE_FILTERED = 2,
    }
}

// Without a traversal everything is sampled.
kernel_enum! {
    Option<Traverse> {
        None => TRAVERSE_OFF = 0,
        Some(Traverse::Uniform) => TRAVERSE_UNIFORM = 1,
        Some(Traverse::KdRestart) => TRAVERSE_KD_RESTART = 2,
        Some(Traverse::Hierarchical) => TRAVERSE_HIERARCHICAL = 3,
        Some(Traverse::Revelles) => TRAVERSE_REVELLES = 4,
        Some(Traverse::Distance) => TRAVERSE_DISTANCE = 5,
    }
}

kernel_enum! {
    RefineMethod {
        RefineMethod::None => REFINE_NONE = 0,
        RefineMethod::Bisection => REFINE_BISECTION = 1,
        RefineMethod::RegulaFalsi => REFINE_REGULA_FALSI = 2,
        RefineMethod::Illinois => REFINE_ILLINOIS = 3,
        RefineMethod::Newton => REFINE_NEWTON = 4,
    }
}

kernel_enum! {
    Gradient {
        Gradient::Central => GRADIENT_CENTRAL = 0,
        Gradient::Forward => GRADIENT_FORWARD = 1,
        Gradient::FourthOrder => GRADIENT_FOURTH_ORDER = 2,
        Gradient::Precomputed(_) => GRADIENT_PRECOMPUTED = 3,
    }
}

kernel_enum! {
    Ramp {
        Ramp::Full => RAMP_FULL = 0,
        Ramp::RedWhiteBlue => RAMP_RED_WHITE_BLUE = 1,
    }
}

kernel_enum! {
    Option<Reflection> {
        None => REFLECTION_NONE = 0,
        Some(Reflection::Phong) => REFLECTION_PHONG = 1,
        Some(Reflection::BlinnPhong) => REFLECTION_BLINN_PHONG = 2,
    }
}

kernel_enum! {
    LightFrom {
        LightFrom::Eye => LIGHT_FROM_EYE = 0,
        LightFrom::Direction(_) => LIGHT_FROM_DIRECTION = 1,
        LightFrom::Point(_) => LIGHT_FROM_POINT = 2,
    }
}

kernel_enum! {
    Option<ShadowMethod> {
        None => SHADOWS_NONE = 0,
        Some(ShadowMethod::Exact) => SHADOWS_EXACT = 1,
        Some(ShadowMethod::Stepped(_)) => SHADOWS_STEPPED = 2,
        Some(ShadowMethod::Cached(_)) => SHADOWS_CACHED = 3,
    }
}

kernel_enum! {
    QuadratureMethod {
        QuadratureMethod::Riemann => QUADRATURE_RIEMANN = 0,
        QuadratureMethod::Midpoint => QUADRATURE_MIDPOINT = 1,
        QuadratureMethod::Simpson => QUADRATURE_SIMPSON = 2,
        QuadratureMethod::Romberg => QUADRATURE_ROMBERG = 3,
        QuadratureMethod::Rk4 => QUADRATURE_RK4 = 4,
        QuadratureMethod::Preintegrated => QUADRATURE_PREINTEGRATED = 5;
        QuadratureMethod::Adaptive => 6
    }
}

kernel_enum! {
    /// The class of an octree node: what is known of it before a ray meets it.
    pub enum Class: u8 {
        /// Nothing to see: wholly below the iso value, nowhere above the floor, or wholly transparent.
        Below => CLASS_BELOW = 0,
        /// Wholly at or above the iso value.
        Above => CLASS_ABOVE = 1,
        /// The node must be sampled.
        Visit => CLASS_VISIT = 2,
        /// A leaf that its average value stands for.
        Homogeneous => CLASS_HOMOGENEOUS = 3,
    }
}

kernel_enum! {
    /// Where the rays of a launch come from.
    pub enum Rays: u32 {
        /// A ray for every pixel of a camera's picture.
        Camera => RAYS_CAMERA = 0,
        /// A ray for each of some pixels of a camera's picture.
        Pixels => RAYS_PIXELS = 1,
        /// Rays that are given one by one.
        Buffers => RAYS_BUFFERS = 2,
        /// Several rays in each of some pixels of a camera's picture.
        Samples => RAYS_SAMPLES = 3,
    }
}

kernel_enum! {
    /// What a sparsely cast picture's pixels are filled with that were not cast.
    pub enum Filling: u32 {
        /// What a ray leaves that meets nothing.
        Empty => FILLING_EMPTY = 0,
        /// What is interpolated between the crossings of a grid.
        Grid => FILLING_GRID = 1,
        /// What is interpolated between the corners of blocks that have theirs to themselves; what a ray leaves that meets
        /// nothing where there is no block.
        Blocks => FILLING_BLOCKS = 2,
    }
}

kernel_enum! {
    /// By what is known which pixels' first rays met something.
    pub enum SeenBy: u32 {
        /// No pixel has had a ray.
        Nothing => SEEN_NOTHING = 0,
        /// A surface's kinds.
        Kinds => SEEN_KINDS = 1,
        /// A medium's opacities.
        Opacities => SEEN_OPACITIES = 2,
    }
}

kernel_enum! {
    /// The loops of the projections' casts.
    pub enum ProjectionLoop: u32 {
        /// The greatest or smallest value.
        Extremum => PROJECTION_EXTREMUM = 0,
        /// The average value.
        Mean => PROJECTION_MEAN = 1,
        /// The first local maximum that reaches the threshold.
        Local => PROJECTION_LOCAL = 2,
    }
}

/// Cells along each axis of a brick, whose bits are a word: the rays of a tile touch several bricks in
/// each slice of cells.
pub const BRICK: usize = 4;

/// The lowest bits of a node's byte, which hold its [`Class`]; the others hold its distance.
pub const CLASS_BITS: u32 = 2;

/// The greatest Chebyshev distance that a node's byte holds, in leaves.
pub const MAX_DISTANCE: u32 = (1 << (8 - CLASS_BITS)) - 1;

/// The most samples of a ray: single precision counts no further.
pub const MAX_SAMPLES: u32 = 1 << 24;

/// The most parts into which an interval of a transfer function is divided when it is made smooth:
/// ln(1 − MAX_OPACITY) / −ln of the greatest ratio within a part, and one beyond the greatest opacity.
pub const SMOOTH_PARTS: usize = 36;

/// The most knots that the device is given.
const MAX_KNOTS: u32 = (TransferFunction::MAX_KNOTS * SMOOTH_PARTS) as u32;

/// How often the adaptive quadrature halves a monotone piece of a cell.
const ADAPTIVE_HALVINGS: u32 = 10;

/// Pixels along the edge of the squares in which pixels are counted and listed to be cast.
pub const LISTED_SQUARE: u32 = 16;

/// Of so many pixels with one ray, beside others with many, one is checked with many.
pub const CHECKED_OF: u32 = 256;

/// How many sets of directions there are in which rays leave points of a surface: each pixel of a square has its own.
pub const RAY_SETS: u32 = 64;

/// Pixels along each side of the squares in which each pixel looks at its surroundings in sections of its own.
pub const SECTION_SQUARE: u32 = 4;

/// Parts of a section's half circle, a bit each: words of 32 bits are shifted by less.
pub const SECTORS: u32 = 31;

/// Pixels along the edge of the squares of which it is known how far the circles of confusion reach.
pub const BLURRED_SQUARE: u32 = 8;

/// The mark of a pixel that was cast.
pub const MARK_CAST: u32 = 1;

/// The mark of a pixel that is cast next.
pub const MARK_NEXT: u32 = 2;

/// The mark of pixels that are interpolated in a block that has its corners to itself.
const MARK_BLOCK: u32 = 3;

/// The numbers that belong to no enum, or to one whose own numbers pictures hold.
const NUMBERS: &[(&str, u32)] = &[
    ("MAX_SAMPLES", MAX_SAMPLES),
    ("BRICK", BRICK as u32),
    ("CLASS_BITS", CLASS_BITS),
    ("MAX_DISTANCE", MAX_DISTANCE),
    ("MAX_CLIP_PLANES", ClipPlane::MAX_COUNT as u32),
    ("MAX_LIGHTS", Light::MAX_COUNT as u32),
    ("MAX_KNOTS", MAX_KNOTS),
    ("ADAPTIVE_HALVINGS", ADAPTIVE_HALVINGS),
    ("LISTED_SQUARE", LISTED_SQUARE),
    ("CHECKED_OF", CHECKED_OF),
    ("RAY_SETS", RAY_SETS),
    ("SECTION_SQUARE", SECTION_SQUARE),
    ("SECTORS", SECTORS),
    ("DARKEST_PX", DepthOfField::DARKEST_PX as u32),
    ("WIDEST_PX", DepthOfField::WIDEST_PX as u32),
    ("BLURRED_SQUARE", BLURRED_SQUARE),
    ("HALO_SLOPE", DepthCues::HALO_SLOPE),
    ("CONTOUR_SLOPE", DepthCues::CONTOUR_SLOPE),
    ("CONTOUR_EXCESS", DepthCues::CONTOUR_EXCESS),
    // What becomes of a pixel of a sparsely cast picture: it is filled, it was cast, it is cast next, it belongs to a block
    // that is interpolated (kernels/lib/ray/marks.clh).
    ("MARK_FILLED", 0),
    ("MARK_CAST", MARK_CAST),
    ("MARK_NEXT", MARK_NEXT),
    ("MARK_BLOCK", MARK_BLOCK),
    ("KIND_NOTHING", Kind::Nothing as u32),
    ("KIND_SURFACE", Kind::Surface as u32),
    ("KIND_CAP", Kind::Cap as u32),
    ("CERTIFICATE_MISS", Certificate::Miss as u32),
    ("CERTIFICATE_HIT", Certificate::Hit as u32),
    ("CERTIFICATE_UNDECIDED", Certificate::Undecided as u32),
];

/// Every constant that kernels take from the host, by name.
pub fn constants() -> impl Iterator<Item = (&'static str, u32)> {
    let tables = [
        NUMBERS,
        Storage::CONSTANTS,
        <Option<Traverse>>::CONSTANTS,
        RefineMethod::CONSTANTS,
        Gradient::CONSTANTS,
        <Option<Reflection>>::CONSTANTS,
        LightFrom::CONSTANTS,
        <Option<ShadowMethod>>::CONSTANTS,
        QuadratureMethod::CONSTANTS,
        Class::CONSTANTS,
        Rays::CONSTANTS,
        ProjectionLoop::CONSTANTS,
        Filling::CONSTANTS,
        Ramp::CONSTANTS,
        SeenBy::CONSTANTS,
    ];
    tables.into_iter().flatten().copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_constant_has_a_name_of_its_own() {
        let mut names: Vec<&str> = constants().map(|(name, _)| name).collect();
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count);
    }

    #[test]
    fn numbers_of_an_enum_differ() {
        for table in [
            <Option<Traverse>>::CONSTANTS,
            QuadratureMethod::CONSTANTS,
            Class::CONSTANTS,
        ] {
            let mut numbers: Vec<u32> = table.iter().map(|(_, number)| *number).collect();
            numbers.dedup();
            assert_eq!(numbers, (0..table.len() as u32).collect::<Vec<u32>>());
        }
    }
}
