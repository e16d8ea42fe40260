//! Image planes: the layers of one picture, row 0 at the top, x fastest; written as files
//! ([`write()`]) and compared with each other ([`mod@error`]).

mod animation;
mod bit_equal;
mod channel;
pub mod error;
mod exr;
mod format;
mod image_error;
mod jpeg;
mod metadata;
mod npy;
pub mod palette;
mod percentile;
mod png;
mod quantize;
mod webp;
mod whole;
mod write;

pub use animation::{Animation, AnimationFormat, FrameRate, Reel};
pub use channel::channels;
pub use format::{BitDepth, Encoding, Format};
pub use metadata::{carrier, read_encoding, read_metadata};
pub use percentile::{median, percentile};
pub use png::read_display;
pub use whole::is_whole;
pub use write::write;

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::memory;

/// What a pixel's ray met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Kind {
    Nothing = 0,
    Surface = 1,
    /// The volume's face, where it is above the iso value.
    Cap = 2,
    Geometry = 3,
}

/// What is proven of a pixel of an isosurface: whether its ray meets the surface.
///
/// Proven means that no rounding error of the cast can change the answer, the voxels being taken
/// as exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Certificate {
    /// The ray meets no surface.
    Miss = 0,
    /// It does, and first where the picture says.
    Hit = 1,
    /// It touches the surface, or comes so near to it that rounding decides; or nothing was proven
    /// (fixed steps, other pictures).
    Undecided = 2,
}

/// All planes of one picture. Optional planes are there when they were asked for; each has
/// `size.pixels()` entries.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    pub size: ImageSize,
    /// Linear light, premultiplied, without background.
    pub color: Vec<[f32; 4]>,
    /// sRGB-encoded 0..1, opaque, after background and tone curve: what display formats hold.
    pub display: Option<Vec<[f32; 4]>>,
    /// mm from the eye along the ray (from the eye plane in orthographic projection); +∞: none.
    pub depth: Option<Vec<f32>>,
    /// Unit, world space, toward lower values; 0 where nothing is hit.
    pub normal: Option<Vec<[f32; 3]>>,
    /// Physical: Φ at the hit, or the projected value; 0 where nothing is hit.
    pub value: Option<Vec<f32>>,
    /// Samples taken (cells walked, in the reference).
    pub steps: Option<Vec<u32>>,
    /// Hierarchy nodes visited (0 in the reference).
    pub nodes: Option<Vec<u32>>,
    /// A [`Kind`] as a number.
    pub kind: Option<Vec<u32>>,
    /// A [`Certificate`] as a number.
    pub certificate: Option<Vec<u32>>,
}

impl Frame {
    /// Everything 0, with the planes that are wanted.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn blank(size: ImageSize, wanted: Wanted) -> Result<Self> {
        fn plane<T: Clone + Default>(wanted: bool, pixels: usize) -> Result<Option<Vec<T>>> {
            let plane = || memory::filled(pixels, T::default(), "a plane of the picture");
            wanted.then(plane).transpose()
        }
        let pixels = size.pixels();
        Ok(Self {
            size,
            color: memory::filled(pixels, [0.0; 4], "a plane of the picture")?,
            display: plane(wanted.display, pixels)?,
            depth: plane(wanted.depth, pixels)?,
            normal: plane(wanted.normal, pixels)?,
            value: plane(wanted.value, pixels)?,
            steps: plane(wanted.counters, pixels)?,
            nodes: plane(wanted.counters, pixels)?,
            kind: plane(wanted.kind, pixels)?,
            certificate: plane(wanted.certificate, pixels)?,
        })
    }

    /// Some pixels, by their numbers row by row: a picture of one row, whose pixels are they, in this
    /// order.
    ///
    /// # Errors
    /// No pixel, or more than a row has.
    ///
    /// # Panics
    /// A pixel outside the picture.
    pub fn picked(&self, pixels: &[u32]) -> Result<Self> {
        fn plane<T: Copy>(plane: &Option<Vec<T>>, pixels: &[u32]) -> Option<Vec<T>> {
            let plane = plane.as_ref()?;
            Some(pixels.iter().map(|&pixel| plane[pixel as usize]).collect())
        }
        Ok(Self {
            size: ImageSize::row(pixels.len())?,
            color: pixels.iter().map(|&p| self.color[p as usize]).collect(),
            display: plane(&self.display, pixels),
            depth: plane(&self.depth, pixels),
            normal: plane(&self.normal, pixels),
            value: plane(&self.value, pixels),
            steps: plane(&self.steps, pixels),
            nodes: plane(&self.nodes, pixels),
            kind: plane(&self.kind, pixels),
            certificate: plane(&self.certificate, pixels),
        })
    }

    /// The planes that are there, the colour first, as bytes in the machine's order.
    pub fn bytes_mut(&mut self) -> Vec<&mut [u8]> {
        fn bytes<T: bytemuck::Pod>(plane: &mut Option<Vec<T>>) -> Option<&mut [u8]> {
            plane.as_mut().map(|plane| bytemuck::cast_slice_mut(plane))
        }
        let planes = [
            Some(bytemuck::cast_slice_mut(&mut self.color)),
            bytes(&mut self.display),
            bytes(&mut self.depth),
            bytes(&mut self.normal),
            bytes(&mut self.value),
            bytes(&mut self.steps),
            bytes(&mut self.nodes),
            bytes(&mut self.kind),
            bytes(&mut self.certificate),
        ];
        planes.into_iter().flatten().collect()
    }

    /// Pixels whose [`Certificate`] is undecided, where there are certificates.
    pub fn undecided(&self) -> Option<u64> {
        let certificates = self.certificate.as_ref()?;
        let undecided = Certificate::Undecided as u32;
        Some(certificates.iter().filter(|&&c| c == undecided).count() as u64)
    }

    /// That every plane has one entry per pixel.
    ///
    /// # Errors
    /// A plane of another length, named.
    pub fn check(&self) -> Result<()> {
        fn entries<T>(plane: Option<&Vec<T>>) -> Option<usize> {
            plane.map(Vec::len)
        }
        let planes = [
            ("color", Some(self.color.len())),
            ("display", entries(self.display.as_ref())),
            ("depth", entries(self.depth.as_ref())),
            ("normal", entries(self.normal.as_ref())),
            ("value", entries(self.value.as_ref())),
            ("steps", entries(self.steps.as_ref())),
            ("nodes", entries(self.nodes.as_ref())),
            ("kind", entries(self.kind.as_ref())),
            ("certificate", entries(self.certificate.as_ref())),
        ];
        for (name, entries) in planes {
            if let Some(entries) = entries
                && entries != self.size.pixels()
            {
                return Err(Error::failed(format!(
                    "the frame's {name} plane has {entries} entries for a picture of {}",
                    self.size
                )));
            }
        }
        Ok(())
    }
}

/// The layers beside the colour that a picture can carry (`--aov`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Layer {
    Depth,
    Normal,
    Value,
    Steps,
    Nodes,
    Cast,
    Kind,
    Certificate,
}

impl Layer {
    pub const ALL: [Self; 8] = [
        Self::Depth,
        Self::Normal,
        Self::Value,
        Self::Steps,
        Self::Nodes,
        Self::Cast,
        Self::Kind,
        Self::Certificate,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Normal => "normal",
            Self::Value => "value",
            Self::Steps => "steps",
            Self::Nodes => "nodes",
            Self::Cast => "cast",
            Self::Kind => "kind",
            Self::Certificate => "certificate",
        }
    }

    /// The names of its channels in a file.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Depth => &["depth.Z"],
            Self::Normal => &["normal.X", "normal.Y", "normal.Z"],
            Self::Value => &["value.V"],
            Self::Steps => &["steps.N"],
            Self::Nodes => &["nodes.N"],
            Self::Cast => &["cast.V"],
            Self::Kind => &["kind.V"],
            Self::Certificate => &["certificate.V"],
        }
    }
}

/// Which planes a renderer is asked for besides the colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wanted {
    pub display: bool,
    pub depth: bool,
    pub normal: bool,
    pub value: bool,
    /// Both counters: steps and nodes.
    pub counters: bool,
    pub kind: bool,
    pub certificate: bool,
}

impl Wanted {
    pub const ALL: Self = Self {
        display: true,
        depth: true,
        normal: true,
        value: true,
        counters: true,
        kind: true,
        certificate: true,
    };

    /// A picture to be looked at, and nothing else of it.
    pub const DISPLAY: Self = Self {
        display: true,
        depth: false,
        normal: false,
        value: false,
        counters: false,
        kind: false,
        certificate: false,
    };

    /// The planes that a file in `encoding` is written from; with `stats` also those that the
    /// statistics count (steps, nodes, hits).
    pub fn for_encoding(encoding: &Encoding, stats: bool) -> Self {
        let carried = |layer| encoding.format.carries_layers() && encoding.layers.contains(&layer);
        Self {
            display: encoding.format.is_display(),
            depth: carried(Layer::Depth),
            normal: carried(Layer::Normal),
            value: carried(Layer::Value),
            counters: stats || carried(Layer::Steps) || carried(Layer::Nodes),
            kind: stats || carried(Layer::Kind),
            certificate: carried(Layer::Certificate),
        }
    }
}
