//! `--configs`: the settings that are compared, from a file.

use std::path::Path;

use crate::error::{Error, Result};
use crate::input;
use crate::options::{Part, SceneFile, SceneOptions, Setting};
use crate::scene::Mode;
use crate::scene::toml_error::located;

/// The contents of a file of settings.
///
/// ```toml
/// [[setting]]
/// name = "coarse"
/// modes = ["iso", "mip"]      # left out: every mode
/// step = 2
/// probe = "off"
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Configs {
    settings: Vec<Config>,
}

/// The most settings: more would take too long to compare.
const MAX_SETTINGS: usize = 256;

const HINT: &str = "write [[setting]], a name, and keys such as step = 0.5";

#[derive(Debug, Clone, PartialEq)]
struct Config {
    setting: Setting,
    modes: Option<Vec<Mode>>,
}

impl Configs {
    /// Reads a file of settings.
    ///
    /// # Errors
    /// The file cannot be read; usage: it is no TOML, has other tables than `[[setting]]`, or a
    /// setting has no name or another's, or says what no setting can.
    pub fn read(path: &Path) -> Result<Self> {
        let text = input::text(path, "read the settings")?;
        Self::parse(&text, &path.display().to_string())
    }

    fn parse(text: &str, place: &str) -> Result<Self> {
        let table: toml::Table = text
            .parse()
            .map_err(|error: toml::de::Error| located(&error, text, place).hint(HINT))?;
        let wrong = |sentence: String| Error::usage(sentence).hint(HINT).at(place);
        if let Some(key) = table.keys().find(|key| *key != "setting") {
            return Err(wrong(format!("'{key}' is not a key of a file of settings")));
        }
        let Some(toml::Value::Array(entries)) = table.get("setting") else {
            return Err(wrong("there is no [[setting]]".into()));
        };
        if entries.len() > MAX_SETTINGS {
            return Err(wrong(format!(
                "{} settings: there may be at most {MAX_SETTINGS}",
                entries.len()
            )));
        }
        let mut settings: Vec<Config> = Vec::new();
        for (at, entry) in entries.iter().enumerate() {
            let toml::Value::Table(entry) = entry else {
                return Err(wrong(format!("setting {} is not a table", at + 1)));
            };
            let name = name_of(entry, at + 1).map_err(|error| error.at(place))?;
            if settings.iter().any(|other| other.setting.name() == name) {
                return Err(wrong(format!("two settings are called '{name}'")));
            }
            let named = |error: Error| error.at(format!("setting '{name}'")).at(place);
            let modes = entry
                .get("modes")
                .map(modes_of)
                .transpose()
                .map_err(named)?;
            let part = Part {
                array: "setting",
                nth: at,
                without: &["name", "modes"],
            };
            let options = SceneOptions::of_whole(&SceneFile::of_part(text, place, part))?;
            settings.push(Config {
                setting: Setting::new(name, options).map_err(|error| error.at(place))?,
                modes,
            });
        }
        Ok(Self { settings })
    }

    /// The modes that the settings name; nothing where one of them is for every mode.
    pub fn modes(&self) -> Option<Vec<Mode>> {
        let named: Option<Vec<&Vec<Mode>>> = self
            .settings
            .iter()
            .map(|config| config.modes.as_ref())
            .collect();
        let named = named?;
        let is_named = |mode: &Mode| named.iter().any(|modes| modes.contains(mode));
        Some(Mode::ALL.into_iter().filter(is_named).collect())
    }

    /// The settings for a mode, in the file's order.
    pub fn of_mode(&self, mode: Mode) -> Vec<Setting> {
        let suits = |config: &&Config| {
            let modes = config.modes.as_ref();
            modes.is_none_or(|modes| modes.contains(&mode))
        };
        let configs = self.settings.iter().filter(suits);
        configs.map(|config| config.setting.clone()).collect()
    }
}

/// A setting's name; `number` counts from 1.
fn name_of(entry: &toml::Table, number: usize) -> Result<String> {
    match entry.get("name") {
        Some(toml::Value::String(name)) if name.contains(char::is_control) => Err(Error::usage(
            format!("setting {number}: its name has a line break or another control character"),
        )),
        Some(toml::Value::String(name)) if !name.trim().is_empty() => Ok(name.clone()),
        _ => {
            Err(Error::usage(format!("setting {number} has no name")).hint("write name = \"...\""))
        }
    }
}

fn modes_of(value: &toml::Value) -> Result<Vec<Mode>> {
    let mode = |mode: &toml::Value| match mode {
        toml::Value::String(text) => text.parse::<Mode>(),
        other => Err(Error::usage(format!("{other} is not a mode's name"))),
    };
    match value {
        toml::Value::Array(modes) if modes.is_empty() => {
            Err(Error::usage("modes is empty").hint("leave it out for every mode"))
        }
        toml::Value::Array(modes) => modes.iter().map(mode).collect(),
        _ => Err(Error::usage("modes is a list, such as [\"iso\", \"mip\"]")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_for_the_modes_that_they_name() {
        let text = "[[setting]]\nname = 'a'\nstep = 2\nprobe = 'off'\n\
            [[setting]]\nname = 'b'\nmodes = ['mip']\nsampling = 'exact'\n";
        let configs = Configs::parse(text, "file").unwrap();
        assert_eq!(configs.modes(), None);
        let names = |mode| -> Vec<String> {
            let settings = configs.of_mode(mode);
            settings.iter().map(|one| one.name().to_owned()).collect()
        };
        assert_eq!(names(Mode::Mip), ["a", "b"]);
        assert_eq!(names(Mode::Iso), ["a"]);
        assert_eq!(
            configs.of_mode(Mode::Iso)[0].flags(),
            "--probe off --step 2"
        );
    }

    #[test]
    fn where_every_setting_names_modes_these_are_compared() {
        let text = "[[setting]]\nname = 'a'\nstep = 2\nmodes = ['dvr']\n\
            [[setting]]\nname = 'b'\nmodes = ['mip', 'dvr']\nstep = 1\n";
        let configs = Configs::parse(text, "file").unwrap();
        assert_eq!(configs.modes(), Some(vec![Mode::Mip, Mode::Dvr]));
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, sentence) in [
            ("x = [", "file:1: "),
            ("[[setting]]\nname = 'a'\nx = [", "file:3: "),
            ("[[setting]]\nname = \"a\\u001b\"", "control character"),
            ("[[setting]]\nname = 'a'\nmodes = []", "modes is empty"),
            (
                "[[setting]]\nname = 'a'\nmodes = [3]",
                "3 is not a mode's name",
            ),
            ("[[setting]]\nname = 'a'\nstep = -2", "file:3: a step of -2"),
            (
                "[[setting]]\nname = 'a'\n[[setting]]\nname = 'b'\nstp = 2",
                "file:5: 'stp'",
            ),
            ("", "there is no [[setting]]"),
            ("[camera]\nfov = 3", "'camera' is not a key"),
            ("setting = 3", "there is no [[setting]]"),
            ("setting = [3]", "setting 1 is not a table"),
            ("[[setting]]\nstep = 2", "setting 1 has no name"),
            ("[[setting]]\nname = 'a'\nmodes = 'iso'", "modes is a list"),
            (
                "[[setting]]\nname = 'a'\nmodes = ['x']",
                "'x' is not a mode",
            ),
            (
                "[[setting]]\nname = 'a'\niso = 3",
                "'iso' changes what is shown",
            ),
            ("[[setting]]\nname = 'a'\nstp = 3", "stp"),
            (
                "[[setting]]\nname = 'a'\n[[setting]]\nname = 'a'",
                "two settings are called 'a'",
            ),
        ] {
            let refused = Configs::parse(text, "file").unwrap_err().to_string();
            assert!(refused.contains(sentence), "{text}: {refused}");
        }
    }
}
