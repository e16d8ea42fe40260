//! What of a scene's light is shown: the pictures of a preset side by side.

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

use crate::error::{Error, Result};
use crate::options::SceneOptions;
use crate::scene::Mode;

/// A look of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// By its own colours alone.
    Unlit,
    /// Lit, and nothing in the way of the light.
    Lit,
    /// Lit, with shadows.
    Shadowed,
}

impl Look {
    /// Every look.
    pub const ALL: [Self; 3] = [Self::Unlit, Self::Lit, Self::Shadowed];

    /// Its name in results and names of files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unlit => "unlit",
            Self::Lit => "lit",
            Self::Shadowed => "shadowed",
        }
    }

    /// What is seen in this look of what `base` shows: lit as `base` says, from the upper left of the viewer where it says
    /// nothing.
    ///
    /// # Errors
    /// Usage: the options contradict each other.
    pub(super) fn of(self, base: &SceneOptions) -> Result<SceneOptions> {
        let option = |text: &str| SceneOptions::parse(text, "look");
        let lit = || {
            Ok(base
                .clone()
                .over(option("shading = 'phong'\nlight = 'camera:-1,1,1'")?))
        };
        match self {
            Self::Unlit => Ok(option("shading = 'none'")?.over(base.clone())),
            Self::Lit => {
                let mut lit: SceneOptions = lit()?;
                lit.effects.shadows = None;
                lit.effects.light_size = None;
                Ok(lit)
            }
            Self::Shadowed => Ok(lit()?.over(option("shadows = 'on'")?)),
        }
    }
}

impl fmt::Display for Look {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for Look {
    fn serialize<S: Serializer>(&self, into: S) -> std::result::Result<S::Ok, S::Error> {
        into.serialize_str(self.name())
    }
}

/// `--preset`: several looks of a scene that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preset {
    /// What light and shadows do: unlit, lit, lit with shadows (Fuller 2011, fig. 9).
    Lighting,
}

impl Preset {
    /// Its looks, in their order.
    pub fn looks(self) -> [Look; 3] {
        match self {
            Self::Lighting => Look::ALL,
        }
    }

    /// The modes that are compared if none are named.
    pub fn modes(self) -> [Mode; 2] {
        match self {
            Self::Lighting => [Mode::Iso, Mode::Dvr],
        }
    }

    /// Checks that its looks differ in a mode.
    ///
    /// # Errors
    /// Usage: they do not.
    pub fn check(self, mode: Mode) -> Result<()> {
        match self {
            Self::Lighting if !mode.is_lit() => Err(Error::usage(format!(
                "'--preset lighting' has no meaning in mode '{mode}': a projection has no light"
            ))
            .hint("name iso, dvr or both in '--modes'")),
            Self::Lighting => Ok(()),
        }
    }
}

impl FromStr for Preset {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "lighting" => Ok(Self::Lighting),
            _ => Err(Error::usage(format!(
                "'{text}' is no preset of a comparison: there is lighting"
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_differ_in_their_light_alone() {
        let given = "iso = 3\nlight = '0,0,1'\nshadows = 'on'\nlight-size = 2\n";
        for text in ["iso = 3\n", given] {
            let is_given = text == given;
            let base = SceneOptions::parse(text, "scene").unwrap();
            let of = |look: Look| {
                look.of(&base)
                    .unwrap()
                    .checked()
                    .unwrap()
                    .to_toml()
                    .unwrap()
            };
            let [unlit, lit, shadowed] = Preset::Lighting.looks().map(of);
            for options in [&unlit, &lit, &shadowed] {
                assert!(options.contains("iso = 3"), "{options}");
            }
            assert!(
                unlit.contains("shading = \"none\"") && !unlit.contains("light ="),
                "{unlit}"
            );
            assert!(
                lit.contains("shading = \"phong\"") && !lit.contains("shadows"),
                "{lit}"
            );
            assert!(shadowed.contains("shadows = \"on\""), "{shadowed}");
            assert_eq!(shadowed.contains("light-size = 2"), is_given, "{shadowed}");
            assert_eq!(lit.contains("camera:-1,1,1"), !is_given, "{lit}");
        }
    }

    #[test]
    fn what_has_no_light_is_refused() {
        assert!(Preset::Lighting.check(Mode::Iso).is_ok());
        let refused = Preset::Lighting.check(Mode::Mip).unwrap_err().to_string();
        assert!(refused.contains("a projection has no light"), "{refused}");
        let refused = "moon".parse::<Preset>().unwrap_err().to_string();
        assert!(refused.contains("'moon' is no preset"), "{refused}");
    }
}
