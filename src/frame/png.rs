//! PNG: RGB of 8 or 16 bits, sRGB, the metadata as iTXt chunks.

use std::io::{BufReader, Write};
use std::path::Path;

use ::png::{ColorType, Compression, Decoder, Encoder, EncodingError, SrgbRenderingIntent};

use crate::error::{Error, Result};
use crate::extent::ImageSize;

use super::{BitDepth, Encoding, Format, Frame, Wanted, quantize};

pub(super) fn encode(
    out: &mut impl Write,
    path: &Path,
    frame: &Frame,
    bit_depth: BitDepth,
    metadata: &[(&str, &str)],
) -> Result<()> {
    let (depth, bytes) = match bit_depth {
        BitDepth::Eight => (::png::BitDepth::Eight, quantize::rgb8(frame)?),
        BitDepth::Sixteen => (::png::BitDepth::Sixteen, quantize::rgb16_big_endian(frame)?),
    };
    let written = write_rgb(out, frame.size, depth, Compression::Fast, metadata, &bytes);
    written.map_err(|error| not_written(path, error))
}

pub(super) fn not_written(path: &Path, error: EncodingError) -> Error {
    match error {
        EncodingError::IoError(cause) => Error::writing(path, "write", &cause),
        other => Error::resource(format!("{}: cannot write: {other}", path.display())),
    }
}

/// A whole file of 8 bits a channel; `rgb` holds R, G, B of each pixel of `size`.
pub(super) fn rgb8(size: ImageSize, rgb: &[u8]) -> Result<Vec<u8>> {
    let mut file = Vec::new();
    let (depth, compression) = (::png::BitDepth::Eight, Compression::Balanced);
    write_rgb(&mut file, size, depth, compression, &[], rgb)
        .map_err(|cause| Error::failed(format!("the picture cannot be made a PNG: {cause}")))?;
    Ok(file)
}

fn write_rgb(
    out: &mut impl Write,
    size: ImageSize,
    depth: ::png::BitDepth,
    compression: Compression,
    metadata: &[(&str, &str)],
    bytes: &[u8],
) -> std::result::Result<(), EncodingError> {
    let mut writer = rgb_encoder(out, size, depth, compression, metadata)?.write_header()?;
    writer.write_image_data(bytes)?;
    writer.finish()
}

/// For RGB in sRGB, the metadata as iTXt chunks: of a PNG, and of an animated one's frames.
pub(super) fn rgb_encoder<'a, W: Write>(
    out: W,
    size: ImageSize,
    depth: ::png::BitDepth,
    compression: Compression,
    metadata: &[(&str, &str)],
) -> std::result::Result<Encoder<'a, W>, EncodingError> {
    let mut encoder = Encoder::new(out, size.width(), size.height());
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(depth);
    encoder.set_compression(compression);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    for (key, text) in metadata {
        encoder.add_itxt_chunk((*key).to_owned(), (*text).to_owned())?;
    }
    Ok(encoder)
}

/// A picture of 8 bits a channel as it is displayed: one that is written again comes out the same.
///
/// # Errors
/// A file that cannot be read, is damaged, or is another kind of PNG.
pub fn read_display(path: &Path) -> Result<Frame> {
    let file = std::fs::File::open(path).map_err(|e| Error::reading(path, "read", &e))?;
    let mut reader = Decoder::new(BufReader::new(file))
        .read_info()
        .map_err(|cause| unreadable(path, &cause))?;
    let info = reader.info();
    if (info.color_type, info.bit_depth) != (ColorType::Rgb, ::png::BitDepth::Eight) {
        return Err(unreadable(path, &"it is not RGB of 8 bits"));
    }
    let size = ImageSize::new(info.width, info.height)?;
    let mut rgb = vec![0; 3 * size.pixels()];
    reader
        .next_frame(&mut rgb)
        .map_err(|cause| unreadable(path, &cause))?;
    let level = |byte: u8| f32::from(byte) / f32::from(u8::MAX);
    let display = rgb.as_chunks::<3>().0.iter();
    Ok(Frame {
        display: Some(
            display
                .map(|&[r, g, b]| [level(r), level(g), level(b), 1.0])
                .collect(),
        ),
        ..Frame::blank(size, Wanted::DISPLAY)?
    })
}

/// The bits per channel.
pub(super) fn read_encoding(path: &Path) -> Result<Encoding> {
    let file = std::fs::File::open(path).map_err(|e| Error::reading(path, "read", &e))?;
    let reader = Decoder::new(BufReader::new(file))
        .read_info()
        .map_err(|cause| unreadable(path, &cause))?;
    let bit_depth = match reader.info().bit_depth {
        ::png::BitDepth::Sixteen => BitDepth::Sixteen,
        _ => BitDepth::Eight,
    };
    Ok(Encoding {
        bit_depth,
        ..Encoding::new(Format::Png)
    })
}

fn unreadable(path: &Path, cause: &dyn std::fmt::Display) -> Error {
    Error::input(format!("{}: not a readable PNG: {cause}", path.display()))
}

/// The keys and texts of all text chunks: tEXt, zTXt, then iTXt, each in the file's order.
pub(super) fn read_metadata(path: &Path) -> Result<Vec<(String, String)>> {
    let unreadable = |cause: ::png::DecodingError| unreadable(path, &cause);
    let file = std::fs::File::open(path).map_err(|e| Error::reading(path, "read", &e))?;
    let mut reader = Decoder::new(BufReader::new(file))
        .read_info()
        .map_err(unreadable)?;
    // Other programs put text after the picture too.
    reader.finish().map_err(unreadable)?;
    let info = reader.info();
    let mut pairs = Vec::new();
    for chunk in &info.uncompressed_latin1_text {
        pairs.push((chunk.keyword.clone(), chunk.text.clone()));
    }
    for chunk in &info.compressed_latin1_text {
        pairs.push((chunk.keyword.clone(), chunk.get_text().map_err(unreadable)?));
    }
    for chunk in &info.utf8_text {
        pairs.push((chunk.keyword.clone(), chunk.get_text().map_err(unreadable)?));
    }
    Ok(pairs)
}
