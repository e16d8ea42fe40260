//! A setting: how the rays of a scene are followed, whatever the scene shows.

use super::SceneOptions;
use super::group::Keys;
use super::rules::{Decides, Group, deciding, rule};
use crate::error::{Error, Result};

/// A named choice of sampling, refinement, quadrature and gradients, which can be laid over any
/// scene's options.
///
/// It holds nothing that changes what the scene is of, so that all settings of a scene have the
/// same reference picture: that of the scene without any.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    name: String,
    options: SceneOptions,
}

impl Setting {
    /// Parses the text of a scene file; `name` is what tables call the setting.
    ///
    /// # Errors
    /// Usage: what the text says is wrong, or a key changes what is shown rather than how.
    pub fn parse(name: impl Into<String>, text: &str) -> Result<Self> {
        let name = name.into();
        let options = SceneOptions::parse(text, &format!("setting '{name}'"))?;
        Self::new(name, options)
    }

    /// Makes a setting of options that say nothing but how rays are followed.
    ///
    /// # Errors
    /// Usage: an option changes what is shown rather than how.
    pub fn new(name: impl Into<String>, options: SceneOptions) -> Result<Self> {
        let name = name.into();
        let what = |option: &&String| !is_how(option);
        match options.given().iter().find(what) {
            None => Ok(Self { name, options }),
            Some(option) => Err(Error::usage(format!(
                "setting '{name}': '{option}' changes what is shown, not how rays are followed"
            ))
            .hint(format!(
                "a setting may give {}",
                deciding(|decides| decides != Decides::What)
                    .collect::<Vec<_>>()
                    .join(", ")
            ))),
        }
    }

    /// The setting's name in tables.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the options by which rays are followed.
    pub fn options(&self) -> &SceneOptions {
        &self.options
    }

    /// `base` with its rays followed by this setting alone.
    pub fn over(&self, base: &SceneOptions) -> SceneOptions {
        self.options.clone().over(base.what())
    }

    /// Returns the setting as flags, for the user to repeat.
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
    /// The options of the picture, without those that say how rays are followed.
    #[must_use]
    pub fn what(&self) -> Self {
        self.clone().retaining(|option| !is_how(option))
    }

    /// How rays are followed, as far as it is given.
    #[must_use]
    pub fn how(&self) -> Self {
        self.clone().retaining(is_how)
    }
}

fn is_how(option: &str) -> bool {
    rule(Group::Scene, option).is_some_and(|rule| rule.decides != Decides::What)
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
                refused.to_string().contains("changes what is shown"),
                "{refused}"
            );
        }
        assert!(Setting::parse("x", "stp = 3").is_err());
    }
}
