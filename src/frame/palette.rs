//! Colours for numbers, computed rather than tabulated.

use std::f64::consts::FRAC_PI_3;

/// An sRGB colour.
pub type Rgb = [u8; 3];

/// The length of the palette's ends in Msh space (CIELAB's lightness, chroma and hue in polar form):
/// both are as long, and as far from grey, blue and red.
const END_LENGTH: f64 = 80.0;
const END_SATURATION: f64 = 1.08;
const BLUE_HUE: f64 = -1.1;
const RED_HUE: f64 = 0.5;
/// The grey in the middle: light, so that the ends are the darker.
const MIDDLE_LENGTH: f64 = 88.0;

/// CIE XYZ of the white of sRGB, D65.
const WHITE: [f64; 3] = [0.9505, 1.0, 1.089];

/// The diverging colour map from blue (−1) over light grey (0) to red (1), perceptually uniform:
/// K. Moreland, "Diverging Color Maps for Scientific Visualization", ISVC 2009, sections 5 and 6.
/// `t` outside −1..1 is clamped, NaN is the middle.
pub fn cool_warm(t: f64) -> Rgb {
    let t = if t.is_nan() { 0.0 } else { t.clamp(-1.0, 1.0) };
    let end_hue = if t < 0.0 { BLUE_HUE } else { RED_HUE };
    let grey_hue = hue_near_grey(end_hue);
    let share = t.abs();
    from_msh(
        MIDDLE_LENGTH + (END_LENGTH - MIDDLE_LENGTH) * share,
        END_SATURATION * share,
        grey_hue + (end_hue - grey_hue) * share,
    )
}

/// The hue at which a branch reaches the grey: turned so that its steps are as uniform as they can
/// be although the lightness grows (AdjustHue in the paper), away from purple.
fn hue_near_grey(end_hue: f64) -> f64 {
    let spin = END_SATURATION * (MIDDLE_LENGTH.powi(2) - END_LENGTH.powi(2)).sqrt()
        / (END_LENGTH * END_SATURATION.sin());
    if end_hue > -FRAC_PI_3 {
        end_hue + spin
    } else {
        end_hue - spin
    }
}

fn from_msh(length: f64, saturation: f64, hue: f64) -> Rgb {
    let chroma = length * saturation.sin();
    from_lab(
        length * saturation.cos(),
        chroma * hue.cos(),
        chroma * hue.sin(),
    )
}

/// CIELAB to sRGB (CIE 15; IEC 61966-2-1), rounded to nearest.
fn from_lab(lightness: f64, a: f64, b: f64) -> Rgb {
    const EDGE: f64 = 6.0 / 29.0;
    let cube = |f: f64| {
        if f > EDGE {
            f.powi(3)
        } else {
            (f - 4.0 / 29.0) * 3.0 * EDGE * EDGE
        }
    };
    let y = (lightness + 16.0) / 116.0;
    let [x, y, z] = [
        WHITE[0] * cube(y + a / 500.0),
        WHITE[1] * cube(y),
        WHITE[2] * cube(y - b / 200.0),
    ];
    let linear = [
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    ];
    linear.map(|v| {
        let encoded = if v > 0.003_130_8 {
            1.055 * v.powf(1.0 / 2.4) - 0.055
        } else {
            12.92 * v
        };
        (encoded.clamp(0.0, 1.0) * 255.0).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The 33 colours that Moreland publishes, blue to red (`CoolWarmUChar33.csv`,
    /// kennethmoreland.com/color-maps).
    const PUBLISHED: [Rgb; 33] = [
        [59, 76, 192],
        [68, 90, 204],
        [77, 104, 215],
        [87, 117, 225],
        [98, 130, 234],
        [108, 142, 241],
        [119, 154, 247],
        [130, 165, 251],
        [141, 176, 254],
        [152, 185, 255],
        [163, 194, 255],
        [174, 201, 253],
        [184, 208, 249],
        [194, 213, 244],
        [204, 217, 238],
        [213, 219, 230],
        [221, 221, 221],
        [229, 216, 209],
        [236, 211, 197],
        [241, 204, 185],
        [245, 196, 173],
        [247, 187, 160],
        [247, 177, 148],
        [247, 166, 135],
        [244, 154, 123],
        [241, 141, 111],
        [236, 127, 99],
        [229, 112, 88],
        [222, 96, 77],
        [213, 80, 66],
        [203, 62, 56],
        [192, 40, 47],
        [180, 4, 38],
    ];

    #[test]
    fn the_published_colours_come_out() {
        for (k, expected) in PUBLISHED.into_iter().enumerate() {
            assert_eq!(cool_warm((k as f64 - 16.0) / 16.0), expected, "{k}");
        }
        // Mixing the ends in sRGB, as a plain gradient does, gives another middle.
        assert_ne!(cool_warm(0.5), [201, 113, 130]);
    }

    #[test]
    fn numbers_outside_are_clamped() {
        for (t, expected) in [
            (-7.0, PUBLISHED[0]),
            (f64::NEG_INFINITY, PUBLISHED[0]),
            (2.0, PUBLISHED[32]),
            (f64::INFINITY, PUBLISHED[32]),
            (f64::NAN, PUBLISHED[16]),
            (-0.0, PUBLISHED[16]),
        ] {
            assert_eq!(cool_warm(t), expected, "{t}");
        }
    }
}
