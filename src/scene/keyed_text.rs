//! Values that are written as a list of keys: `rays=64,distance=5`.

use std::str::FromStr;

use crate::error::{Error, Result};

/// The values of a text `key=value,…`, taken key by key.
pub(super) struct KeyedText<'a> {
    text: &'a str,
    /// What the text is, for messages.
    what: &'static str,
    /// The form that is shown where a text is refused.
    form: &'static str,
    pairs: Vec<(&'a str, &'a str)>,
}

impl<'a> KeyedText<'a> {
    /// Reads the pairs of a text.
    ///
    /// # Errors
    /// Usage: no list of keys with values; a key twice.
    pub fn read(text: &'a str, what: &'static str, form: &'static str) -> Result<Self> {
        let mut keyed = Self {
            text,
            what,
            form,
            pairs: Vec::new(),
        };
        for item in text.split(',') {
            let Some((key, value)) = item.split_once('=') else {
                return Err(keyed.refusal(&format!("'{}' is no key with a value", item.trim())));
            };
            let key = key.trim();
            if keyed.pairs.iter().any(|(given, _)| *given == key) {
                return Err(keyed.refusal(&format!("'{key}' is given twice")));
            }
            keyed.pairs.push((key, value.trim()));
        }
        Ok(keyed)
    }

    /// Takes the value of a key, where it is given.
    ///
    /// # Errors
    /// As those of the value's own text.
    pub fn take<T: FromStr<Err = Error>>(&mut self, key: &str) -> Result<Option<T>> {
        let place = self.pairs.iter().position(|(given, _)| *given == key);
        let value = place.map(|place| self.pairs.remove(place).1.parse());
        value.transpose()
    }

    /// Takes the value of a key that must be given.
    ///
    /// # Errors
    /// Usage: it is not; as those of the value's own text.
    pub fn need<T: FromStr<Err = Error>>(&mut self, key: &str) -> Result<T> {
        let value = self.take(key)?;
        value.ok_or_else(|| self.refusal(&format!("'{key}' is missing")))
    }

    /// Refuses what has not been taken.
    ///
    /// # Errors
    /// Usage: a key that the value does not have.
    pub fn end(&self) -> Result<()> {
        match self.pairs.first() {
            None => Ok(()),
            Some((key, _)) => Err(self.refusal(&format!("'{key}' is none of its keys"))),
        }
    }

    /// The error of a text that is not what it should be, with the form that it should have.
    fn refusal(&self, why: &str) -> Error {
        let Self {
            text, what, form, ..
        } = self;
        Error::usage(format!("{what} '{text}': {why}; write {form}"))
    }
}
