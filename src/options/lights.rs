//! How lights stand in a scene file: a string, three numbers for the direction toward one, or a list of
//! several of these.

use std::fmt;

use serde::de::{self, SeqAccess, Visitor};
use serde::{Deserializer, Serializer};

use super::text_form::{self, Item};
use crate::error::Result;
use crate::number_text::number;
use crate::scene::Light;

/// Reads a light, or a list of them. A list of numbers alone is the direction toward one.
pub(super) fn deserialize<'de, D>(from: D) -> std::result::Result<Option<Vec<Light>>, D::Error>
where
    D: Deserializer<'de>,
{
    let texts = from.deserialize_any(Texts)?;
    let lights = texts.iter().map(|text| text.parse::<Light>());
    let lights = lights.collect::<Result<_>>().map_err(de::Error::custom)?;
    Ok(Some(lights))
}

/// Writes one light as any option, several as a list of strings.
pub(super) fn serialize<S>(
    lights: &Option<Vec<Light>>,
    into: S,
) -> std::result::Result<S::Ok, S::Error>
where
    S: Serializer,
{
    match lights.as_deref().unwrap_or_default() {
        [light] => text_form::serialize(light, into),
        lights => into.collect_seq(lights.iter().map(Light::to_string)),
    }
}

struct Texts;

impl<'de> Visitor<'de> for Texts {
    type Value = Vec<String>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a light or a list of lights")
    }

    fn visit_str<E>(self, text: &str) -> std::result::Result<Vec<String>, E> {
        Ok(vec![text.to_owned()])
    }

    fn visit_seq<A: SeqAccess<'de>>(
        self,
        mut items: A,
    ) -> std::result::Result<Vec<String>, A::Error> {
        let mut texts = Vec::new();
        while let Some(Item(text)) = items.next_element()? {
            texts.push(text);
        }
        let is_one = !texts.is_empty() && texts.iter().all(|text| number(text).is_ok());
        Ok(if is_one { vec![texts.join(",")] } else { texts })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::SceneOptions;

    fn lights(text: &str) -> Result<Vec<Light>> {
        let options = SceneOptions::parse(text, "scene")?;
        Ok(options.picture.light.unwrap_or_default())
    }

    #[test]
    fn a_scene_file_has_a_light_or_a_list_of_lights() {
        let toward = |x, y, z| Light::distant(glam::DVec3::new(x, y, z)).unwrap();
        for (text, expected) in [
            ("light = 'headlight'", vec![Light::HEADLIGHT]),
            ("light = [1, -2, 0.5]", vec![toward(1.0, -2.0, 0.5)]),
            ("light = '1,-2,0.5'", vec![toward(1.0, -2.0, 0.5)]),
            ("light = ['1,-2,0.5']", vec![toward(1.0, -2.0, 0.5)]),
            (
                "light = ['headlight', [0, 0, 1]]",
                vec![Light::HEADLIGHT, toward(0.0, 0.0, 1.0)],
            ),
        ] {
            assert_eq!(lights(text).unwrap(), expected, "{text}");
        }
        for (text, says) in [
            ("light = 3", "a light or a list of lights"),
            ("light = [1, 2]", "'1,2' is no place of a light"),
            ("light = ['headlight', 'moon']", "'moon' is no place"),
        ] {
            let refused = lights(text).unwrap_err().to_string();
            assert!(refused.contains(says), "{text}: {refused}");
        }
    }

    #[test]
    fn lights_are_written_as_they_are_read() {
        for text in [
            "light = \"headlight\"\n",
            "light = [1, -2, 0.5]\n",
            "light = [\"headlight@0.5\", \"point:1,2,3@1,0.5,0\", \"0,0,1\"]\n",
        ] {
            let options = SceneOptions::parse(text, "scene").unwrap();
            assert_eq!(options.to_toml().unwrap(), text);
        }
    }
}
