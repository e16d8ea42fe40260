//! Transfer functions as options name or contain them.

use std::convert::Infallible;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::error::Result;
use crate::scene::TransferFile;

/// `--tf`: a preset's name or a file's, or in a scene file the function itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum TransferChoice {
    /// The name of a preset, or else of a file.
    Named(String),
    /// The function itself, as a table of the scene file.
    Written(TransferFile),
}

impl TransferChoice {
    /// The file named, where it is one.
    pub fn file(&self) -> Option<PathBuf> {
        match self {
            Self::Named(name) if TransferFile::preset(name).is_none() => Some(PathBuf::from(name)),
            _ => None,
        }
    }

    /// Reads the preset or the file.
    ///
    /// # Errors
    /// As [`TransferFile::named`].
    pub fn read(self) -> Result<TransferFile> {
        match self {
            Self::Named(name) => TransferFile::named(&name),
            Self::Written(file) => Ok(file),
        }
    }
}

impl FromStr for TransferChoice {
    type Err = Infallible;

    fn from_str(name: &str) -> std::result::Result<Self, Infallible> {
        Ok(Self::Named(name.to_owned()))
    }
}

impl<'de> Deserialize<'de> for TransferChoice {
    fn deserialize<D: Deserializer<'de>>(from: D) -> std::result::Result<Self, D::Error> {
        struct NameOrTable;

        impl<'de> Visitor<'de> for NameOrTable {
            type Value = TransferChoice;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a preset, a file's name, or a table with points")
            }

            fn visit_str<E>(self, name: &str) -> std::result::Result<Self::Value, E> {
                Ok(TransferChoice::Named(name.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(
                self,
                table: A,
            ) -> std::result::Result<Self::Value, A::Error> {
                TransferFile::deserialize(MapAccessDeserializer::new(table))
                    .map(TransferChoice::Written)
            }
        }

        from.deserialize_any(NameOrTable)
    }
}
