//! The scene file: TOML with the flags' names as keys.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue, Deserializer};

use super::{
    CameraOptions, ClipOptions, EffectOptions, FilePath, PictureOptions, SamplingOptions,
    SceneOptions, ToneOptions, TransferChoice, VolumeOptions,
};
use crate::error::{Error, Result};
use crate::input;
use crate::scene::toml_error::{line, located};

/// A scene file's text and where it comes from. Groups of options are taken from it one by one:
/// one file can serve several commands.
pub struct SceneFile {
    text: String,
    /// Names the file in errors.
    place: String,
    /// Where the files that it names are looked for.
    named: Named,
    /// The part of the text that was read, if not all.
    part: Option<Part>,
}

/// Where the files are that a scene names.
enum Named {
    /// They are relative to this folder.
    In(PathBuf),
    /// They are where the picture's maker named them, else beside this picture, else in the working
    /// folder.
    NearPicture(PathBuf),
}

/// One table of an array of tables in a TOML text that holds more than a scene.
#[derive(Debug, Clone, Copy)]
pub struct Part {
    /// The array's key.
    pub array: &'static str,
    /// The number of the part, from 0.
    pub nth: usize,
    /// The keys of the table that are no options of a scene.
    pub without: &'static [&'static str],
}

impl SceneFile {
    /// Reads a scene file.
    ///
    /// # Errors
    /// An unreadable file, one that is no text.
    pub fn read(path: &Path) -> Result<Self> {
        let text = String::from_utf8(input::bytes(path, "read the scene")?).map_err(|_| {
            Error::input(format!(
                "{}: not a scene: neither a text, which is TOML in UTF-8, nor a .png or .exr that carries one",
                path.display()
            ))
        })?;
        Ok(Self {
            text,
            place: path.display().to_string(),
            named: Named::In(path.parent().unwrap_or(Path::new("")).to_owned()),
            part: None,
        })
    }

    /// The text of the scene that a picture carries.
    pub fn of_picture(text: &str, picture: &Path) -> Self {
        Self {
            place: format!("{} (its scene)", picture.display()),
            named: Named::NearPicture(picture.to_owned()),
            ..Self::of_text(text, "")
        }
    }

    /// Takes a scene file's text; `place` names it in errors. The files that it names are relative to
    /// the working folder.
    pub fn of_text(text: &str, place: &str) -> Self {
        Self {
            text: text.to_owned(),
            place: place.to_owned(),
            named: Named::In(PathBuf::new()),
            part: None,
        }
    }

    /// Takes a part of a text; otherwise like [`Self::of_text`].
    pub fn of_part(text: &str, place: &str, part: Part) -> Self {
        Self {
            part: Some(part),
            ..Self::of_text(text, place)
        }
    }

    /// The group whose flags' names are keys of this file; all other keys are left alone.
    ///
    /// # Errors
    /// No TOML; a wrong value; as `place:line: …`.
    pub fn group<T: Args + DeserializeOwned>(&self) -> Result<T> {
        let document = self.document()?;
        let span = document.span();
        let names = flag_names(&T::augment_args(clap::Command::new("scene")));
        let own: DeTable<'_> = document
            .into_inner()
            .into_iter()
            .filter(|(key, _)| names.iter().any(|name| name == key.get_ref().as_ref()))
            .collect();
        T::deserialize(Deserializer::from(Spanned::new(span, own)))
            .map_err(|error| located(&error, &self.text, &self.place))
    }

    /// Checks that every key is one of `known`.
    ///
    /// # Errors
    /// No TOML; the first key that is not, as `place:line: …`.
    pub fn check_keys(&self, known: &[String]) -> Result<()> {
        let table = self.document()?.into_inner();
        let is_known = |key: &str| known.iter().any(|name| name == key);
        let strays = table.keys().filter(|key| !is_known(key.get_ref()));
        let Some(stray) = strays.min_by_key(|key| key.span().start) else {
            return Ok(());
        };
        let name = stray.get_ref();
        let at = format!("{}:{}", self.place, line(&self.text, stray.span().start));
        let error = Error::usage(format!("'{name}' is not an option of a scene")).at(at);
        let wanted = name.replace('_', "-");
        if is_known(&wanted) {
            return Err(error.hint(format!("write '{wanted}'")));
        }
        if let Some(near) = nearest(&wanted, known) {
            return Err(error.hint(format!("did you mean '{near}'?")));
        }
        let mut known: Vec<&str> = known.iter().map(String::as_str).collect();
        known.sort_unstable();
        known.dedup();
        Err(error.hint(format!("the options are {}", known.join(", "))))
    }

    /// A file named in this one: relative to it; in a picture's scene the first of [`Self::places`] where
    /// there is one.
    #[must_use]
    pub fn named_here(&self, file: FilePath) -> FilePath {
        let places = self.places(&file);
        let found = places.iter().find(|place| place.exists());
        FilePath(found.or(places.first()).cloned().unwrap_or(file.0))
    }

    /// Where a file named in this one is looked for, in this order: relative to it; of a picture's scene
    /// where the scene says, beside the picture, in the working folder.
    pub fn places(&self, file: &FilePath) -> Vec<PathBuf> {
        let FilePath(file) = file;
        match &self.named {
            Named::In(folder) => vec![folder.join(file)],
            Named::NearPicture(picture) => {
                let beside = picture.parent().unwrap_or(Path::new(""));
                let name = Path::new(file.file_name().unwrap_or_default());
                let mut places = vec![file.clone()];
                for place in [beside.join(file), beside.join(name), name.to_owned()] {
                    if !places.contains(&place) {
                        places.push(place);
                    }
                }
                places
            }
        }
    }

    fn document(&self) -> Result<Spanned<DeTable<'_>>> {
        let document =
            DeTable::parse(&self.text).map_err(|error| located(&error, &self.text, &self.place))?;
        let Some(part) = self.part else {
            return Ok(document);
        };
        let span = document.span();
        let array = document.into_inner().remove(part.array);
        let tables = match array.map(Spanned::into_inner) {
            Some(DeValue::Array(tables)) => tables,
            _ => DeArray::new(),
        };
        let mut table = match tables.into_iter().nth(part.nth).map(Spanned::into_inner) {
            Some(DeValue::Table(table)) => table,
            _ => DeTable::new(),
        };
        part.without.iter().for_each(|key| drop(table.remove(*key)));
        Ok(Spanned::new(span, table))
    }
}

/// The key most like `name`, if any is: by the measure and the limit of the parser of flags.
fn nearest<'a>(name: &str, known: &'a [String]) -> Option<&'a str> {
    let alike = known.iter().map(|key| (strsim::jaro(name, key), key));
    let alike = alike.filter(|(likeness, _)| *likeness > 0.7);
    let nearest = alike.max_by(|(a, _), (b, _)| a.total_cmp(b));
    nearest.map(|(_, key)| key.as_str())
}

/// The scene file keys of a command's flags: their names, and those of its arguments without a
/// flag.
pub fn flag_names(command: &clap::Command) -> Vec<String> {
    let name = |argument: &clap::Arg| match argument.get_long() {
        Some(long) => long.to_owned(),
        None => argument.get_id().as_str().replace('_', "-"),
    };
    command.get_arguments().map(name).collect()
}

impl SceneOptions {
    /// The options of the scene that a scene file gives. Its `volume`, and its `tf` when that is a file,
    /// are relative to it.
    ///
    /// # Errors
    /// As [`SceneFile::group`].
    pub fn of_file(file: &SceneFile) -> Result<Self> {
        let mut options = Self {
            volume: VolumeOptions::of_file(file)?,
            picture: file.group::<PictureOptions>()?,
            camera: file.group::<CameraOptions>()?,
            clip: file.group::<ClipOptions>()?,
            sampling: file.group::<SamplingOptions>()?,
            effects: file.group::<EffectOptions>()?,
            tone: file.group::<ToneOptions>()?,
        };
        if let Some(path) = options.picture.tf.as_ref().and_then(TransferChoice::file) {
            let FilePath(path) = file.named_here(FilePath(path));
            let name = path.to_string_lossy().into_owned();
            options.picture.tf = Some(TransferChoice::Named(name));
        }
        Ok(options)
    }

    /// Parses the text of a scene file that says nothing but the scene; `place` names it in errors.
    ///
    /// # Errors
    /// Anything wrong, an unknown key too, as `place:line: …`.
    pub fn parse(text: &str, place: &str) -> Result<Self> {
        Self::of_whole(&SceneFile::of_text(text, place))
    }

    /// Parses a scene file that says nothing but the scene.
    ///
    /// # Errors
    /// As [`Self::parse`].
    pub fn of_whole(file: &SceneFile) -> Result<Self> {
        file.check_keys(&flag_names(&Self::augment_args(clap::Command::new(
            "scene",
        ))))?;
        Self::of_file(file)
    }
}

impl VolumeOptions {
    /// The options of the volume that a scene file gives, whose file is relative to it.
    ///
    /// # Errors
    /// As [`SceneFile::group`].
    pub fn of_file(file: &SceneFile) -> Result<Self> {
        let options = file.group::<Self>()?;
        Ok(Self {
            volume: options.volume.map(|volume| file.named_here(volume)),
            ..options
        })
    }
}
