//! How much adaptive anti-aliasing may differ from the whole of it.

/// How much a picture with many rays in some pixels differs from one with many in all: found from a few of the pixels that
/// have one ray, picked at random, in which as many are cast as in the others. In iso pixels that are proven to show nothing
/// are exact, and not among them.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct SampleCheck {
    /// The pixels that were checked.
    pub pixels: u64,
    /// The estimate of the root of the mean square of all differences of the picture, of sRGB-encoded channels from 0 to 1.
    pub rmse: f64,
    /// The greatest difference of a channel that was met.
    pub max: f64,
}
