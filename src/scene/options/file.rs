//! The scene file: TOML with the flags' names as keys.

use std::ops::Range;
use std::path::Path;

use clap::Args;
use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, Deserializer};

use super::{
    CameraOptions, PictureOptions, SamplingOptions, SceneOptions, ToneOptions, TransferChoice,
    VolumeOptions,
};
use crate::error::{Error, Result};
use crate::scene::TransferFile;
use crate::scene::toml_error::{line, located};

impl SceneOptions {
    /// A scene file. Its `volume`, and its `tf` when that is a file, are relative to it.
    ///
    /// # Errors
    /// An unreadable file; anything wrong in it, with its line.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path)
            .map_err(|cause| Error::io(path, "read the scene", &cause))?;
        let mut options = Self::parse(&text, &path.display().to_string())?;
        let folder = path.parent().unwrap_or(Path::new(""));
        options.volume.volume = options.volume.volume.map(|file| file.seen_from(folder));
        if let Some(TransferChoice::Named(name)) = &mut options.picture.tf
            && !TransferFile::presets().any(|preset| preset == name)
        {
            *name = folder.join(&*name).to_string_lossy().into_owned();
        }
        Ok(options)
    }

    /// From a scene file's text; `place` names it in errors.
    ///
    /// # Errors
    /// Anything wrong, as `place:line: …`.
    pub fn parse(text: &str, place: &str) -> Result<Self> {
        let document = DeTable::parse(text).map_err(|error| located(&error, text, place))?;
        let span = document.span();
        let mut rest = document.into_inner();
        let mut group = Taken {
            rest: &mut rest,
            span,
            text,
            place,
        };
        let options = Self {
            volume: group.take::<VolumeOptions>()?,
            picture: group.take::<PictureOptions>()?,
            camera: group.take::<CameraOptions>()?,
            sampling: group.take::<SamplingOptions>()?,
            tone: group.take::<ToneOptions>()?,
        };
        match rest.keys().min_by_key(|key| key.span().start) {
            Some(key) => Err(unknown(key, text, place)),
            None => Ok(options),
        }
    }
}

/// A document from which each group takes the keys that are its flags.
struct Taken<'a, 'text> {
    rest: &'a mut DeTable<'text>,
    span: Range<usize>,
    text: &'text str,
    place: &'a str,
}

impl<'text> Taken<'_, 'text> {
    fn take<T: Args + Deserialize<'text>>(&mut self) -> Result<T> {
        let names = names::<T>();
        let (own, rest) = std::mem::take(self.rest)
            .into_iter()
            .partition(|(key, _)| names.iter().any(|name| name == key.get_ref().as_ref()));
        *self.rest = rest;
        let own: Spanned<DeTable<'text>> = Spanned::new(self.span.clone(), own);
        T::deserialize(Deserializer::from(own))
            .map_err(|error| located(&error, self.text, self.place))
    }
}

/// The keys of a group: its flags' names, and its arguments without a flag.
fn names<T: Args>() -> Vec<String> {
    T::augment_args(clap::Command::new("scene"))
        .get_arguments()
        .map(|arg| arg.get_id().as_str().replace('_', "-"))
        .collect()
}

fn unknown(key: &Spanned<toml::de::DeString<'_>>, text: &str, place: &str) -> Error {
    let at = format!("{place}:{}", line(text, key.span().start));
    let mut known: Vec<String> = names::<SceneOptions>();
    let wanted = key.get_ref().replace('_', "-");
    let error = Error::usage(format!("'{}' is no option of a scene", key.get_ref())).at(at);
    if known.contains(&wanted) {
        return error.hint(format!("write '{wanted}'"));
    }
    known.sort();
    error.hint(format!("the options are {}", known.join(", ")))
}
