//! How a page writes a figure: three digits that count, powers of ten outside a readable span.

/// A number to two or three significant digits: `0`, `12.3`, `2311`, `−0.004`, `1.2×10⁻⁵`; infinities
/// and NaN as `–`.
pub fn figure(number: f64) -> String {
    if !number.is_finite() {
        return "–".into();
    }
    let sign = if number < 0.0 { "−" } else { "" };
    let size = number.abs();
    if size == 0.0 {
        "0".into()
    } else if (1e-3..999_999.5).contains(&size) {
        // Rounding first, so that 9.996 is 10.0 and not 10.00.
        let rounded: f64 = format!("{size:.2e}").parse().expect("a number's own text");
        let decimals = (2 - rounded.log10().floor() as i32).max(0) as usize;
        let text = format!("{size:.decimals$}");
        let text = match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.'),
            false => &text,
        };
        format!("{sign}{text}")
    } else {
        let text = format!("{size:.1e}");
        let (digits, power) = text.split_once('e').expect("written with an exponent");
        format!(
            "{sign}{}×10{}",
            digits.trim_end_matches(".0"),
            raised(power)
        )
    }
}

fn raised(power: &str) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let up = |c: char| c.to_digit(10).map_or('⁻', |d| digits[d as usize]);
    power.chars().map(up).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_that_count() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (12.345, "12.3"),
            (9.996, "10"),
            (2311.4, "2311"),
            (-0.004, "−0.004"),
            (0.123_45, "0.123"),
            (1.2e-5, "1.2×10⁻⁵"),
            (-3e-12, "−3×10⁻¹²"),
            (4.56e7, "4.6×10⁷"),
            (999_999.7, "1×10⁶"),
            (f64::NAN, "–"),
            (f64::INFINITY, "–"),
        ];
        for (number, expected) in cases {
            assert_eq!(figure(number), expected);
        }
    }
}
