//! Whether a file is a picture as it would be written again.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use ::exr::prelude::read_first_flat_layer_from_file;

use crate::extent::ImageSize;

use super::{BitDepth, Encoding, Format, channels, read_metadata};

/// Whether `path` is a complete picture of this size and encoding that carries all of `metadata`, and so
/// need not be written again. Every pixel is read; a file that is missing, truncated or anything else is
/// not complete. Only formats that [carry metadata](Format::carries_metadata) can be verified.
pub fn is_complete(
    path: &Path,
    size: ImageSize,
    encoding: &Encoding,
    metadata: &[(&str, &str)],
) -> bool {
    let Ok(texts) = read_metadata(path) else {
        return false;
    };
    let carries = |(key, text): &(&str, &str)| texts.iter().any(|(k, t)| k == key && t == text);
    metadata.iter().all(carries)
        && match encoding.format {
            Format::Png => is_complete_png(path, size, encoding.bit_depth).unwrap_or(false),
            Format::Exr => is_complete_exr(path, size, encoding),
            Format::Jpeg | Format::WebP | Format::Npy => false,
        }
}

/// `None`: not readable to its end.
fn is_complete_png(path: &Path, size: ImageSize, bit_depth: BitDepth) -> Option<bool> {
    let file = BufReader::new(File::open(path).ok()?);
    let mut reader = ::png::Decoder::new(file).read_info().ok()?;
    let info = reader.info();
    let depth = match bit_depth {
        BitDepth::Eight => ::png::BitDepth::Eight,
        BitDepth::Sixteen => ::png::BitDepth::Sixteen,
    };
    if (info.width, info.height) != (size.width(), size.height())
        || (info.color_type, info.bit_depth) != (::png::ColorType::Rgb, depth)
    {
        return Some(false);
    }
    let mut pixels = vec![0; reader.output_buffer_size()?];
    reader.next_frame(&mut pixels).ok()?;
    reader.finish().ok()?;
    Some(true)
}

fn is_complete_exr(path: &Path, size: ImageSize, encoding: &Encoding) -> bool {
    let Ok(image) = read_first_flat_layer_from_file(path) else {
        return false;
    };
    let layer = image.layer_data;
    let mut wanted = channels(encoding);
    wanted.sort();
    let names = layer.channel_data.list.iter();
    let names: Vec<String> = names.map(|channel| channel.name.to_string()).collect();
    (layer.size.0, layer.size.1) == (size.width() as usize, size.height() as usize)
        && names == wanted
}
