//! What is known of the reference picture without rendering all of it: the device's own surest
//! picture everywhere, the reference's rays at some pixels.
//!
//! A candidate's error is taken against the surest picture, which costs next to nothing; that
//! picture's own, which is small, is what the reference's rays are spent on (a difference or
//! control-variate estimate: Cochran 1977, Sampling Techniques, §7.2; Owen 2013, Monte Carlo theory,
//! §8.9). So few rays give narrow limits:
//! - Of a root mean square and of a share of hits, the mean of the surest picture's correction has
//!   Student's limit over the random tiles. A few pixels may hold most of a mean square, and no tile
//!   one of them: as many as can be there without any on the tiles are taken to be ten times as far
//!   off as the worst on the tiles.
//! - Of a percentile, so has the share of channels that the correction lifts beyond the bound; all
//!   channels may besides be off by what the same percentile of the surest picture's own are.
//! - Of a greatest error no sample proves anything by itself. The candidate's is known against the
//!   surest picture at every pixel; that picture is trusted to be off by no more than ten times what
//!   it is anywhere on the tiles. (With n rays none of which is off further, at most a share of
//!   1 − 0.01^(1/n) of all can be, at 99 % confidence: one in a thousand of 4096.) What the device
//!   itself cannot prove, hits and misses whose [`Certificate`](crate::frame::Certificate) is
//!   undecided, is decided by the reference ray by ray.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::deviation::{Deviation, Figure, Seen};
use super::student::{CONFIDENCE, Mean};
use super::tiles::Tiles;
use crate::error::Result;
use crate::frame::{CERTIFICATE, Certificate, Frame, percentile};
use crate::reference::Tracer;
use crate::scene::Scene;
use crate::volume::Volume;

/// Unseen exceptions are off by so many times what the worst pixel on the tiles is: three and four times
/// were met with (`bench tolerance`; rays that touch a surface, narrow peaks of opacity).
const EXCEPTION: f64 = 10.0;
/// The most undecided pixels at which the reference is cast; more are no rare exceptions.
const MAX_UNDECIDED: usize = 1 << 14;

/// Tiles on which the reference is known, as their pixels.
pub type Sample = Vec<Vec<u32>>;

/// An estimated error, and what it does not exceed with
/// [`CONFIDENCE`](super::CONFIDENCE).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    pub figure: f64,
    pub upper: f64,
}

/// The known part of the reference picture of one scene.
pub struct Evidence<'a> {
    deviation: Deviation,
    scene: &'a Scene,
    tracer: Tracer<'a>,
    surest: Frame,
    known: BTreeMap<u32, Seen>,
    tiles: Tiles,
}

impl<'a> Evidence<'a> {
    /// Takes the device's surest picture of a scene; with its certificate, if it has one.
    ///
    /// # Errors
    /// As [`Tracer::new`].
    pub fn new(
        deviation: Deviation,
        volume: &'a Volume,
        scene: &'a Scene,
        surest: Frame,
        seed: u64,
    ) -> Result<Self> {
        let mut evidence = Self {
            deviation,
            scene,
            tracer: Tracer::new(volume, scene)?,
            surest,
            known: BTreeMap::new(),
            tiles: Tiles::new(scene.size, seed),
        };
        let certificate = evidence.surest.plane(CERTIFICATE).into_iter().flatten();
        let undecided = certificate.zip(0..).filter_map(|(&certificate, pixel)| {
            (certificate == Certificate::Undecided as u32).then_some(pixel)
        });
        let undecided: Vec<u32> = undecided.take(MAX_UNDECIDED).collect();
        evidence.cast(undecided);
        Ok(evidence)
    }

    /// How many of the reference's rays were cast.
    pub fn rays(&self) -> u64 {
        self.known.len() as u64
    }

    /// Casts the reference's rays at pixels.
    pub fn cast(&mut self, pixels: Vec<u32>) {
        let Scene {
            size, camera, tone, ..
        } = self.scene;
        let (width, tracer, known) = (size.width(), &self.tracer, &self.known);
        let seen: Vec<(u32, Seen)> = pixels
            .into_par_iter()
            .filter(|pixel| !known.contains_key(pixel))
            .map(|pixel| {
                let center = |at: u32| f64::from(at) + 0.5;
                let ray = camera.ray(*size, center(pixel % width), center(pixel / width));
                (pixel, Seen::by_reference(&tracer.cast(ray), tone))
            })
            .collect();
        self.known.extend(seen);
    }

    /// Fresh random tiles of about so many pixels in all, with the reference cast in them.
    pub fn draw(&mut self, pixels: usize) -> Sample {
        let sample = self.tiles.draw(pixels);
        self.cast(sample.concat());
        sample
    }

    /// Casts the reference's rays where a picture differs most from the surest one.
    pub fn cast_worst(&mut self, picture: &Frame, count: usize) {
        let unknown = self
            .every_pixel()
            .filter(|(_, reference)| reference.is_none());
        let mut off: Vec<(f64, u32)> = unknown
            .map(|(pixel, _)| (self.off_from_surest(picture, pixel), pixel))
            .filter(|&(off, _)| off > 0.0)
            .collect();
        let count = count.min(off.len());
        if count > 0 {
            // Equal ones in the order of pixels, so that the choice is always the same.
            let order = |a: &(f64, u32), b: &(f64, u32)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
            off.select_nth_unstable_by(count - 1, order);
        }
        self.cast(off[..count].iter().map(|&(_, pixel)| pixel).collect());
    }

    fn off_from_surest(&self, picture: &Frame, pixel: u32) -> f64 {
        let at = pixel as usize;
        let seen = Seen::in_frame(picture, at);
        let channels = (self.deviation).channels(&Seen::in_frame(&self.surest, at), &seen);
        channels.into_iter().fold(0.0, f64::max)
    }

    /// Every pixel, and its reference where it is known.
    fn every_pixel(&self) -> impl Iterator<Item = (u32, Option<&Seen>)> {
        let mut known = self.known.iter().peekable();
        (0..self.scene.size.pixels() as u32).map(move |pixel| {
            let reference = known.next_if(|&(&at, _)| at == pixel);
            (pixel, reference.map(|(_, reference)| reference))
        })
    }

    /// The best that is known of every pixel, and whether it is the reference.
    fn best(&self) -> impl Iterator<Item = (usize, Seen, bool)> {
        self.every_pixel().map(|(pixel, reference)| {
            let pixel = pixel as usize;
            match reference {
                Some(reference) => (pixel, *reference, true),
                None => (pixel, Seen::in_frame(&self.surest, pixel), false),
            }
        })
    }

    /// A picture's error by all that is known, its uncertainty from `sample`.
    pub fn evaluate(&self, picture: &Frame, sample: &Sample) -> Estimate {
        match self.deviation.figure() {
            Figure::RootMean => self.root_mean(picture, sample),
            Figure::ShareOfHits => self.share_of_hits(picture, sample),
            Figure::Percentile99 => self.percentile(picture, sample),
            Figure::Greatest => self.greatest(picture, sample),
        }
    }

    fn root_mean(&self, picture: &Frame, sample: &Sample) -> Estimate {
        let pixels = self.scene.size.pixels() as f64;
        let parts = self.best().map(|(pixel, reference, _)| {
            (self.deviation).part(&reference, &Seen::in_frame(picture, pixel))
        });
        let mean = parts.sum::<f64>() / pixels;
        let (correction, margin) = self.correction(picture, sample);
        let estimate = (mean + correction).max(0.0);
        let (exceptions, _) = self.for_the_unknown(Mean {
            mean: unseen_share(sample) * EXCEPTION * EXCEPTION * self.surest_off(sample),
            margin: 0.0,
        });
        Estimate {
            figure: estimate.sqrt(),
            upper: (estimate + margin + exceptions).sqrt(),
        }
    }

    /// The greatest part of a pixel of the surest picture itself, on the sample.
    fn surest_off(&self, sample: &Sample) -> f64 {
        let parts = sample.iter().flatten().filter_map(|&pixel| {
            let reference = self.known.get(&pixel)?;
            let surest = Seen::in_frame(&self.surest, pixel as usize);
            Some(self.deviation.part(reference, &surest))
        });
        parts.fold(0.0, f64::max)
    }

    /// The expected difference that the unknown pixels' reference makes to the mean of all parts, and
    /// its margin.
    fn correction(&self, picture: &Frame, sample: &Sample) -> (f64, f64) {
        let tiles = self.sums(sample, |pixel, reference, surest| {
            let seen = Seen::in_frame(picture, pixel);
            self.deviation.part(reference, &seen) - self.deviation.part(surest, &seen)
        });
        self.for_the_unknown(Mean::of(&tiles))
    }

    /// A mean per pixel of the sample, as what it does to the mean of all pixels.
    fn for_the_unknown(&self, mean: Mean) -> (f64, f64) {
        let pixels = self.scene.size.pixels();
        let unknown = pixels - self.known.len();
        if unknown == 0 {
            return (0.0, 0.0);
        }
        let share = unknown as f64 / pixels as f64;
        (mean.mean * share, mean.margin * share)
    }

    /// The sum of `of` (pixel, reference, surest) in each tile, and the tile's number of pixels.
    fn sums(&self, sample: &Sample, of: impl Fn(usize, &Seen, &Seen) -> f64) -> Vec<(f64, usize)> {
        let of_pixel = |&pixel: &u32| {
            let reference = self.known.get(&pixel)?;
            let pixel = pixel as usize;
            Some(of(pixel, reference, &Seen::in_frame(&self.surest, pixel)))
        };
        let tiles = sample.iter();
        tiles
            .map(|tile| (tile.iter().filter_map(of_pixel).sum(), tile.len()))
            .collect()
    }

    fn share_of_hits(&self, picture: &Frame, sample: &Sample) -> Estimate {
        let is_off = |reference: &Seen, pixel| {
            self.deviation
                .part(reference, &Seen::in_frame(picture, pixel))
        };
        let (mut off, mut hits) = (0.0, 0.0);
        for (pixel, reference, _) in self.best() {
            off += is_off(&reference, pixel);
            hits += f64::from(reference.is_hit());
        }
        let pixels = self.scene.size.pixels() as f64;
        let sums = self.sums(sample, |pixel, reference, surest| {
            is_off(reference, pixel) - is_off(surest, pixel)
        });
        off += pixels * self.for_the_unknown(Mean::of(&sums)).0;
        let sums = self.sums(sample, |_, reference, surest| {
            f64::from(reference.is_hit()) - f64::from(surest.is_hit())
        });
        hits += pixels * self.for_the_unknown(Mean::of(&sums)).0;
        if hits < 0.5 {
            let figure = if off > 0.0 { f64::INFINITY } else { 0.0 };
            return Estimate {
                figure,
                upper: figure,
            };
        }
        let share = off.max(0.0) / hits;
        // The ratio's own residuals (Cochran 1977, §6.4).
        let sums = self.sums(sample, |pixel, reference, surest| {
            let hit = f64::from(reference.is_hit()) - f64::from(surest.is_hit());
            is_off(reference, pixel) - is_off(surest, pixel) - share * hit
        });
        let (_, margin) = self.for_the_unknown(Mean::of(&sums));
        Estimate {
            figure: share,
            upper: share + margin * pixels / hits,
        }
    }

    fn percentile(&self, picture: &Frame, sample: &Sample) -> Estimate {
        let channels = self.best().flat_map(|(pixel, reference, _)| {
            (self.deviation).channels(&reference, &Seen::in_frame(picture, pixel))
        });
        let mut channels: Vec<f64> = channels.collect();
        let (correction, margin) = self.correction(picture, sample);
        let lifted = (correction + margin).max(0.0);
        Estimate {
            figure: nearest_rank(&mut channels, 0.99),
            upper: nearest_rank(&mut channels, 0.99 + lifted) + self.surest_percentile(sample),
        }
    }

    /// The 99th percentile of the surest picture's own differences, on the sample.
    fn surest_percentile(&self, sample: &Sample) -> f64 {
        let channels = sample.iter().flatten().filter_map(|&pixel| {
            let reference = self.known.get(&pixel)?;
            let surest = Seen::in_frame(&self.surest, pixel as usize);
            Some(self.deviation.channels(reference, &surest))
        });
        let mut channels: Vec<f64> = channels.flatten().collect();
        percentile(&mut channels, 99).unwrap_or(0.0)
    }

    fn greatest(&self, picture: &Frame, sample: &Sample) -> Estimate {
        let (mut where_known, mut elsewhere) = (0.0_f64, None::<f64>);
        for (pixel, reference, is_known) in self.best() {
            let off = self
                .deviation
                .part(&reference, &Seen::in_frame(picture, pixel));
            if is_known {
                where_known = where_known.max(off);
            } else {
                elsewhere = Some(elsewhere.map_or(off, |max| max.max(off)));
            }
        }
        let Some(elsewhere) = elsewhere else {
            return Estimate {
                figure: where_known,
                upper: where_known,
            };
        };
        Estimate {
            figure: where_known.max(elsewhere),
            upper: where_known.max(elsewhere + EXCEPTION * self.surest_off(sample)),
        }
    }
}

/// The share of all pixels that may be exceptions, at [`CONFIDENCE`], where the sample has none.
fn unseen_share(sample: &Sample) -> f64 {
    let pixels: usize = sample.iter().map(Vec::len).sum();
    1.0 - (1.0 - CONFIDENCE).powf(1.0 / pixels.max(1) as f64)
}

/// The smallest entry that the share of entries does not exceed; beyond all for a share above 1.
fn nearest_rank(entries: &mut [f64], share: f64) -> f64 {
    // As ⌈n·99/100⌉ in whole numbers: 0.99 itself is a little more than 99/100.
    let rank = (entries.len() as f64 * share - 1e-6).ceil().max(1.0);
    if rank > entries.len() as f64 {
        return f64::INFINITY;
    }
    *entries
        .select_nth_unstable_by(rank as usize - 1, f64::total_cmp)
        .1
}
