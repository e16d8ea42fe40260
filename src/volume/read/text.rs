//! Numbers written as text: in headers, and voxels themselves.

use std::io::{self, BufRead, Read};
use std::str::FromStr;

use super::element::Scalar;
use crate::error::{Error, Result};

/// One number, or a sentence that names the field and what it takes.
pub(super) fn number<T: FromStr>(field: &str, text: &str) -> Result<T> {
    text.trim().parse().map_err(|_| {
        let wanted = match std::any::type_name::<T>() {
            "i64" => "a whole number of 64 bits",
            "u64" | "usize" => "a whole number from 0 to 2^64 - 1",
            _ => "a number",
        };
        Error::input(format!("the header's '{field}: {text}' is not {wanted}"))
    })
}

/// Numbers separated by blanks, or a sentence that names the field.
pub(super) fn numbers<T: FromStr>(field: &str, text: &str) -> Result<Vec<T>> {
    text.split_whitespace()
        .map(|word| number(field, word))
        .collect()
}

/// Parses exactly `count` numbers; compare [`numbers`].
pub(super) fn exactly<T: FromStr>(field: &str, text: &str, count: usize) -> Result<Vec<T>> {
    let found = numbers(field, text)?;
    if found.len() != count {
        return Err(Error::input(format!(
            "the header's '{field}: {text}' has {} numbers instead of {count}",
            found.len()
        )));
    }
    Ok(found)
}

/// Written numbers, separated by blanks or commas, as the bytes of a native-endian scalar.
pub(super) struct TextNumbers<R> {
    text: R,
    scalar: Scalar,
    /// The current number's bytes, from `given` on not yet handed out.
    bytes: [u8; 8],
    given: usize,
    length: usize,
}

impl<R: BufRead> TextNumbers<R> {
    /// The longest word that can be a number.
    const LONGEST_WORD: usize = 400;

    pub(super) fn new(text: R, scalar: Scalar) -> Self {
        Self {
            text,
            scalar,
            bytes: [0; 8],
            given: 0,
            length: 0,
        }
    }

    /// The next word, empty at the end.
    fn word(&mut self) -> io::Result<String> {
        let mut word = Vec::new();
        loop {
            let available = self.text.fill_buf()?;
            let Some(&byte) = available.first() else {
                break;
            };
            if byte.is_ascii_whitespace() || byte == b',' {
                if !word.is_empty() {
                    break;
                }
            } else {
                word.push(byte);
            }
            self.text.consume(1);
            if word.len() > Self::LONGEST_WORD {
                break;
            }
        }
        Ok(String::from_utf8_lossy(&word).into_owned())
    }

    fn parse(&mut self, word: &str) -> Option<()> {
        macro_rules! put {
            ($t:ty) => {{
                let bytes = word.parse::<$t>().ok()?.to_ne_bytes();
                self.bytes[..bytes.len()].copy_from_slice(&bytes);
                self.length = bytes.len();
            }};
        }
        match self.scalar {
            Scalar::U8 => put!(u8),
            Scalar::I8 => put!(i8),
            Scalar::U16 => put!(u16),
            Scalar::I16 => put!(i16),
            Scalar::U32 => put!(u32),
            Scalar::I32 => put!(i32),
            Scalar::U64 => put!(u64),
            Scalar::I64 => put!(i64),
            Scalar::F32 => put!(f32),
            Scalar::F64 => put!(f64),
            Scalar::F16 => return None,
        }
        self.given = 0;
        Some(())
    }
}

impl<R: BufRead> Read for TextNumbers<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut filled = 0;
        while filled < buffer.len() {
            if self.given == self.length {
                let word = self.word()?;
                if word.is_empty() {
                    break;
                }
                self.parse(&word).ok_or_else(|| {
                    let shown: String = word.chars().take(20).collect();
                    io::Error::new(
                        io::ErrorKind::InvalidData,
                        format!("'{shown}' is not a number of type {}", self.scalar.name()),
                    )
                })?;
            }
            let count = (self.length - self.given).min(buffer.len() - filled);
            buffer[filled..filled + count]
                .copy_from_slice(&self.bytes[self.given..self.given + count]);
            filled += count;
            self.given += count;
        }
        Ok(filled)
    }
}

/// Bytes written as pairs of hexadecimal digits; blanks between digits do not matter.
pub(super) struct HexBytes<R>(pub(super) R);

impl<R: BufRead> HexBytes<R> {
    /// The next digit; `None` at the end.
    fn digit(&mut self) -> io::Result<Option<u8>> {
        loop {
            let Some(&byte) = self.0.fill_buf()?.first() else {
                return Ok(None);
            };
            self.0.consume(1);
            if byte.is_ascii_whitespace() {
                continue;
            }
            let digit = char::from(byte).to_digit(16).ok_or_else(|| {
                let shown = char::from(byte).escape_default();
                let what = format!("'{shown}' is not a hexadecimal digit");
                io::Error::new(io::ErrorKind::InvalidData, what)
            })?;
            return Ok(Some(digit as u8));
        }
    }
}

impl<R: BufRead> Read for HexBytes<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        for (filled, byte) in buffer.iter_mut().enumerate() {
            let Some(high) = self.digit()? else {
                return Ok(filled);
            };
            let Some(low) = self.digit()? else {
                return Err(io::ErrorKind::UnexpectedEof.into());
            };
            *byte = high << 4 | low;
        }
        Ok(buffer.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexadecimal_digits_become_bytes_and_others_a_sentence() {
        let decoded = |text: &[u8]| {
            let mut bytes = Vec::new();
            HexBytes(text).read_to_end(&mut bytes).map(|_| bytes)
        };
        assert_eq!(decoded(b"9cFF\n0 0\t1a\n").unwrap(), [0x9c, 0xff, 0, 0x1a]);
        let error = decoded(b"00xx").unwrap_err();
        assert!(error.to_string().contains("'x'"), "{error}");
        assert!(decoded(b"00 1").is_err());
    }

    #[test]
    fn a_number_that_does_not_fit_is_not_called_none() {
        let sentence = |error: Error| error.to_string();
        assert_eq!(number::<i64>("byte skip", "2147483648").unwrap(), 1 << 31);
        assert_eq!(
            sentence(number::<u64>("sizes", "-5").unwrap_err()),
            "the header's 'sizes: -5' is not a whole number from 0 to 2^64 - 1"
        );
        assert_eq!(
            sentence(number::<i64>("byte skip", "1e30").unwrap_err()),
            "the header's 'byte skip: 1e30' is not a whole number of 64 bits"
        );
        assert!(sentence(number::<f64>("spacings", "x").unwrap_err()).ends_with("not a number"));
    }

    #[test]
    fn written_numbers_become_bytes_and_bad_ones_a_sentence() {
        let mut bytes = Vec::new();
        TextNumbers::new(&b" 1, -2\n300\t"[..], Scalar::I16)
            .read_to_end(&mut bytes)
            .unwrap();
        let expected: Vec<u8> = [1i16, -2, 300]
            .iter()
            .flat_map(|n| n.to_ne_bytes())
            .collect();
        assert_eq!(bytes, expected);
        for bad in ["1 2x", "40000", "1.5"] {
            let read = TextNumbers::new(bad.as_bytes(), Scalar::I16).read_to_end(&mut bytes);
            assert!(read.is_err(), "{bad}");
        }
    }
}
