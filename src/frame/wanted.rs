//! Which planes a picture is to have.

use super::format::Encoding;
use super::layer::Layer;

/// The planes that a renderer is to fill besides the colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wanted {
    /// Whether the picture is wanted as it is displayed.
    pub display: bool,
    layers: [bool; Layer::COUNT],
}

impl Wanted {
    /// Everything that there is.
    pub const ALL: Self = Self {
        display: true,
        layers: [true; Layer::COUNT],
    };

    /// The colour alone.
    pub const NONE: Self = Self {
        display: false,
        layers: [false; Layer::COUNT],
    };

    /// A picture for display, without layers.
    pub const DISPLAY: Self = Self {
        display: true,
        ..Self::NONE
    };

    /// Adds these layers.
    #[must_use]
    pub const fn with<const N: usize>(mut self, layers: [Layer; N]) -> Self {
        let mut n = 0;
        while n < N {
            self.layers[layers[n] as usize] = true;
            n += 1;
        }
        self
    }

    /// Adds this layer if `wanted`.
    #[must_use]
    pub const fn with_if(mut self, wanted: bool, layer: Layer) -> Self {
        self.layers[layer as usize] |= wanted;
        self
    }

    /// Removes these layers.
    #[must_use]
    pub const fn without<const N: usize>(mut self, layers: [Layer; N]) -> Self {
        let mut n = 0;
        while n < N {
            self.layers[layers[n] as usize] = false;
            n += 1;
        }
        self
    }

    /// Whether a layer is wanted.
    pub const fn has(&self, layer: Layer) -> bool {
        self.layers[layer as usize]
    }

    /// Whether any layer is wanted.
    pub fn has_layers(&self) -> bool {
        self.layers().next().is_some()
    }

    /// Whether any of these layers is wanted.
    pub fn has_any<const N: usize>(&self, layers: [Layer; N]) -> bool {
        layers.into_iter().any(|layer| self.has(layer))
    }

    /// The wanted layers, in the order of [`Layer::ALL`].
    pub fn layers(&self) -> impl Iterator<Item = Layer> {
        let wanted = self.layers;
        let layers = Layer::ALL.into_iter();
        layers.filter(move |&layer| wanted[layer as usize])
    }

    /// The planes that a file in `encoding` is written from; with `stats` also those that the
    /// statistics count (steps, nodes, hits).
    pub fn for_encoding(encoding: &Encoding, stats: bool) -> Self {
        let mut wanted = Self {
            display: encoding.format.is_display(),
            ..Self::NONE
        };
        for layer in encoding.layers_in_order() {
            wanted = wanted.with([layer]);
        }
        if stats {
            wanted = wanted.with(Layer::COUNTERS).with([Layer::Kind]);
        }
        wanted
    }
}
