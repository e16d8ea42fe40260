//! What a picture carries of how it was made.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::frame::{Format, carrier, read_metadata};
use crate::options::SceneFile;

/// The metadata of a picture: its scene and its provenance.
pub struct Carried {
    pub picture: PathBuf,
    pub format: Format,
    /// The scene, as the text of a scene file.
    pub scene: String,
    /// The version of the program that made the picture.
    pub version: Option<String>,
    /// The hash of the volume's content, in hexadecimal.
    pub content: Option<String>,
    /// The name of what rendered.
    pub device: Option<String>,
}

impl Carried {
    /// Reads what a file carries; `None` if it is no picture of the formats that carry scenes, which are
    /// recognised by content. A file that is not regular, such as a pipe, can be read only once, and
    /// carries nothing.
    ///
    /// # Errors
    /// A picture that is damaged, or carries no scene.
    pub fn of(path: &Path) -> Result<Option<Self>> {
        if !path.is_file() {
            return Ok(None);
        }
        let Some(format) = carrier(path)? else {
            return Ok(None);
        };
        let mut texts = read_metadata(path)?;
        let mut take = |key: &str| {
            let at = texts.iter().position(|(name, _)| name == key)?;
            Some(texts.swap_remove(at).1)
        };
        let Some(scene) = take("scene") else {
            return Err(Error::input(format!(
                "{}: a picture that carries no scene",
                path.display()
            ))
            .hint("the .png and .exr files of render, orbit and compare carry theirs, unless another program wrote them again"));
        };
        Ok(Some(Self {
            picture: path.to_owned(),
            format,
            scene,
            version: take("version"),
            content: take("content"),
            device: take("device"),
        }))
    }

    /// The scene as a file of options.
    pub fn scene_file(&self) -> SceneFile {
        SceneFile::of_picture(&self.scene, &self.picture)
    }
}
