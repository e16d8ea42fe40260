//! A picture: its colour, and the planes beside it.

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::memory;

use super::layer::{CERTIFICATE, Key, Layer};
use super::layers::{Layers, Plane, PlaneEntry};
use super::pixel::Certificate;
use super::wanted::Wanted;

/// All planes of one picture. Each has `size.pixels()` entries; the display plane and the layers are there
/// where they were wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// The size in pixels.
    pub size: ImageSize,
    /// The colour: linear light, premultiplied, without background.
    pub color: Vec<[f32; 4]>,
    /// sRGB-encoded 0..1, opaque, after background and tone curve: what display formats hold.
    pub display: Option<Vec<[f32; 4]>>,
    /// The planes of the layers beside the colour.
    pub layers: Layers,
}

impl Frame {
    /// A picture in which no ray met anything, its colours and its display plane 0, with the planes that are
    /// wanted.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn blank(size: ImageSize, wanted: Wanted) -> Result<Self> {
        let pixels = size.pixels();
        let color = || memory::filled(pixels, [0.0; 4], "a plane of the picture");
        let mut layers = Layers::default();
        for layer in wanted.layers() {
            if let Some(entry) = layer.empty() {
                layers.insert_plane(layer, Plane::filled(entry, pixels)?);
            }
        }
        Ok(Self {
            size,
            color: color()?,
            display: wanted.display.then(color).transpose()?,
            layers,
        })
    }

    /// The entries of a layer's plane.
    pub fn plane<T: PlaneEntry>(&self, key: Key<T>) -> Option<&[T]> {
        self.layers.plane(key)
    }

    /// The entries of a layer's plane, to be changed.
    pub fn plane_mut<T: PlaneEntry>(&mut self, key: Key<T>) -> Option<&mut [T]> {
        self.layers.plane_mut(key)
    }

    /// Picks some pixels, by their numbers row by row: a picture of one row, whose pixels are they, in
    /// this order.
    ///
    /// # Errors
    /// No pixel, or more than a row has.
    ///
    /// # Panics
    /// A pixel outside the picture.
    pub fn picked(&self, pixels: &[u32]) -> Result<Self> {
        let colors = |plane: &[[f32; 4]]| pixels.iter().map(|&p| plane[p as usize]).collect();
        let mut layers = Layers::default();
        for (layer, plane) in self.layers.iter() {
            layers.insert_plane(layer, plane.picked(pixels));
        }
        Ok(Self {
            size: ImageSize::row(pixels.len())?,
            color: colors(&self.color),
            display: self.display.as_deref().map(colors),
            layers,
        })
    }

    /// The planes that are there, the colour first, as bytes in the machine's order.
    pub fn bytes_mut(&mut self) -> Vec<&mut [u8]> {
        let mut planes = vec![bytemuck::cast_slice_mut(&mut self.color)];
        planes.extend(
            self.display
                .as_mut()
                .map(|plane| bytemuck::cast_slice_mut(plane)),
        );
        planes.extend(self.layers.iter_mut().map(|(_, plane)| plane.bytes_mut()));
        planes
    }

    /// Whether another picture is bit-identical in all planes but the counters, which say how it was
    /// made.
    pub fn bit_equal(&self, other: &Self) -> bool {
        fn same<T: bytemuck::NoUninit>(a: &[T], b: &[T]) -> bool {
            bytemuck::cast_slice::<T, u8>(a) == bytemuck::cast_slice::<T, u8>(b)
        }
        let displays = match (&self.display, &other.display) {
            (Some(own), Some(other)) => same(own, other),
            (own, other) => own.is_none() && other.is_none(),
        };
        let is_same = |layer: &Layer| {
            let [own, other] = [self, other].map(|frame| frame.layers.get(*layer));
            Layer::COUNTERS.contains(layer) || own.map(Plane::bytes) == other.map(Plane::bytes)
        };
        same(&self.color, &other.color) && displays && Layer::ALL.iter().all(is_same)
    }

    /// Pixels whose [`Certificate`] is undecided, where there are certificates.
    pub fn undecided(&self) -> Option<u64> {
        let certificates = self.plane(CERTIFICATE)?;
        let undecided = Certificate::Undecided as u32;
        Some(certificates.iter().filter(|&&c| c == undecided).count() as u64)
    }

    /// Checks that every plane has one entry per pixel.
    ///
    /// # Errors
    /// A plane of another length, named.
    pub fn check(&self) -> Result<()> {
        let display = self.display.as_ref().map(|plane| ("display", plane.len()));
        let planes = [("color", self.color.len())].into_iter().chain(display);
        let layers = self.layers.iter();
        for (name, entries) in
            planes.chain(layers.map(|(layer, plane)| (layer.name(), plane.entries())))
        {
            if entries != self.size.pixels() {
                return Err(Error::failed(format!(
                    "the frame's {name} plane has {entries} entries for a picture of {}",
                    self.size
                )));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::layer::{DEPTH, KIND, NODES, NORMAL, STEPS, VALUE};

    fn all(pixels: u32) -> Frame {
        Frame::blank(ImageSize::new(pixels, 1).unwrap(), Wanted::ALL).unwrap()
    }

    #[test]
    fn every_layers_plane_has_the_type_of_its_key() {
        let frame = all(2);
        assert_eq!(frame.plane(DEPTH), Some(&[f32::INFINITY; 2][..]));
        assert_eq!(frame.plane(NORMAL), Some(&[[0.0; 3]; 2][..]));
        assert_eq!(frame.plane(VALUE), Some(&[0.0; 2][..]));
        for key in [STEPS, NODES, KIND, CERTIFICATE] {
            let plane = frame.plane(key).map(<[u32]>::len);
            assert_eq!(plane, Some(2), "{:?}", key.layer());
        }
        // The only layer that a picture has without a plane.
        let missing = |layer: &Layer| !frame.layers.has(*layer);
        assert!(Layer::ALL.into_iter().filter(missing).eq([Layer::Cast]));
    }

    #[test]
    fn pictures_are_the_same_whatever_they_took_and_else_to_the_last_bit() {
        let (one, mut other) = (all(3), all(3));
        other.plane_mut(STEPS).unwrap()[1] = 7;
        assert!(one.bit_equal(&other));
        other.plane_mut(VALUE).unwrap()[1] = -0.0;
        assert!(!one.bit_equal(&other));
        other = all(3);
        other.layers.take(VALUE);
        assert!(!one.bit_equal(&other));
        other = all(3);
        other.display = None;
        assert!(!one.bit_equal(&other));
    }

    #[test]
    fn a_plane_of_another_length_is_named() {
        let mut frame = all(3);
        assert_eq!(frame.check(), Ok(()));
        frame.layers.insert(NORMAL, vec![[0.0; 3]; 2]);
        let error = frame.check().unwrap_err().to_string();
        assert!(error.contains("normal plane has 2 entries"), "{error}");
    }
}
