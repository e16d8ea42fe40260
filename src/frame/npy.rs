//! NumPy arrays: float32, height × width × channels.
//!
//! The layout is that of NEP 1 (numpy.lib.format), version 1.0.

use std::io::{self, Write};

use super::channel::Channel;
use crate::extent::ImageSize;

/// Little-endian float32 in C order, without pickled objects.
pub(super) fn encode(
    out: &mut impl Write,
    size: ImageSize,
    channels: &[Channel<'_>],
) -> io::Result<()> {
    out.write_all(&header(size, channels.len()))?;
    let width = size.width() as usize;
    let mut row = Vec::with_capacity(width * channels.len() * 4);
    for y in 0..size.height() as usize {
        row.clear();
        for pixel in y * width..(y + 1) * width {
            for channel in channels {
                row.extend_from_slice(&channel.at(pixel).to_le_bytes());
            }
        }
        out.write_all(&row)?;
    }
    Ok(())
}

/// Magic, version, length, and the Python dictionary padded with blanks so that the data starts
/// at a multiple of 64 bytes.
fn header(size: ImageSize, channels: usize) -> Vec<u8> {
    const PREFIX_BYTES: usize = 10;
    let (width, height) = (size.width(), size.height());
    let mut dictionary = format!(
        "{{'descr': '<f4', 'fortran_order': False, 'shape': ({height}, {width}, {channels}), }}"
    );
    let unpadded = PREFIX_BYTES + dictionary.len() + 1;
    dictionary.push_str(&" ".repeat(unpadded.next_multiple_of(64) - unpadded));
    dictionary.push('\n');

    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend_from_slice(&(dictionary.len() as u16).to_le_bytes());
    header.extend_from_slice(dictionary.as_bytes());
    header
}
