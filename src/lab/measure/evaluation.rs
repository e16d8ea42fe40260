//! A setting's picture compared with the reference's, and the time of one frame.

use std::time::Instant;

use crate::error::Result;
use crate::frame::error::{Figures, Scale, figures};
use crate::frame::{Frame, Layer, Wanted};
use crate::gpu::PassTime;
use crate::render::{Renderer, Rendering};
use crate::scene::{Picture, Scene};
use crate::volume::Volume;

use super::Counts;
use super::processor::processor_ms;

/// The planes in which a scene's picture can be wrong, and the counters.
///
/// A surface's values are all the iso value, and a maximum's depth hangs on rounding where the field is
/// flat: neither is compared.
pub fn evaluated_planes(scene: &Scene) -> Wanted {
    let surface = matches!(scene.picture, Picture::Surface { .. });
    let projection = matches!(scene.picture, Picture::Projection { .. });
    Wanted::DISPLAY
        .with_if(surface || scene.depth_of_field.is_some(), Layer::Depth)
        .with_if(surface, Layer::Normal)
        .with_if(projection, Layer::Value)
        .with_if(scene.ambient_occlusion.is_some(), Layer::Occlusion)
        .with_if(scene.shadows.is_some(), Layer::Visibility)
        .with_if(scene.depth_of_field.is_some(), Layer::Coc)
        .with(Layer::COUNTERS)
        .with([Layer::Kind])
}

/// The units of a volume's errors.
pub fn error_scale(volume: &Volume) -> Scale {
    Scale {
        smallest_spacing_mm: volume.geometry().smallest_spacing_mm(),
        range_width: volume.range().width(),
    }
}

/// A picture and how wrong it is.
pub struct Evaluation {
    /// The picture, with the times of its passes.
    pub rendering: Rendering,
    /// The errors against the reference.
    pub figures: Figures,
    /// The picture's counters.
    pub counts: Counts,
}

/// Renders `scene` with the planes of `reference`'s picture and compares them.
///
/// # Errors
/// As [`Renderer::render`] and [`figures`].
pub fn evaluate(
    renderer: &mut Renderer,
    scene: &Scene,
    reference: &Frame,
    scale: Scale,
) -> Result<Evaluation> {
    let rendering = renderer.render(scene, evaluated_planes(scene))?;
    Ok(Evaluation {
        figures: figures(reference, &rendering.frame, scale)?,
        counts: Counts::of(
            &rendering.frame,
            &scene.picture,
            rendering.rays_per_round.iter().sum(),
        ),
        rendering,
    })
}

/// How wrong a picture is in some of its pixels, of which `reference` is the reference's
/// ([`reference::render_pixels`](crate::reference::render_pixels)).
///
/// SSIM and FLIP, which need neighbouring pixels, are left out.
///
/// # Errors
/// As [`figures`].
pub fn evaluate_pixels(
    reference: &Frame,
    frame: &Frame,
    pixels: &[u32],
    scale: Scale,
) -> Result<Figures> {
    Ok(Figures {
        ssim: None,
        flip: None,
        ..figures(reference, &frame.picked(pixels)?, scale)?
    })
}

/// The time of one picture for display.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTime {
    /// The time from the camera set to pixels that the host can read, ms on the host's clock.
    pub frame_ms: f64,
    /// The processor time of all threads of the program that drew it; where the device is the processor
    /// itself, drawing included. Unknown on some systems.
    pub processor_ms: Option<f64>,
    /// The time from the first launch to the last one's end, ms on the device's clock.
    pub render_ms: f64,
    /// The time of each pass, ms on the device's clock.
    pub passes: Vec<PassTime>,
}

/// Renders `scene` for display alone; gradients that it needs precomputed are so beforehand, since
/// another setting may have taken their place.
///
/// # Errors
/// As [`Renderer::render`].
pub fn time(renderer: &mut Renderer, scene: &Scene) -> Result<FrameTime> {
    let wanted = Wanted::DISPLAY;
    renderer.precompute(scene, wanted)?;
    let (began, used) = (Instant::now(), processor_ms());
    let rendering = renderer.render(scene, wanted)?;
    Ok(FrameTime {
        frame_ms: began.elapsed().as_secs_f64() * 1e3,
        processor_ms: used.and_then(|used| Some(processor_ms()? - used)),
        render_ms: rendering.render_ms,
        passes: rendering.passes,
    })
}
