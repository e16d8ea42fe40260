//! What each way loses and what it costs.

use serde::{Deserialize, Serialize};

use super::neighbours::{Crossings, Rival};
use super::way::{Family, Shown, Way};
use crate::error::Result;
use crate::frame::error::color_error;
use crate::frame::{DEPTH, Frame, KIND, Kind, Layer, VALUE, Wanted};
use crate::lab::bench::protocol::turned;
use crate::lab::bench::{Bench, Dataset, Protocol, display_ms};
use crate::lab::measure::Times;
use crate::render::{RayCaster, Renderer};
use crate::scene::Scene;

/// A depth is wrong where it is further from the whole picture's than this, in voxels of the smallest spacing.
pub const WRONG_DEPTH_VOXELS: f64 = 0.05;

/// One way's figures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WayRow {
    pub family: Family,
    /// Pixels from one ray of the grid to the next.
    pub spacing: Option<u32>,
    /// The error within which pixels are filled.
    pub screen_error: Option<f64>,
    /// The row, by its index, that this one is compared with.
    pub base: usize,
    /// Rays that were cast, as a share of the pixels.
    pub rays_share: f64,
    pub lost: Lost,
    /// The root mean square difference of the colours from the whole picture's, sRGB-encoded, 0..1.
    pub rmse: Option<f64>,
    pub times: Times,
}

impl WayRow {
    pub fn name(&self) -> String {
        match self.setting() {
            Some(setting) => format!("{}, {setting}", self.family.name()),
            None => self.family.name().to_owned(),
        }
    }

    /// What tells it from others of its family.
    pub fn setting(&self) -> Option<String> {
        let spacing = self.spacing.map(|spacing| format!("K = {spacing}"));
        spacing.or_else(|| Some(format!("E = {}", self.screen_error?)))
    }
}

/// What a way's pixels show of that which the whole picture does.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Lost {
    /// Pixels of the picture.
    pub pixels: usize,
    /// Pixels that show a vessel in the whole picture.
    pub hits: usize,
    /// Those of them that do not here.
    pub lost: usize,
    /// Pixels that show a vessel here and not there.
    pub extra: usize,
    /// Of surfaces, pixels that show one in both, at depths that differ by more than [`WRONG_DEPTH_VOXELS`].
    pub displaced: Option<usize>,
}

impl Lost {
    fn share(&self, count: usize) -> Option<f64> {
        (self.hits > 0).then(|| count as f64 / self.hits as f64)
    }

    /// The lost pixels as a share of the hits.
    pub fn lost_share(&self) -> Option<f64> {
        self.share(self.lost)
    }

    /// The extra pixels as a share of the hits.
    pub fn extra_share(&self) -> Option<f64> {
        self.share(self.extra)
    }

    /// The pixels at a wrong depth as a share of the hits.
    pub fn displaced_share(&self) -> Option<f64> {
        self.share(self.displaced?)
    }
}

/// What the pixels of a way show.
struct Seen {
    hit: Vec<bool>,
    /// Of surfaces, mm.
    depth_mm: Option<Vec<f32>>,
    /// The picture, where there is one.
    frame: Option<Frame>,
    rays: u64,
}

impl Seen {
    fn of_frame(frame: Frame, shown: Shown, iso: f64, rays: u64) -> Self {
        let hit = match shown {
            Shown::Surface => frame
                .plane(KIND)
                .unwrap_or_default()
                .iter()
                .map(|&kind| kind != 0)
                .collect(),
            // Where a maximum reaches the surface's value the ray meets the surface.
            Shown::Maximum => {
                let values = frame.plane(VALUE).unwrap_or_default().iter();
                values.map(|&value| f64::from(value) >= iso).collect()
            }
        };
        let depth_mm = match shown {
            Shown::Surface => frame.plane(DEPTH).map(<[f32]>::to_vec),
            Shown::Maximum => None,
        };
        Self {
            hit,
            depth_mm,
            frame: Some(frame),
            rays,
        }
    }

    fn of_rays(found: &Crossings) -> Self {
        let pixels = found.pixels.iter();
        Self {
            hit: pixels
                .clone()
                .map(|one| one.kind != Kind::Nothing)
                .collect(),
            depth_mm: Some(pixels.map(|one| one.t).collect()),
            frame: None,
            rays: found.rays,
        }
    }

    fn lost(&self, whole: &Self, voxel_mm: f64) -> Lost {
        let pairs = || whole.hit.iter().zip(&self.hit);
        let count = |was: bool, is: bool| pairs().filter(|pair| *pair == (&was, &is)).count();
        let displaced = whole.depth_mm.as_ref().zip(self.depth_mm.as_ref());
        let displaced = displaced.map(|(whole, own)| {
            let pairs = whole.iter().zip(own).map(|(a, b)| f64::from((a - b).abs()));
            // A difference of two infinities is none.
            pairs
                .filter(|mm| mm.is_finite() && *mm > WRONG_DEPTH_VOXELS * voxel_mm)
                .count()
        });
        Lost {
            pixels: self.hit.len(),
            hits: whole.hit.iter().filter(|&&hit| hit).count(),
            lost: count(true, false),
            extra: count(false, true),
            displaced,
        }
    }

    fn rmse(&self, whole: &Self) -> Result<Option<f64>> {
        let frames = whole.frame.as_ref().zip(self.frame.as_ref());
        frames
            .map(|(whole, own)| Ok(color_error(whole, own)?.rmse))
            .transpose()
    }
}

/// All that casts.
struct Casters<'a> {
    shown: Shown,
    scene: Scene,
    renderer: Renderer<'a>,
    rival: Rival<'a>,
}

impl Casters<'_> {
    fn scene(&self, way: Way) -> Scene {
        let mut scene = self.scene.clone();
        if let Way::Sparse(sparse) | Way::Within(sparse) = way {
            scene.sparse = Some(sparse);
        }
        scene
    }

    fn seen(&mut self, way: Way) -> Result<Seen> {
        let scene = self.scene(way);
        Ok(match way {
            Way::Whole | Way::Sparse(_) | Way::Within(_) => {
                let wanted = Wanted::DISPLAY.with([Layer::Kind, Layer::Depth, Layer::Value]);
                let rendering = self.renderer.render(&scene, wanted)?;
                let rays = rendering.rays_per_round.iter().sum();
                Seen::of_frame(rendering.frame, self.shown, self.rival.dataset.iso, rays)
            }
            Way::OneByOne => Seen::of_rays(&self.rival.whole(&scene)?),
            Way::FromNeighbours(spacing) => {
                Seen::of_rays(&self.rival.by_neighbours(&scene, spacing)?)
            }
        })
    }

    fn ms(&mut self, way: Way, azimuth_deg: f64) -> Result<f64> {
        let scene = self.scene(way);
        let (center_world, _) = self.renderer.volume().bounding_sphere();
        let there = || turned(&scene, center_world, azimuth_deg);
        Ok(match way {
            Way::Whole | Way::Sparse(_) | Way::Within(_) => {
                display_ms(&mut self.renderer, &scene, azimuth_deg)?
            }
            Way::OneByOne => self.rival.whole(&there())?.ms,
            Way::FromNeighbours(spacing) => self.rival.by_neighbours(&there(), spacing)?.ms,
        })
    }
}

/// Measures all ways of a picture: what they show from the camera's first place, and their times in turn.
///
/// # Errors
/// The device, memory; stopped.
pub fn measure(
    bench: &Bench,
    dataset: &Dataset,
    shown: Shown,
    protocol: Protocol,
) -> Result<Vec<WayRow>> {
    let octree = bench.octree(dataset)?;
    let mut casters = Casters {
        shown,
        scene: shown.scene(dataset, bench.preset.side_px())?,
        renderer: bench.renderer(dataset, &octree)?,
        rival: Rival {
            dataset,
            octree: &octree,
            caster: RayCaster::new(bench.device, bench.options.lanes),
        },
    };
    let ways = Way::all(shown)?;
    let seen: Vec<Seen> = ways
        .iter()
        .map(|&way| casters.seen(way))
        .collect::<Result<_>>()?;
    let one_by_one = ways
        .iter()
        .position(|&way| way == Way::OneByOne)
        .unwrap_or(0);
    let times = bench.times_under(protocol, &ways, |&way, azimuth_deg| {
        casters.ms(way, azimuth_deg)
    })?;
    let voxel_mm = dataset.volume.geometry().smallest_spacing_mm();
    let mut rows = Vec::new();
    for ((way, own), times) in ways.iter().zip(&seen).zip(times) {
        let base = if way.is_one_by_one() { one_by_one } else { 0 };
        rows.push(WayRow {
            family: way.family(),
            spacing: way.spacing(),
            screen_error: way.screen_error(),
            base,
            rays_share: own.rays as f64 / own.hit.len() as f64,
            lost: own.lost(&seen[base], voxel_mm),
            rmse: own.rmse(&seen[base])?,
            times,
        });
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(hit: &[bool], depth_mm: &[f32]) -> Seen {
        Seen {
            hit: hit.to_vec(),
            depth_mm: Some(depth_mm.to_vec()),
            frame: None,
            rays: hit.len() as u64,
        }
    }

    #[test]
    fn lost_extra_and_displaced_pixels_are_counted_each_by_itself() {
        let none = f32::INFINITY;
        let whole = seen(&[true, true, true, false], &[1.0, 2.0, 3.0, none]);
        let own = seen(&[true, false, true, true], &[1.02, none, 3.2, 4.0]);
        let lost = own.lost(&whole, 1.0);
        assert_eq!((lost.hits, lost.lost, lost.extra), (3, 1, 1));
        assert_eq!(lost.displaced, Some(1));
        assert_eq!(lost.lost_share(), Some(1.0 / 3.0));
        // The control: a picture loses nothing of itself.
        let itself = whole.lost(&whole, 1.0);
        assert_eq!(
            (itself.lost, itself.extra, itself.displaced),
            (0, 0, Some(0))
        );
    }
}
