//! What is measured of ways.

use serde::{Deserialize, Serialize};

use crate::bench::borderline::Borderline;
use crate::bench::{Bench, Protocol, Specimen, display_ms};
use crate::error::{Error, Result};
use crate::frame::error::{color_error, depth_error, flip, ssim};
use crate::frame::{Frame, Layer, Wanted};
use crate::measure::{Counts, Times};
use crate::octree::{Leaf, Octree};
use crate::reference;
use crate::render::Renderer;
use crate::scene::{Picture, Scene};

use super::{Paper, Way};

/// What is measured of a way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Found {
    pub name: String,
    pub paper: Paper,
    pub times: Times,
    /// A ray.
    pub samples: f64,
    /// A ray.
    pub nodes: f64,
    /// Whether the picture is that of the way that it must be.
    pub same: Option<bool>,
    pub surface: Option<SurfaceFound>,
    pub light: Option<LightFound>,
}

/// The error of a surface; rays on which a hair decides are not judged.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SurfaceFound {
    pub missed_share: Option<f64>,
    pub extra_share: Option<f64>,
    /// Voxels.
    pub depth_mean: Option<f64>,
    pub depth_p99: Option<f64>,
    pub depth_max: Option<f64>,
}

/// The error of a picture's colours, sRGB-encoded, 0..1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LightFound {
    pub rmse: f64,
    pub max: f64,
    pub ssim: Option<f64>,
    pub flip: Option<f64>,
}

/// Measures every way of a group: its error against the reference, its times in turn with the
/// others'.
///
/// # Errors
/// The device, the reference, memory.
pub fn measure(
    bench: &Bench,
    protocol: Protocol,
    specimen: &Specimen,
    ways: &[Way],
) -> Result<Vec<Found>> {
    let mut leaves: Vec<Leaf> = Vec::new();
    for way in ways {
        if !leaves.contains(&way.leaf) {
            leaves.push(way.leaf);
        }
    }
    let build = |&leaf: &Leaf| Octree::build(&specimen.volume, leaf, bench.progress);
    let octrees: Vec<Octree> = leaves.iter().map(build).collect::<Result<_>>()?;
    check_room(bench, specimen, &octrees)?;
    let renderer = |octree| bench.renderer(specimen, octree);
    let mut renderers: Vec<Renderer> = octrees.iter().map(renderer).collect::<Result<_>>()?;
    // Every leaf is in its list.
    let place = |way: &Way| {
        leaves
            .iter()
            .position(|leaf| *leaf == way.leaf)
            .unwrap_or(0)
    };

    let mut frames = Vec::new();
    for way in ways {
        frames.push(renderers[place(way)].render(&way.scene, Wanted::ALL)?.frame);
    }
    let mut truths = Truths::new(bench, specimen);
    let mut found = Vec::new();
    for (way, frame) in ways.iter().zip(&frames) {
        let (surface, light) = truths.judge(way, frame)?;
        let counts = Counts::of(frame, &way.scene.picture);
        found.push((way, surface, light, counts));
    }
    let same: Vec<Option<bool>> = ways
        .iter()
        .zip(&frames)
        .map(|(way, frame)| Some(frame.shows_the_same(&frames[way.same_as?])))
        .collect();
    drop(frames);
    let times = bench.times_under(protocol, ways, |way, azimuth_deg| {
        display_ms(&mut renderers[place(way)], &way.scene, azimuth_deg)
    })?;
    let found = found.into_iter().zip(times).zip(same);
    Ok(found
        .map(|(((way, surface, light, counts), times), same)| Found {
            name: way.name.clone(),
            paper: way.paper,
            times,
            samples: counts.samples_per_ray(),
            nodes: counts.nodes_per_ray(),
            same,
            surface,
            light,
        })
        .collect())
}

/// All octrees are looked through in turn, each beside a copy of the volume.
///
/// # Errors
/// The device has not the memory for all copies.
fn check_room(bench: &Bench, specimen: &Specimen, octrees: &[Octree]) -> Result<()> {
    let device = bench.device.info();
    let volume_bytes = specimen.volume.voxels().bytes().len() as u64;
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
        specimen.name,
        octrees.len(),
        device.name,
        device.memory_bytes
    ))
    .hint("choose a smaller volume, or another --device"))
}

/// The reference's pictures of one volume, each computed once.
struct Truths<'a> {
    bench: &'a Bench<'a>,
    specimen: &'a Specimen,
    known: Vec<(Scene, Frame)>,
}

impl<'a> Truths<'a> {
    fn new(bench: &'a Bench<'a>, specimen: &'a Specimen) -> Self {
        Self {
            bench,
            specimen,
            known: Vec::new(),
        }
    }

    fn judge(
        &mut self,
        way: &Way,
        frame: &Frame,
    ) -> Result<(Option<SurfaceFound>, Option<LightFound>)> {
        let scene = way.truth_scene();
        let known = self.known.iter().position(|(other, _)| *other == scene);
        let place = match known {
            Some(place) => place,
            None => {
                let wanted = Wanted::DISPLAY.with([Layer::Depth]);
                let volume = &self.specimen.volume;
                let truth = reference::render(volume, &scene, wanted, self.bench.progress)?;
                self.known.push((scene, truth));
                self.known.len() - 1
            }
        };
        let (scene, truth) = &self.known[place];
        if !matches!(scene.picture, Picture::Surface { .. }) {
            let error = color_error(truth, frame)?;
            let light = LightFound {
                rmse: error.rmse,
                max: error.max,
                ssim: ssim(truth, frame)?,
                flip: flip(truth, frame)?,
            };
            return Ok((None, Some(light)));
        }
        let volume = &self.specimen.volume;
        let mut frame = frame.clone();
        Borderline::new(volume, scene)?.excuse(truth, &mut frame);
        let error = depth_error(truth, &frame, volume.geometry().smallest_spacing_mm())?;
        let surface = SurfaceFound {
            missed_share: error.missed_share(),
            extra_share: error.extra_share(),
            depth_mean: error.mean,
            depth_p99: error.p99,
            depth_max: error.max,
        };
        Ok((Some(surface), None))
    }
}
