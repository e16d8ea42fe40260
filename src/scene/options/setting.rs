//! A setting: how the rays of a scene are followed, whatever the scene shows.

use super::SceneOptions;
use super::group::Keys;
use crate::error::{Error, Result};

/// A named choice of sampling, refinement, quadrature and gradients, which can be laid over any
/// scene's options.
///
/// It holds nothing that changes what the scene is of, so that all settings of a scene have the
/// same truth: the reference's picture of the scene without any.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    name: String,
    options: SceneOptions,
}

impl Setting {
    /// The keys of [`PictureOptions`](super::PictureOptions) that a setting may hold, beside all of
    /// [`SamplingOptions`](super::SamplingOptions).
    const KEYS: [&str; 8] = [
        "refine",
        "quad",
        "homogeneity",
        "homogeneity-rule",
        "termination",
        "gradient",
        "gradient-scale",
        "gradient-smooth",
    ];

    /// From the text of a scene file; `name` is what tables call the setting.
    ///
    /// # Errors
    /// Usage: what the text says is wrong, or a key says what is seen rather than how.
    pub fn parse(name: impl Into<String>, text: &str) -> Result<Self> {
        let name = name.into();
        let options = SceneOptions::parse(text, &format!("setting '{name}'"))?;
        Self::new(name, options)
    }

    /// From options that say nothing but how rays are followed.
    ///
    /// # Errors
    /// Usage: an option says what is seen rather than how.
    pub fn new(name: impl Into<String>, options: SceneOptions) -> Result<Self> {
        let name = name.into();
        let said = [
            options.volume.given(),
            options.picture.given(),
            options.camera.given(),
            options.clip.given(),
            options.tone.given(),
        ];
        let mut said = said.iter().flatten();
        match said.find(|key| !Self::is_key_of_picture(key)) {
            None => Ok(Self { name, options }),
            Some(key) => Err(Error::usage(format!(
                "setting '{name}': '{key}' says what is seen, not how its rays are followed"
            ))
            .hint(format!(
                "a setting may say sampling, step, filter, traverse, skip, probe, voxels, {}",
                Self::KEYS.join(", ")
            ))),
        }
    }

    fn is_key_of_picture(key: &str) -> bool {
        Self::KEYS.contains(&key)
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it says.
    pub fn options(&self) -> &SceneOptions {
        &self.options
    }

    /// `base` with its rays followed in this way; of the base's own ways nothing is left.
    pub fn over(&self, base: &SceneOptions) -> SceneOptions {
        self.options.clone().over(base.what())
    }

    /// As flags, for the user to repeat.
    pub fn flags(&self) -> String {
        let table = toml::Table::try_from(&self.options).unwrap_or_default();
        let flags = table.iter().map(|(key, value)| match value {
            toml::Value::String(text) => format!("--{key} {text}"),
            other => format!("--{key} {other}"),
        });
        flags.collect::<Vec<_>>().join(" ")
    }
}

impl SceneOptions {
    /// What is seen, without how rays are followed.
    #[must_use]
    pub fn what(&self) -> Self {
        let keep = |key: &str| !Setting::is_key_of_picture(key);
        Self {
            picture: self.picture.clone().keeping(keep),
            sampling: super::SamplingOptions::default(),
            ..self.clone()
        }
    }

    /// How rays are followed, as far as it was said.
    #[must_use]
    pub fn how(&self) -> Self {
        Self {
            picture: self.picture.clone().keeping(Setting::is_key_of_picture),
            sampling: self.sampling.clone(),
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_replaces_how_and_keeps_what() {
        let base = "mode = 'iso'\niso = 40\nstep = 2\nrefine = 'newton:3'\n";
        let base = SceneOptions::parse(base, "base").unwrap();
        let setting = Setting::parse("coarse", "step = 4\nprobe = 'off'\n").unwrap();
        let expected = "mode = 'iso'\niso = 40\nstep = 4\nprobe = 'off'\n";
        let expected = SceneOptions::parse(expected, "expected").unwrap();
        assert_eq!(setting.over(&base), expected);
        assert_eq!(setting.flags(), "--probe off --step 4");
    }

    #[test]
    fn a_setting_cannot_say_what_is_seen() {
        for text in ["iso = 4", "azimuth = 3", "mode = 'mip'", "window = [0, 1]"] {
            let refused = Setting::parse("x", text).unwrap_err();
            assert!(
                refused.to_string().contains("says what is seen"),
                "{refused}"
            );
        }
        assert!(Setting::parse("x", "stp = 3").is_err());
    }
}
