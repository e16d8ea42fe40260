//! Colours: linear light inside, sRGB at the edges (IEC 61966-2-1).

/// A colour in linear light, sRGB primaries; 1 is display white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rgb(pub [f64; 3]);

impl Rgb {
    /// Black.
    pub const BLACK: Self = Self([0.0; 3]);
    /// White.
    pub const WHITE: Self = Self([1.0; 3]);

    /// Converts sRGB-encoded channels in 0..1.
    pub fn from_srgb(srgb: [f64; 3]) -> Self {
        Self(srgb.map(linear_from_srgb))
    }

    /// Converts to sRGB-encoded channels.
    pub fn to_srgb(self) -> [f64; 3] {
        self.0.map(srgb_from_linear)
    }
}

/// One channel, sRGB-encoded to linear light.
pub fn linear_from_srgb(v: f64) -> f64 {
    if v <= 0.04045 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    }
}

/// One channel, linear light to sRGB-encoded.
pub fn srgb_from_linear(v: f64) -> f64 {
    if v <= 0.003_130_8 {
        v * 12.92
    } else {
        1.055 * v.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_points_of_the_srgb_curve() {
        assert_eq!(srgb_from_linear(0.0), 0.0);
        assert!((srgb_from_linear(1.0) - 1.0).abs() < 1e-12);
        // Middle grey: sRGB 188/255 is about half the light.
        assert!((linear_from_srgb(188.0 / 255.0) - 0.502_886).abs() < 1e-5);
        for i in 0..=100 {
            let v = f64::from(i) / 100.0;
            assert!((srgb_from_linear(linear_from_srgb(v)) - v).abs() < 1e-6);
        }
    }
}
