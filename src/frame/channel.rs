//! A frame as a list of named f32 channels, as EXR and NPY hold it.

use crate::error::{Error, Result};

use super::{Encoding, Frame, Layer};

/// The colour's channels: linear light, premultiplied.
pub(super) const COLOR: [&str; 4] = ["R", "G", "B", "A"];

/// The names of a file's channels, in the order of an NPY's last axis (EXR keeps its channels
/// sorted by name).
pub fn channels(encoding: &Encoding) -> Vec<String> {
    let color: &[&str] = if encoding.format.is_display() {
        &["R", "G", "B"]
    } else {
        &COLOR
    };
    let layers = encoding.layers_in_order().flat_map(Layer::channels);
    color
        .iter()
        .chain(layers)
        .map(|name| (*name).to_owned())
        .collect()
}

/// One channel of a frame.
pub(super) struct Channel<'a> {
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
    /// A plane of one number a pixel.
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

/// The channels that `encoding` requests, named and ordered as [`channels`] says.
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
                    "the layer '{}' was asked for, but the frame was rendered without it",
                    layer.name()
                ))
            })?;
            channels.push(Channel { name, samples });
        }
    }
    Ok(channels)
}

fn samples_of(frame: &Frame, layer: Layer, component: usize) -> Option<Samples<'_>> {
    Some(match layer {
        Layer::Depth => Samples::Scalar(frame.depth.as_deref()?),
        Layer::Normal => Samples::Vector(frame.normal.as_deref()?, component),
        Layer::Value => Samples::Scalar(frame.value.as_deref()?),
        Layer::Steps => Samples::Count(frame.steps.as_deref()?),
        Layer::Nodes => Samples::Count(frame.nodes.as_deref()?),
        Layer::Kind => Samples::Count(frame.kind.as_deref()?),
        Layer::Certificate => Samples::Count(frame.certificate.as_deref()?),
        Layer::Cast => Samples::One,
    })
}
