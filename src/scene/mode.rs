//! The kinds of pictures.

/// The kind of a picture (`--mode`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// A surface, where the field crosses a value.
    #[default]
    Iso,
    /// The maximum along each ray.
    Mip,
    /// The first local maximum along each ray that reaches a threshold.
    Lmip,
    /// The minimum along each ray.
    Minip,
    /// The mean along each ray.
    Mean,
    /// Emission and absorption under a transfer function.
    Dvr,
}

impl Mode {
    /// All of them, in the order in which help and tables name them.
    pub const ALL: [Self; 6] = [
        Self::Iso,
        Self::Mip,
        Self::Lmip,
        Self::Minip,
        Self::Mean,
        Self::Dvr,
    ];

    /// Returns whether pictures of the mode can be lit: a projection has no surface to light.
    pub const fn is_lit(self) -> bool {
        matches!(self, Self::Iso | Self::Dvr)
    }
}
