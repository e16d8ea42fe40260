//! A frame as a list of named f32 channels, as EXR and NPY hold it.

use crate::error::{Error, Result};

use super::contents::Frame;
use super::format::{COLOR, Encoding};
use super::layer::Layer;
use super::layers::Plane;

/// One channel of a frame.
pub(super) struct Channel<'a> {
    /// The channel's name in the file, such as `R` or `normal.X`.
    pub name: &'static str,
    samples: Samples<'a>,
}

enum Samples<'a> {
    Color(&'a [[f32; 4]], usize),
    Vector(&'a [[f32; 3]], usize),
    Scalar(&'a [f32]),
    /// Exact up to 2^24, as f32 goes.
    Count(&'a [u32]),
    /// Every pixel has a ray of its own.
    One,
}

impl<'a> Channel<'a> {
    /// The channel of a plane with one number a pixel.
    pub fn scalar(name: &'static str, plane: &'a [f32]) -> Self {
        Self {
            name,
            samples: Samples::Scalar(plane),
        }
    }

    /// The sample of a pixel, counted from the top left, rows first; `pixel` < the frame's pixels.
    pub fn at(&self, pixel: usize) -> f32 {
        match self.samples {
            Samples::Color(plane, component) => plane[pixel][component],
            Samples::Vector(plane, component) => plane[pixel][component],
            Samples::Scalar(plane) => plane[pixel],
            Samples::Count(plane) => plane[pixel] as f32,
            Samples::One => 1.0,
        }
    }
}

/// The channels that `encoding` names, in the order of [`super::channels`].
///
/// # Errors
/// A layer whose plane the frame lacks.
pub(super) fn channels_of<'a>(frame: &'a Frame, encoding: &Encoding) -> Result<Vec<Channel<'a>>> {
    let mut channels: Vec<_> = COLOR
        .into_iter()
        .enumerate()
        .map(|(component, name)| Channel {
            name,
            samples: Samples::Color(&frame.color, component),
        })
        .collect();
    for layer in encoding.layers_in_order() {
        for (component, name) in layer.channels().iter().enumerate() {
            let samples = samples_of(frame, layer, component).ok_or_else(|| {
                Error::failed(format!(
                    "the layer '{}' is wanted, but the frame was rendered without it",
                    layer.name()
                ))
            })?;
            channels.push(Channel { name, samples });
        }
    }
    Ok(channels)
}

fn samples_of(frame: &Frame, layer: Layer, component: usize) -> Option<Samples<'_>> {
    Some(match frame.layers.get(layer) {
        Some(Plane::Scalars(plane)) => Samples::Scalar(plane),
        Some(Plane::Vectors(plane)) => Samples::Vector(plane, component),
        Some(Plane::Counts(plane)) => Samples::Count(plane),
        None if layer == Layer::Cast => Samples::One,
        None => return None,
    })
}
