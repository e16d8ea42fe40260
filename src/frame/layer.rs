//! The layers that a picture can carry beside its colour: one table of all that is known of each.

use std::marker::PhantomData;

use super::pixel::{Certificate, Kind};

/// The value of every entry of a new plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FillValue {
    /// A number.
    Scalar(f32),
    /// Three components.
    Vector([f32; 3]),
    /// A whole number; files hold it as a float, exact up to 2^24.
    Count(u32),
}

/// A layer together with the type of its plane's entries.
#[derive(Debug)]
pub struct Key<T> {
    layer: Layer,
    entry: PhantomData<fn() -> T>,
}

impl<T> Key<T> {
    const fn new(layer: Layer) -> Self {
        Self {
            layer,
            entry: PhantomData,
        }
    }

    /// The layer that the key stands for.
    pub const fn layer(&self) -> Layer {
        self.layer
    }
}

impl<T> Clone for Key<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Key<T> {}

/// Declares the layers: for each its key and entry type, what its plane holds where a picture has nothing to
/// say, and its names.
macro_rules! layers {
    ($($(#[$doc:meta])* $layer:ident, $key:ident: $entry:ty = $empty:expr, $name:literal, $channels:expr;)*) => {
        /// The layers beside the colour that a picture can carry (`--aov`).
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Layer { $($(#[$doc])* $layer),* }

        impl Layer {
            /// Every layer, in the order in which files hold them.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$layer),*];

            /// The layer's name in `--aov` and as an argument of kernels.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$layer => $name),* }
            }

            /// The names of its channels in a file.
            pub const fn channels(self) -> &'static [&'static str] {
                match self { $(Self::$layer => &$channels),* }
            }

            /// The value that a plane of this layer holds where no ray met anything and nothing is known; `None` where
            /// a picture has no such plane unless something makes one.
            pub const fn empty(self) -> Option<FillValue> {
                match self { $(Self::$layer => $empty),* }
            }
        }

        $(
            #[doc = concat!("The plane of the layer `", $name, "`.")]
            pub const $key: Key<$entry> = Key::new(Layer::$layer);
        )*
    };
}

layers! {
    /// Distance from the eye along the ray, mm (from the eye plane in orthographic projection); +∞:
    /// none.
    Depth, DEPTH: f32 = Some(FillValue::Scalar(f32::INFINITY)), "depth", ["depth.Z"];
    /// The unit normal in world space, toward lower values; 0 where nothing is hit.
    Normal, NORMAL: [f32; 3] = Some(FillValue::Vector([0.0; 3])), "normal", ["normal.X", "normal.Y", "normal.Z"];
    /// Φ at the hit, or the projected value, physical; 0 where nothing is hit.
    Value, VALUE: f32 = Some(FillValue::Scalar(0.0)), "value", ["value.V"];
    /// Samples taken (cells visited, in the reference).
    Steps, STEPS: u32 = Some(FillValue::Count(0)), "steps", ["steps.N"];
    /// Hierarchy nodes visited (0 in the reference).
    Nodes, NODES: u32 = Some(FillValue::Count(0)), "nodes", ["nodes.N"];
    /// 1 where a ray was cast, 0 where the pixel was filled from others; without a plane every pixel had its ray.
    Cast, CAST: u32 = None, "cast", ["cast.V"];
    /// A [`Kind`] as a number.
    Kind, KIND: u32 = Some(FillValue::Count(Kind::Nothing as u32)), "kind", ["kind.V"];
    /// A [`Certificate`] as a number.
    Certificate, CERTIFICATE: u32 = Some(FillValue::Count(Certificate::Undecided as u32)), "certificate", ["certificate.V"];
    /// The share of a pixel's rays that met something.
    Coverage, COVERAGE: f32 = Some(FillValue::Scalar(0.0)), "coverage", ["coverage.V"];
    /// The share of the light from everywhere that a surface keeps from the hit; 0 where nothing is hit or none is asked for.
    Occlusion, OCCLUSION: f32 = Some(FillValue::Scalar(0.0)), "occlusion", ["occlusion.V"];
    /// How far from the occlusion that is said that of the definition may be, where `--ao bound=E` bounds it; 1 where the occlusion was
    /// filled from other pixels', 0 where nothing is hit or no bound is asked for.
    OcclusionBound, OCCLUSION_BOUND: f32 = Some(FillValue::Scalar(0.0)), "occlusion_bound", ["occlusion_bound.V"];
    /// The share of the first light that reaches the hit; of a medium the mean along the ray, weighted as its light is.
    /// 0 where nothing is hit or no shadows are asked for.
    Visibility, VISIBILITY: f32 = Some(FillValue::Scalar(0.0)), "visibility", ["visibility.V"];
    /// How far the ray goes on behind the hit to its next crossing of the surface, or to the end of what is seen of it, mm; 0
    /// where nothing is hit.
    Thick, THICK: f32 = Some(FillValue::Scalar(0.0)), "thick", ["thick.V"];
    /// The diameter of the circle of confusion, pixels, above 0 behind the focal plane; where nothing is seen that of what is
    /// infinitely far away. 0 without a lens.
    Coc, COC: f32 = Some(FillValue::Scalar(0.0)), "coc", ["coc.V"];
}

impl Layer {
    /// How many layers there are.
    pub const COUNT: usize = Self::ALL.len();

    /// The layers that say how a picture was made and not what it shows.
    pub const COUNTERS: [Self; 2] = [Self::Steps, Self::Nodes];
}
