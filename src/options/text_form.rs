//! How a value stands in a scene file and in the stats: as the flag's text, where a number or a
//! list of numbers may be written as such.
//!
//! Every such type has one text form (`FromStr`, `Display`), which the command line shares.

use std::fmt;
use std::marker::PhantomData;
use std::str::FromStr;

use serde::de::{self, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serializer};

use crate::extent::ImageSize;

/// Reads a string, a number, on/off as a boolean, or a list (joined by commas) as the flag's text.
pub(crate) fn deserialize<'de, T, D>(from: D) -> Result<T, D::Error>
where
    T: FromStr<Err: fmt::Display>,
    D: Deserializer<'de>,
{
    let text = from.deserialize_any(Text)?;
    text.parse().map_err(de::Error::custom)
}

/// Writes a number as a number, `a,b,c` of numbers as a list, anything else as a string: so that
/// reading it back gives the same text.
pub(super) fn serialize<T, S>(value: &T, into: S) -> Result<S::Ok, S::Error>
where
    T: fmt::Display,
    S: Serializer,
{
    let text = value.to_string();
    if let Some(number) = Number::of(&text) {
        return serde::Serialize::serialize(&number, into);
    }
    let numbers: Option<Vec<Number>> = text.split(',').map(Number::of).collect();
    match numbers {
        Some(numbers) => into.collect_seq(numbers),
        None => into.serialize_str(&text),
    }
}

/// A number whose text form is exactly the one given.
#[derive(serde::Serialize)]
#[serde(untagged)]
enum Number {
    Whole(i64),
    Real(f64),
}

impl Number {
    fn of(text: &str) -> Option<Self> {
        let whole = text.parse::<i64>().ok().map(Self::Whole);
        whole
            .or_else(|| text.parse::<f64>().ok().map(Self::Real))
            .filter(|number| match number {
                Self::Whole(v) => v.to_string() == text,
                Self::Real(v) => v.is_finite() && v.to_string() == text,
            })
    }
}

struct Text;

impl<'de> Visitor<'de> for Text {
    type Value = String;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a string, a number or a list of numbers")
    }

    fn visit_str<E>(self, text: &str) -> Result<String, E> {
        Ok(text.to_owned())
    }

    fn visit_i64<E>(self, number: i64) -> Result<String, E> {
        Ok(number.to_string())
    }

    fn visit_u64<E>(self, number: u64) -> Result<String, E> {
        Ok(number.to_string())
    }

    /// A whole number that does not fit into 64 bits.
    fn visit_i128<E>(self, number: i128) -> Result<String, E> {
        Ok(number.to_string())
    }

    fn visit_f64<E>(self, number: f64) -> Result<String, E> {
        Ok(number.to_string())
    }

    fn visit_bool<E>(self, on: bool) -> Result<String, E> {
        Ok(if on { "on" } else { "off" }.to_owned())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<String, A::Error> {
        let mut parts = Vec::new();
        while let Some(Item(part)) = items.next_element()? {
            parts.push(part);
        }
        Ok(parts.join(","))
    }
}

/// An item of a list, as the flag's text.
pub(super) struct Item(pub(super) String);

impl<'de> serde::Deserialize<'de> for Item {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Text).map(Self)
    }
}

/// Reads an option that may be given several times: one value, or a list of them.
pub(crate) fn one_or_more<'de, T, D>(from: D) -> Result<Option<Vec<T>>, D::Error>
where
    T: Deserialize<'de>,
    D: Deserializer<'de>,
{
    struct OneOrMore<T>(PhantomData<T>);

    impl<'de, T: Deserialize<'de>> Visitor<'de> for OneOrMore<T> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("a string or a list of strings")
        }

        fn visit_str<E: de::Error>(self, text: &str) -> Result<Vec<T>, E> {
            T::deserialize(text.into_deserializer()).map(|one| vec![one])
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Vec<T>, A::Error> {
            let mut all = Vec::new();
            while let Some(one) = items.next_element()? {
                all.push(one);
            }
            Ok(all)
        }
    }

    from.deserialize_any(OneOrMore(PhantomData)).map(Some)
}

/// Lets types with a text form (`FromStr`) be read from scene files.
macro_rules! readable {
    ($($type:ty),* $(,)?) => {$(
        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(
                from: D,
            ) -> std::result::Result<Self, D::Error> {
                $crate::options::text_form::deserialize(from)
            }
        }
    )*};
}
pub(crate) use readable;

/// Gives types with one text form (`FromStr`, `Display`) their place in scene files.
macro_rules! text_form {
    ($($type:ty),* $(,)?) => {$(
        $crate::options::text_form::readable!($type);

        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(
                &self,
                into: S,
            ) -> std::result::Result<S::Ok, S::Error> {
                $crate::options::text_form::serialize(self, into)
            }
        }
    )*};
}
pub(super) use text_form;

/// A picture's size as a list is `[width, height]`.
impl<'de> serde::Deserialize<'de> for ImageSize {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let text = from.deserialize_any(Text)?;
        text.replace(',', "x").parse().map_err(de::Error::custom)
    }
}

impl serde::Serialize for ImageSize {
    fn serialize<S: Serializer>(&self, into: S) -> Result<S::Ok, S::Error> {
        serialize(self, into)
    }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    #[derive(Debug, Default, PartialEq, Deserialize)]
    #[serde(default)]
    struct Options {
        #[serde(deserialize_with = "super::one_or_more")]
        peer: Option<Vec<String>>,
    }

    #[test]
    fn what_may_be_given_several_times_may_be_given_once() {
        let read = |text: &str| toml::from_str::<Options>(text).map(|options| options.peer);
        assert_eq!(read("").unwrap(), None);
        assert_eq!(read("peer = 'a'").unwrap(), Some(vec!["a".into()]));
        let both = Some(vec!["a".into(), "b".into()]);
        assert_eq!(read("peer = ['a', 'b']").unwrap(), both);
        let message = read("peer = 3").unwrap_err().to_string();
        assert!(
            message.contains("expected a string or a list of strings"),
            "{message}"
        );
    }
}
