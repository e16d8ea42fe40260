//! OpenEXR: one scanline part, 32-bit float, ZIP, the metadata as string attributes.
//!
//! The program's version is the attribute `angioray.version`, because OpenEXR reserves the name
//! `version` for an integer; reading the metadata gives it back as `version`.

use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

use ::exr::block::{BlockIndex, UncompressedBlock};
use ::exr::error::Error as ExrError;
use ::exr::image::write::WritableImage;
use ::exr::image::write::channels::{ChannelsWriter, WritableChannels};
use ::exr::image::{Encoding, Image, Layer};
use ::exr::math::RoundingMode;
use ::exr::meta::MetaData;
use ::exr::meta::attribute::{
    self, AttributeValue, ChannelDescription, ChannelList, LevelMode, SampleType, Text,
};
use ::exr::meta::header::{Header, LayerAttributes, standard_names};

use crate::error::{Error, Result};
use crate::extent::ImageSize;

use super::channel::Channel;

/// Put before a key that is the name of one of OpenEXR's own attributes, and taken off on reading.
const PREFIX: &str = "angioray.";

/// Where the attributes start: after the magic number and the version field.
const ATTRIBUTES_AT: u64 = 8;

pub(super) fn encode(
    out: &mut (impl Write + Seek),
    path: &Path,
    size: ImageSize,
    mut channels: Vec<Channel<'_>>,
    metadata: &[(&str, &str)],
) -> Result<()> {
    // The format wants its channels in this order.
    channels.sort_by_key(|channel| channel.name);
    let width = size.width() as usize;
    let mut attributes = LayerAttributes::default();
    for (key, value) in metadata {
        let text = AttributeValue::Text(text(value));
        attributes.other.insert(attribute_name(key), text);
    }
    let layer = Layer::new(
        (width, size.height() as usize),
        attributes,
        Encoding::SMALL_LOSSLESS,
        Rows { width, channels },
    );
    let image = Image::from_layer(layer);
    let writer = image.write();
    let headers = writer.infer_meta_data();
    let run = || -> std::result::Result<(), ExrError> {
        writer.to_buffered(&mut *out)?;
        // The crate keeps attributes in hash maps: in order, equal pictures are equal bytes.
        out.seek(SeekFrom::Start(ATTRIBUTES_AT))?;
        for header in &headers {
            write_sorted(header, out)?;
        }
        out.flush()?;
        Ok(())
    };
    run().map_err(|error| unwritable(path, error))
}

/// The header's attributes, sorted by name: as many bytes as in any other order.
fn write_sorted(header: &Header, out: &mut impl Write) -> std::result::Result<(), ExrError> {
    let mut attributes: Vec<_> = header.all_named_attributes().collect();
    attributes.sort_by_key(|(name, _)| *name);
    for (name, value) in &attributes {
        attribute::write(name, value, out)?;
    }
    Ok(())
}

/// A frame's channels, read row by row where they lie.
struct Rows<'a> {
    width: usize,
    channels: Vec<Channel<'a>>,
}

impl<'a> WritableChannels<'a> for Rows<'a> {
    type Writer = &'a Self;

    fn infer_channel_list(&self) -> ChannelList {
        let describe =
            |channel: &Channel<'_>| ChannelDescription::named(channel.name, SampleType::F32);
        ChannelList::new(self.channels.iter().map(describe).collect())
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_writer(&'a self, _header: &Header) -> &'a Self {
        self
    }
}

impl ChannelsWriter for &Rows<'_> {
    fn extract_uncompressed_block(&self, header: &Header, block: BlockIndex) -> Vec<u8> {
        UncompressedBlock::collect_block_data_from_lines(&header.channels, block, |line| {
            let at = line.location;
            let channel = &self.channels[at.channel];
            let first = at.position.y() * self.width + at.position.x();
            let filled = line.write_samples(|x| channel.at(first + x));
            debug_assert!(filled.is_ok(), "a line is as long as the crate made it");
        })
    }
}

/// The string attributes, sorted by key.
pub(super) fn read_metadata(path: &Path) -> Result<Vec<(String, String)>> {
    let meta = MetaData::read_from_file(path, false).map_err(|e| unreadable(path, e))?;
    let mut pairs: Vec<_> = meta
        .headers
        .first()
        .iter()
        .flat_map(|header| &header.own_attributes.other)
        .filter_map(|(name, value)| match value {
            AttributeValue::Text(text) => Some((key_of(&utf8(name)), utf8(text))),
            _ => None,
        })
        .collect();
    pairs.sort();
    Ok(pairs)
}

/// The layers whose channels are all there.
pub(super) fn read_encoding(path: &Path) -> Result<super::Encoding> {
    let meta = MetaData::read_from_file(path, false).map_err(|e| unreadable(path, e))?;
    let mut names: Vec<String> = Vec::new();
    if let Some(header) = meta.headers.first() {
        names.extend(
            header
                .channels
                .list
                .iter()
                .map(|channel| utf8(&channel.name)),
        );
    }
    let is_there = |layer: &super::Layer| {
        let mut channels = layer.channels().iter();
        channels.all(|name| names.iter().any(|there| there == name))
    };
    let layers = super::Layer::ALL.into_iter().filter(is_there).collect();
    Ok(super::Encoding {
        layers,
        ..super::Encoding::new(super::Format::Exr)
    })
}

fn attribute_name(key: &str) -> Text {
    if standard_names::ALL.contains(&key.as_bytes()) {
        text(&format!("{PREFIX}{key}"))
    } else {
        text(key)
    }
}

fn key_of(name: &str) -> String {
    name.strip_prefix(PREFIX).unwrap_or(name).to_owned()
}

/// UTF-8, as OpenEXR has it; the crate's own conversions are for Latin-1.
fn text(utf8: &str) -> Text {
    Text::from_slice_unchecked(utf8.as_bytes())
}

fn utf8(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

fn unwritable(path: &Path, error: ExrError) -> Error {
    match error {
        ExrError::Io(cause) => Error::writing(path, "write", &cause),
        other => Error::resource(format!("{}: cannot write: {other}", path.display())),
    }
}

fn unreadable(path: &Path, error: ExrError) -> Error {
    match error {
        ExrError::Io(cause) => Error::reading(path, "read", &cause),
        other => Error::input(format!("{}: cannot read: {other}", path.display())),
    }
}
