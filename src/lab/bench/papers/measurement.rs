//! What is measured of the cases of a group.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::frame::error::{color_error, depth_error, flip, ssim};
use crate::frame::{Frame, Layer, Wanted};
use crate::lab::bench::{Bench, Dataset, Protocol, display_ms};
use crate::lab::measure::{Borderline, Closeness, Counts, Times};
use crate::octree::{Leaf, Octree};
use crate::reference;
use crate::render::Renderer;
use crate::scene::{Picture, Scene};

use super::{Case, Paper};

/// The measurements of one case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    pub name: String,
    pub paper: Paper,
    pub times: Times,
    /// Samples a ray.
    pub samples: f64,
    /// Nodes a ray.
    pub nodes: f64,
    /// Whether the picture equals that of the case that it should equal.
    pub same: Option<bool>,
    pub surface: Option<SurfaceError>,
    pub light: Option<LightError>,
}

/// The error of a surface; rays within rounding of a tangent are left out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SurfaceError {
    pub missed_share: Option<f64>,
    pub extra_share: Option<f64>,
    /// The mean depth error, in voxels.
    pub depth_mean: Option<f64>,
    pub depth_p99: Option<f64>,
    pub depth_max: Option<f64>,
}

/// The error of a picture's colours, sRGB-encoded, 0..1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LightError {
    pub rmse: f64,
    pub max: f64,
    pub ssim: Option<f64>,
    pub flip: Option<f64>,
}

/// Measures every case of a group: its error against the reference, its times in turn with the
/// others'.
///
/// # Errors
/// The device, the reference, memory.
pub fn measure(
    bench: &Bench,
    protocol: Protocol,
    dataset: &Dataset,
    cases: &[Case],
) -> Result<Vec<Measurement>> {
    let mut leaves: Vec<Leaf> = Vec::new();
    for case in cases {
        if !leaves.contains(&case.leaf) {
            leaves.push(case.leaf);
        }
    }
    let build = |&leaf: &Leaf| Octree::build(&dataset.volume, leaf, bench.progress);
    let octrees: Vec<Octree> = leaves.iter().map(build).collect::<Result<_>>()?;
    check_room(bench, dataset, &octrees)?;
    let renderer = |octree| bench.renderer(dataset, octree);
    let mut renderers: Vec<Renderer> = octrees.iter().map(renderer).collect::<Result<_>>()?;
    // Every leaf size is in the list.
    let renderer_of = |case: &Case| {
        leaves
            .iter()
            .position(|leaf| *leaf == case.leaf)
            .unwrap_or(0)
    };

    let mut frames = Vec::new();
    for case in cases {
        frames.push(
            renderers[renderer_of(case)]
                .render(&case.scene, Wanted::ALL)?
                .frame,
        );
    }
    let mut references = References::new(bench, dataset);
    let mut errors = Vec::new();
    for (case, frame) in cases.iter().zip(&frames) {
        let (surface, light) = references.error(case, frame)?;
        let counts = Counts::of(frame, &case.scene.picture, frame.size.pixels() as u64);
        errors.push((case, surface, light, counts));
    }
    let same: Vec<Option<bool>> = cases
        .iter()
        .zip(&frames)
        .map(|(case, frame)| Some(frame.bit_equal(&frames[case.same_as?])))
        .collect();
    drop(frames);
    let times = bench.times_under(protocol, cases, |case, azimuth_deg| {
        display_ms(&mut renderers[renderer_of(case)], &case.scene, azimuth_deg)
    })?;
    let measured = errors.into_iter().zip(times).zip(same);
    Ok(measured
        .map(
            |(((case, surface, light, counts), times), same)| Measurement {
                name: case.name.clone(),
                paper: case.paper,
                times,
                samples: counts.samples_per_ray(),
                nodes: counts.nodes_per_ray(),
                same,
                surface,
                light,
            },
        )
        .collect())
}

/// Checks that the device holds all octrees at a time, each beside a copy of the volume.
///
/// # Errors
/// The device has not the memory for all copies.
fn check_room(bench: &Bench, dataset: &Dataset, octrees: &[Octree]) -> Result<()> {
    let device = bench.device.info();
    let volume_bytes = dataset.volume.voxels().bytes().len() as u64;
    let ranges_bytes = octrees
        .iter()
        .map(|octree| size_of_val(octree.ranges()) as u64);
    let bytes = volume_bytes * octrees.len() as u64 + ranges_bytes.sum::<u64>();
    if bytes <= device.memory_bytes {
        return Ok(());
    }
    Err(Error::failed(format!(
        "{} in {} octrees at a time, a copy of the volume each, needs {bytes} bytes: the device '{}' \
         has {}",
        dataset.name,
        octrees.len(),
        device.name,
        device.memory_bytes
    ))
    .hint("choose a smaller volume, or another --device"))
}

/// The reference's pictures of one volume, each computed once.
struct References<'a> {
    bench: &'a Bench<'a>,
    dataset: &'a Dataset,
    known: Vec<(Scene, Frame)>,
}

impl<'a> References<'a> {
    fn new(bench: &'a Bench<'a>, dataset: &'a Dataset) -> Self {
        Self {
            bench,
            dataset,
            known: Vec::new(),
        }
    }

    /// The error of a case's picture, of its surface or of its colours.
    fn error(
        &mut self,
        case: &Case,
        frame: &Frame,
    ) -> Result<(Option<SurfaceError>, Option<LightError>)> {
        let scene = case.reference_scene();
        let known = self.known.iter().position(|(other, _)| *other == scene);
        let index = match known {
            Some(index) => index,
            None => {
                let wanted = Wanted::DISPLAY.with([Layer::Depth]);
                let volume = &self.dataset.volume;
                let reference = reference::render(volume, &scene, wanted, self.bench.progress)?;
                self.known.push((scene, reference));
                self.known.len() - 1
            }
        };
        let (scene, reference) = &self.known[index];
        if !matches!(scene.picture, Picture::Surface { .. }) {
            let error = color_error(reference, frame)?;
            let light = LightError {
                rmse: error.rmse,
                max: error.max,
                ssim: ssim(reference, frame)?,
                flip: flip(reference, frame)?,
            };
            return Ok((None, Some(light)));
        }
        let volume = &self.dataset.volume;
        let mut frame = frame.clone();
        Borderline::new(volume, scene, Closeness::Jumps)?.excuse(reference, &mut frame);
        let error = depth_error(reference, &frame, volume.geometry().smallest_spacing_mm())?;
        let surface = SurfaceError {
            missed_share: error.missed_share(),
            extra_share: error.extra_share(),
            depth_mean: error.mean,
            depth_p99: error.p99,
            depth_max: error.max,
        };
        Ok((Some(surface), None))
    }
}
