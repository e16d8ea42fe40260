//! The structs of `kernels/lib/abi.clh`, field for field. Padding is spelled out.

use bytemuck::{Pod, Zeroable};

use crate::gpu::Element;
use crate::scene::Light;

/// Declares a struct that kernels have too: plain, of the name that OpenCL knows, without implicit padding.
macro_rules! device_struct {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
        #[repr(C)]
        pub struct $name { $($(#[$field_doc])* pub $field: $type),* }

        // SAFETY: the struct of this name in abi.clh; a test compares every offset.
        unsafe impl Element for $name {
            const CL_NAME: &'static str = stringify!($name);
        }

        impl $name {
            /// Size, then each field's offset, in bytes: what the device must have too.
            pub fn layout() -> Vec<u32> {
                vec![
                    size_of::<Self>() as u32,
                    $(std::mem::offset_of!(Self, $field) as u32),*
                ]
            }
        }
    };
}

device_struct! {
    /// The rays of all pixels, in index space; see abi.clh.
    RayGrid {
        origin: [f32; 4],
        origin_dx: [f32; 4],
        origin_dy: [f32; 4],
        /// The rest of the floats above to their values in double precision, as for the directions.
        origin_low: [f32; 4],
        origin_dx_low: [f32; 4],
        origin_dy_low: [f32; 4],
        dir_index: [f32; 4],
        dir_index_dx: [f32; 4],
        dir_index_dy: [f32; 4],
        dir_index_low: [f32; 4],
        dir_index_dx_low: [f32; 4],
        dir_index_dy_low: [f32; 4],
        dir_world: [f32; 4],
        dir_world_dx: [f32; 4],
        dir_world_dy: [f32; 4],
        base_mm: f32,
        width: u32,
        height: u32,
        pad: u32,
    }
}

device_struct! {
    /// Sizes, and the map from index-space to world-space covectors.
    VolumeGrid {
        gradient_row_x: [f32; 4],
        gradient_row_y: [f32; 4],
        gradient_row_z: [f32; 4],
        nx: u32,
        ny: u32,
        nz: u32,
        levels: u32,
    }
}

device_struct! {
    /// The numbers of a surface's cast.
    SurfaceCast {
        /// The iso value in stored units.
        iso: f32,
        step_mm: f32,
        caps: u32,
        refine: u32,
        iterations: u32,
        traverse: u32,
        probe: u32,
        /// How far `iso` is from the scene's iso value.
        iso_error: f32,
    }
}

device_struct! {
    /// The numbers of a projection's cast.
    ProjectionCast {
        step_mm: f32,
        /// +1 looks for maxima, −1 for minima.
        sign: f32,
        /// The threshold of local maxima in stored units.
        threshold: f32,
        traverse: u32,
        probe: u32,
        /// The floor of sign · Φ in stored units: what is not above it need not be found.
        floor: f32,
        pad_0: u32,
        pad_1: u32,
    }
}

device_struct! {
    /// The numbers of an emission's cast.
    EmissionCast {
        step_mm: f32,
        unit_length_mm: f32,
        /// The absorption of the unit length at the greatest opacity: −ln(1 − opacity).
        max_absorption: f32,
        min_transmittance: f32,
        knots: u32,
        traverse: u32,
        /// The bound of the adaptive quadrature's error.
        bound: f32,
        /// The most by which the knots' colours differ in a channel.
        color_spread: f32,
        /// The range of values that absorb, in stored units.
        absorbs_from: f32,
        absorbs_to: f32,
        /// The opacity from which a pixel has a depth, a value and a normal.
        layers_from: f32,
        /// The mm of a unit of t along the rays that leave a point ([`super::covector_scale`]).
        mm_per_t: f32,
        /// The distance of samples along the rays toward lights.
        shadow_step_mm: f32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

device_struct! {
    /// How the samples of rays are shifted.
    Jitter {
        /// The parts of a step in which shifts are counted.
        parts: u32,
        /// Whether a ray's parts are a hash; else they are one of `side` × `side` offsets.
        hashed: u32,
        side: u32,
        along_x: u32,
        along_y: u32,
        /// The first ray's parts, or what goes into all hashes.
        start: u32,
        pad_0: u32,
        pad_1: u32,
    }
}

device_struct! {
    /// A grid of optical depths that stands in a light: `side` points along each edge of a square across it, and as many
    /// one behind the other. Index space: dot products with (p, 1).
    LightGrid {
        /// A point's column, times what `over` gives.
        x: [f32; 4],
        /// A point's row, times what `over` gives.
        y: [f32; 4],
        over: [f32; 4],
        /// A point's place along the light.
        depth: [f32; 4],
        /// 0: the light has no grid.
        side: u32,
        /// The first of its depths.
        first: u32,
        /// The distance of points along the light.
        spacing_mm: f32,
        pad: u32,
    }
}

device_struct! {
    /// A light: from where it shines, and what of it is reflected at most.
    LightSource {
        /// The unit vector toward a distant light, world space; a point's place, index space.
        place: [f32; 4],
        /// The factor of the base colour where the light is faced, linear light.
        diffuse: [f32; 4],
        /// The factor of the specular term, linear light.
        specular: [f32; 4],
        shines_from: u32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

device_struct! {
    /// The lights and how a surface or a medium reflects them.
    Shading {
        color: [f32; 4],
        /// The factor of the base colour that no light has a part in, linear light.
        ambient: [f32; 4],
        /// The rows of the map from index-space to world-space vectors, all to one scale.
        world_row_x: [f32; 4],
        world_row_y: [f32; 4],
        world_row_z: [f32; 4],
        lights: [LightSource; Light::MAX_COUNT],
        light_count: u32,
        shininess: f32,
        reflection: u32,
        /// The gradient from which a medium is shaded fully, in the units of `VolumeGrid`'s rows; 0: everywhere.
        shaded_from: f32,
    }
}

device_struct! {
    /// How linear light becomes what is displayed.
    Tone {
        background: [f32; 4],
        brightness: f32,
        contrast: f32,
        inverse_gamma: f32,
        pad: u32,
    }
}
