//! Numbers as texts: how a user writes them, and how messages print them.

use crate::error::{Error, Result};
use crate::extent::Range;

/// Prints a number as a reader wants it: with seven significant digits, very large and very small ones with an
/// exponent.
pub(crate) fn concise(value: f64) -> String {
    in_digits(value, 7)
}

/// Prints a number as [`concise`] does, with as many more digits as it takes to distinguish the values of
/// a `range` far from zero.
pub(crate) fn concise_within(value: f64, range: Range) -> String {
    let magnitude = range.min.abs().max(range.max.abs());
    let lost = match range.width() {
        0.0 => 0.0,
        width => (magnitude / width).log10().clamp(0.0, 11.0),
    };
    in_digits(value, (6 + lost as usize).max(7))
}

fn in_digits(value: f64, digits: usize) -> String {
    let rounded: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        1e-4..1e10 => rounded.to_string(),
        _ => format!("{rounded:e}"),
    }
}

/// Reads a whole number from `min` on.
///
/// # Errors
/// Usage: no whole number, a smaller one, or one that 64 bits do not hold.
pub(crate) fn whole(text: &str, min: u64) -> Result<u64> {
    use std::num::IntErrorKind::PosOverflow;
    match text.trim().parse::<u64>() {
        Ok(number) if number >= min => Ok(number),
        Err(error) if *error.kind() == PosOverflow => Err(too_large(text)),
        _ => Err(Error::usage(format!(
            "'{text}' is not a whole number of at least {min}"
        ))),
    }
}

pub(crate) fn too_large(text: &str) -> Error {
    Error::usage(format!("'{text}' is too large a number"))
}

/// Reads a finite number.
///
/// # Errors
/// Usage: anything else, NaN and infinity included.
pub(crate) fn number(text: &str) -> Result<f64> {
    let value: Option<f64> = text.trim().parse().ok();
    value
        .filter(|v| v.is_finite())
        .ok_or_else(|| Error::usage(format!("'{text}' is not a number")))
}

/// Reads exactly `N` finite numbers with commas between them; `None` where the text is anything else.
pub(crate) fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers: Result<Vec<f64>> = text.split(',').map(number).collect();
    numbers.ok()?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        for (value, text) in [
            (7.000000000000001, "7"),
            (563.2000029087067, "563.2"),
            (-32768.0, "-32768"),
            (16777.216, "16777.22"),
            (-0.0, "0"),
            (0.00573585, "0.00573585"),
            (1e200, "1e200"),
            (-3.25e-12, "-3.25e-12"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(concise(value), text);
        }
        // The control: what is printed otherwise.
        assert_ne!(concise(1e200), 1e200.to_string());
    }

    #[test]
    fn lists_have_as_many_finite_numbers_as_they_must() {
        assert_eq!(numbers("1, 2,-3.5"), Some([1.0, 2.0, -3.5]));
        for wrong in ["1,2", "1,2,3,4", "1,2,nan", "1,,3", ""] {
            assert_eq!(numbers::<3>(wrong), None, "{wrong}");
        }
    }
}
