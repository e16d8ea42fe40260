//! `kernels/lib/ray/differ.clh`: what pixels are compared by.

use crate::frame::Layer;
use crate::gpu::{Args, Buffer, Defines, Group};
use crate::render::resources::DeviceLayers;

/// When two pixels differ.
#[derive(Debug, Clone, Copy)]
pub struct Differs {
    /// The greatest difference of channels, sRGB-encoded, that is none.
    pub threshold: f32,
    /// The distance of neighbouring rays, mm, at t = 0 and its growth per mm.
    pub footprint: [f32; 2],
}

/// The planes by which pixels are compared.
#[derive(Clone, Copy)]
pub struct Compared<'a> {
    /// Linear light, premultiplied.
    pub color: &'a Buffer<[f32; 4]>,
    /// A surface's t.
    pub hit_mm: Option<&'a Buffer<f32>>,
    /// The layers; `None`: colours alone are compared.
    pub layers: Option<&'a DeviceLayers>,
}

impl Compared<'_> {
    fn has(&self, layer: Layer) -> bool {
        self.layers.is_some_and(|layers| layers.has(layer))
    }

    /// Whether kinds are compared.
    fn with_kind(&self) -> bool {
        self.has(Layer::Kind)
    }

    /// Whether a surface's normals and t are.
    fn with_surface(&self) -> bool {
        self.hit_mm.is_some() && self.has(Layer::Normal)
    }

    /// Adds the switches of what is compared.
    pub fn define(&self, defines: Defines) -> Defines {
        defines
            .with("WITH_KIND", u32::from(self.with_kind()))
            .with("WITH_SURFACE", u32::from(self.with_surface()))
    }
}

impl Group for Compared<'_> {
    fn add_to(self, args: Args) -> Args {
        let layers = |wanted: bool, layer| {
            let planes = self.layers.filter(|_| wanted);
            planes.map(|planes| planes.reading(layer))
        };
        args.read("color", self.color)
            .with(layers(self.with_kind(), &[Layer::Kind]))
            .with(layers(self.with_surface(), &[Layer::Normal]))
            .read_some("hit_mm", self.hit_mm.filter(|_| self.with_surface()))
    }
}
