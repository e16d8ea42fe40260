//! The planes of a picture's layers, as a map by layer.

use crate::error::Result;
use crate::memory;

use super::layer::{FillValue, Key, Layer};

/// One plane: an entry per pixel, row 0 at the top, x fastest.
#[derive(Debug, Clone, PartialEq)]
pub enum Plane {
    /// Numbers.
    Scalars(Vec<f32>),
    /// Three components a pixel.
    Vectors(Vec<[f32; 3]>),
    /// Whole numbers.
    Counts(Vec<u32>),
}

/// Applies an expression to the entries of a plane, whatever they are.
macro_rules! with_entries {
    ($plane:expr, $entries:ident => $use:expr) => {
        match $plane {
            Plane::Scalars($entries) => $use,
            Plane::Vectors($entries) => $use,
            Plane::Counts($entries) => $use,
        }
    };
}

impl Plane {
    /// A plane of equal entries.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn filled(entry: FillValue, pixels: usize) -> Result<Self> {
        const WHAT: &str = "a plane of the picture";
        Ok(match entry {
            FillValue::Scalar(entry) => Self::Scalars(memory::filled(pixels, entry, WHAT)?),
            FillValue::Vector(entry) => Self::Vectors(memory::filled(pixels, entry, WHAT)?),
            FillValue::Count(entry) => Self::Counts(memory::filled(pixels, entry, WHAT)?),
        })
    }

    /// How many entries it has.
    pub fn entries(&self) -> usize {
        with_entries!(self, entries => entries.len())
    }

    /// The entries as bytes in the machine's order.
    pub fn bytes(&self) -> &[u8] {
        with_entries!(self, entries => bytemuck::cast_slice(entries))
    }

    /// The entries as bytes in the machine's order, to be overwritten.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        with_entries!(self, entries => bytemuck::cast_slice_mut(entries))
    }

    /// The entries of some pixels, in this order.
    ///
    /// # Panics
    /// A pixel outside the plane.
    pub fn picked(&self, pixels: &[u32]) -> Self {
        fn picked<T: Copy>(entries: &[T], pixels: &[u32]) -> Vec<T> {
            let entry = |&pixel: &u32| entries[pixel as usize];
            pixels.iter().map(entry).collect()
        }
        match self {
            Self::Scalars(entries) => Self::Scalars(picked(entries, pixels)),
            Self::Vectors(entries) => Self::Vectors(picked(entries, pixels)),
            Self::Counts(entries) => Self::Counts(picked(entries, pixels)),
        }
    }
}

/// The type of a plane's entries.
pub trait PlaneEntry: Sized {
    /// Makes a plane of its entries.
    fn plane(entries: Vec<Self>) -> Plane;

    /// The entries of a plane of this type.
    fn of(plane: &Plane) -> Option<&[Self]>;

    /// The entries of a plane of this type, to be changed.
    fn of_mut(plane: &mut Plane) -> Option<&mut [Self]>;

    /// The entries of a plane of this type, taken out of it.
    fn out_of(plane: Plane) -> Option<Vec<Self>>;
}

macro_rules! plane_entries {
    ($($entry:ty => $plane:ident),* $(,)?) => {
        $(impl PlaneEntry for $entry {
            fn plane(entries: Vec<Self>) -> Plane {
                Plane::$plane(entries)
            }

            fn of(plane: &Plane) -> Option<&[Self]> {
                match plane {
                    Plane::$plane(entries) => Some(entries),
                    _ => None,
                }
            }

            fn of_mut(plane: &mut Plane) -> Option<&mut [Self]> {
                match plane {
                    Plane::$plane(entries) => Some(entries),
                    _ => None,
                }
            }

            fn out_of(plane: Plane) -> Option<Vec<Self>> {
                match plane {
                    Plane::$plane(entries) => Some(entries),
                    _ => None,
                }
            }
        })*
    };
}

plane_entries! {
    f32 => Scalars,
    [f32; 3] => Vectors,
    u32 => Counts,
}

/// The planes of a picture's layers; a layer that was not wanted has none.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layers([Option<Plane>; Layer::COUNT]);

impl Layers {
    /// Whether a layer has a plane.
    pub fn has(&self, layer: Layer) -> bool {
        self.get(layer).is_some()
    }

    /// The plane of a layer.
    pub fn get(&self, layer: Layer) -> Option<&Plane> {
        self.0[layer as usize].as_ref()
    }

    /// The entries of a layer's plane.
    pub fn plane<T: PlaneEntry>(&self, key: Key<T>) -> Option<&[T]> {
        self.get(key.layer()).and_then(T::of)
    }

    /// The entries of a layer's plane, to be changed.
    pub fn plane_mut<T: PlaneEntry>(&mut self, key: Key<T>) -> Option<&mut [T]> {
        self.0[key.layer() as usize].as_mut().and_then(T::of_mut)
    }

    /// Gives a layer its plane, in the place of one that it may have had.
    pub fn insert<T: PlaneEntry>(&mut self, key: Key<T>, entries: Vec<T>) {
        self.insert_plane(key.layer(), T::plane(entries));
    }

    /// Inserts a plane whose type is known at run time only; see [`Layers::insert`].
    pub fn insert_plane(&mut self, layer: Layer, plane: Plane) {
        self.0[layer as usize] = Some(plane);
    }

    /// Takes a layer's plane out.
    pub fn take<T: PlaneEntry>(&mut self, key: Key<T>) -> Option<Vec<T>> {
        self.0[key.layer() as usize].take().and_then(T::out_of)
    }

    /// The planes that are there, each with its layer, in the order of [`Layer::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Layer, &Plane)> {
        let planes = Layer::ALL.into_iter().zip(&self.0);
        planes.filter_map(|(layer, plane)| Some((layer, plane.as_ref()?)))
    }

    /// Iterates over the layers and their planes, which may be changed.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (Layer, &mut Plane)> {
        let planes = Layer::ALL.into_iter().zip(&mut self.0);
        planes.filter_map(|(layer, plane)| Some((layer, plane.as_mut()?)))
    }
}
