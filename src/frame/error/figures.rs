//! All figures of a pair of pictures at once.

use serde::Serialize;

use crate::error::Result;
use crate::frame::{Frame, Key, Layer, OCCLUSION, VISIBILITY};

use super::{
    ColorError, DepthError, FocusError, NormalError, ShareError, ValueError, color_error,
    depth_error, flip, focus_error, normal_error, share_error, ssim, value_error,
};

/// The units that depths and values are measured in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// The volume's smallest voxel spacing.
    pub smallest_spacing_mm: f64,
    /// The volume's largest minus its smallest value.
    pub range_width: f64,
}

/// All error figures of a picture against its reference; each is there if both have the planes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figures {
    /// The error of the displayed colours.
    pub color: Option<ColorError>,
    /// [`ssim()`]; `None` also where the picture is smaller than its window.
    pub ssim: Option<f64>,
    /// [`flip()`]; `None` also where the picture is larger than it takes.
    pub flip: Option<f64>,
    /// The error of the depths, and the missed and extra hits.
    pub depth: Option<DepthError>,
    /// The angle between the normals.
    pub normal: Option<NormalError>,
    /// `None` also where all values of the volume are equal: no share of their range can be said.
    pub value: Option<ValueError>,
    /// The error of what the surface keeps from its hits: with a bias above 0 the picture is too dark.
    pub occlusion: Option<ShareError>,
    /// The error of what reaches the hits of the first light: with a bias above 0 the picture is too bright.
    pub visibility: Option<ShareError>,
    /// The error of the displayed colours in focus, before and behind it and beside what is seen, of pictures through a lens.
    pub focus: Option<FocusError>,
}

/// Compares all planes that both pictures have. Which planes make sense for a picture is the
/// caller's to say, by asking the renderers for those: a projection has depths too.
///
/// # Errors
/// Different sizes; an entry that cannot be compared (those of [`color_error`] and its siblings).
pub fn figures(reference: &Frame, frame: &Frame, scale: Scale) -> Result<Figures> {
    let shown = reference.display.is_some() && frame.display.is_some();
    let both_have = |layer| reference.layers.has(layer) && frame.layers.has(layer);
    let deep = both_have(Layer::Depth);
    let oriented = both_have(Layer::Normal);
    let share = |key: Key<f32>| {
        both_have(key.layer())
            .then(|| share_error(reference, frame, key))
            .transpose()
    };
    let valued = both_have(Layer::Value) && scale.range_width != 0.0;
    Ok(Figures {
        color: shown.then(|| color_error(reference, frame)).transpose()?,
        ssim: shown.then(|| ssim(reference, frame)).transpose()?.flatten(),
        flip: shown.then(|| flip(reference, frame)).transpose()?.flatten(),
        depth: deep
            .then(|| depth_error(reference, frame, scale.smallest_spacing_mm))
            .transpose()?,
        normal: oriented
            .then(|| normal_error(reference, frame))
            .transpose()?,
        value: valued
            .then(|| value_error(reference, frame, scale.range_width))
            .transpose()?,
        occlusion: share(OCCLUSION)?,
        visibility: share(VISIBILITY)?,
        focus: (shown && deep && both_have(Layer::Coc))
            .then(|| focus_error(reference, frame))
            .transpose()?,
    })
}
