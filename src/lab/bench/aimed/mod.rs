//! The adversarial test: rays aimed at the places where a cast loses surfaces, at small random
//! volumes, every answer checked by the reference.

mod rays;
mod volumes;

use std::fmt;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::extent::ImageSize;
use crate::frame::{Certificate, Kind};
use crate::gpu::Device;
use crate::octree::{Leaf, Octree};
use crate::progress::{Progress, Silent};
use crate::render::{FirstCrossing, IndexRay, RayCaster};
use crate::scene::{
    Camera, Gradient, Lens, Light, Picture, Ray, Refine, Rgb, Sampling, Scene, Tone,
};

use crate::lab::measure::{Answer, HitChecker, HitVerdict};

pub use rays::{Aim, AimedRay, rays};
pub use volumes::{Target, target};

use glam::DVec3;

/// The counts of answers for the rays of one aim.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Tally {
    /// Rays that were cast.
    pub rays: u64,
    /// Rays for which the reference hits something.
    pub hits: u64,
    /// Rays for which the reference hits something and the answer is nothing.
    pub missed: u64,
    /// Rays for which the answer is a hit and the reference hits nothing.
    pub extra: u64,
    /// Hits at another place than the reference's, by more than [`HitChecker::APART_VOXELS`].
    pub displaced: u64,
    /// Other answers that are the reference's of a ray within [`HitChecker::NEAR_VOXELS`].
    pub borderline: u64,
    /// Answers that are not proven.
    pub undecided: u64,
    /// Answers that are proven and yet not the reference's, where the reference is certain.
    pub wrongly_proven: u64,
    /// The greatest distance of answers that agree, in voxels.
    pub max_apart: f64,
}

impl Tally {
    /// The number of wrong answers.
    pub fn wrong(&self) -> u64 {
        self.missed + self.extra + self.displaced + self.wrongly_proven
    }

    fn add(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            hits: self.hits + other.hits,
            missed: self.missed + other.missed,
            extra: self.extra + other.extra,
            displaced: self.displaced + other.displaced,
            borderline: self.borderline + other.borderline,
            undecided: self.undecided + other.undecided,
            wrongly_proven: self.wrongly_proven + other.wrongly_proven,
            max_apart: self.max_apart.max(other.max_apart),
        }
    }
}

/// The tallies of all aims, and the first rays that went wrong.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Report {
    /// One tally per aim, in the order of [`Aim::ALL`].
    pub tallies: [Tally; Aim::ALL.len()],
    /// Details of wrong answers, for finding the fault: target number, ray, answer, verdict.
    pub wrong: Vec<String>,
}

impl Report {
    /// The most rays that are listed.
    const MAX_LISTED: usize = 12;

    /// The tally over all aims.
    pub fn total(&self) -> Tally {
        self.tallies.into_iter().fold(Tally::default(), Tally::add)
    }

    /// Combines this report with that of `later` rays.
    #[must_use]
    pub fn and(mut self, later: Self) -> Self {
        for (of, tally) in self.tallies.iter_mut().zip(later.tallies) {
            *of = of.add(tally);
        }
        let room = Self::MAX_LISTED.saturating_sub(self.wrong.len());
        self.wrong.extend(later.wrong.into_iter().take(room));
        self
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:<12}{:>11}{:>11}{:>8}{:>8}{:>10}{:>11}{:>10}{:>8}{:>10}",
            "aim",
            "rays",
            "hits",
            "missed",
            "extra",
            "displaced",
            "borderline",
            "undecided",
            "false",
            "voxels"
        )?;
        let named = Aim::ALL.into_iter().map(Aim::name).zip(self.tallies);
        for (name, t) in named.chain([("all", self.total())]) {
            writeln!(
                f,
                "{name:<12}{:>11}{:>11}{:>8}{:>8}{:>10}{:>11}{:>10}{:>8}{:>10.1e}",
                t.rays,
                t.hits,
                t.missed,
                t.extra,
                t.displaced,
                t.borderline,
                t.undecided,
                t.wrongly_proven,
                t.max_apart
            )?;
        }
        self.wrong.iter().try_for_each(|line| writeln!(f, "{line}"))
    }
}

/// Rays at one target, before the next is made.
const RAYS_A_TARGET: u64 = 50_000;

/// The targets, by number, at which `count` rays are aimed, and how many at each.
pub fn targets(count: u64) -> impl Iterator<Item = (u64, u64)> {
    let targets = 0..count.div_ceil(RAYS_A_TARGET);
    targets.map(move |n| (n, (count - n * RAYS_A_TARGET).min(RAYS_A_TARGET)))
}

/// Casts `count` rays on the device and checks the answers. Reports a unit of progress a ray.
///
/// # Errors
/// The device fails.
pub fn run(device: &Device, seed: u64, count: u64, progress: &dyn Progress) -> Result<Report> {
    let mut report = Report::default();
    progress.begin("aimed rays", count);
    let mut caster = RayCaster::new(device, None);
    for (number, rays) in targets(count) {
        report = report.and(at_target(&mut caster, seed, number, rays)?);
        progress.advance(rays);
    }
    progress.end();
    Ok(report)
}

/// Casts `count` rays at one target and checks the answers.
///
/// # Errors
/// The device fails.
pub fn at_target(caster: &mut RayCaster, seed: u64, number: u64, count: u64) -> Result<Report> {
    let target = target(seed, number as u32)?;
    let aimed = rays(&target, seed.wrapping_add(number), count as usize);
    Ok(answers(caster, &target, number, &aimed)?.0)
}

/// Casts these rays at a target, which `number` names in the report, and checks the answers: the
/// report, and the device's answer to each.
///
/// # Errors
/// The device fails.
pub fn answers(
    caster: &mut RayCaster,
    target: &Target,
    number: u64,
    aimed: &[AimedRay],
) -> Result<(Report, Vec<FirstCrossing>)> {
    let octree = Octree::build(&target.volume, Leaf::new(4)?, &Silent)?;
    let forward = aimed
        .iter()
        .map(|ray| IndexRay::forward(ray.origin, ray.dir));
    let rays: Vec<IndexRay> = forward.collect();
    let crossings = caster.cast(&target.volume, &octree, target.iso, target.caps, &rays)?;
    let report = check(target, number, aimed, &crossings)?;
    Ok((report, crossings))
}

/// The verdicts on one target's rays.
fn check(
    target: &Target,
    number: u64,
    aimed: &[AimedRay],
    crossings: &[FirstCrossing],
) -> Result<Report> {
    let mut report = Report::default();
    let scene = scene_of(target)?;
    let checker = HitChecker::new(&target.volume, &scene)?;
    let tallies: Vec<(Tally, Option<String>)> = aimed
        .par_iter()
        .zip(crossings)
        .map(|(ray, crossing)| check_one(&checker, number, ray, crossing))
        .collect();
    for (ray, (tally, wrong)) in aimed.iter().zip(tallies) {
        let of = &mut report.tallies[ray.aim as usize];
        *of = of.add(tally);
        if report.wrong.len() < Report::MAX_LISTED {
            report.wrong.extend(wrong);
        }
    }
    Ok(report)
}

fn check_one(
    checker: &HitChecker,
    number: u64,
    aimed: &AimedRay,
    crossing: &FirstCrossing,
) -> (Tally, Option<String>) {
    let ray = Ray {
        origin_world: DVec3::from_array(aimed.origin.map(f64::from)),
        dir_world: DVec3::from_array(aimed.dir.map(f64::from)),
    };
    let answer = Answer {
        kind: crossing.kind,
        depth_mm: f64::from(crossing.t),
    };
    // Rays begin tens of voxels away: so much of a voxel is left of their last digit.
    let resolution = if crossing.t.is_finite() {
        2.0 * f64::from(f32::EPSILON * crossing.t)
    } else {
        0.0
    };
    let reference = checker.reference(ray);
    let verdict = checker.verdict(ray, reference, answer, resolution);
    let proven = match crossing.certificate {
        Certificate::Hit => Some(true),
        Certificate::Miss => Some(false),
        Certificate::Undecided => None,
    };
    let hit = reference.kind != Kind::Nothing;
    let mut tally = Tally {
        rays: 1,
        hits: u64::from(hit),
        undecided: u64::from(proven.is_none()),
        wrongly_proven: u64::from(
            proven.is_some_and(|proven| proven != hit) && checker.is_certain(ray, reference),
        ),
        ..Tally::default()
    };
    match verdict {
        HitVerdict::Agrees { apart } => tally.max_apart = apart,
        HitVerdict::Borderline => tally.borderline = 1,
        HitVerdict::Missed => tally.missed = 1,
        HitVerdict::Extra => tally.extra = 1,
        HitVerdict::Displaced { .. } => tally.displaced = 1,
    }
    let wrong = (tally.wrong() > 0).then(|| {
        format!("target {number}, {aimed:?}: {crossing:?}, {verdict:?}, reference {reference:?}")
    });
    (tally, wrong)
}

/// The scene for the reference; its camera is not used.
fn scene_of(target: &Target) -> Result<Scene> {
    let lens = Lens::Orthographic { height_mm: 1.0 };
    Ok(Scene {
        size: ImageSize::new(1, 1)?,
        camera: Camera::look_at(DVec3::NEG_Y, DVec3::ZERO, DVec3::Z, lens)?,
        picture: Picture::Surface {
            iso: target.iso,
            caps: target.caps,
            refine: Refine::default(),
            color: Rgb::BLACK,
            phong: None,
        },
        clip_planes: Vec::new(),
        sampling: Sampling::default(),
        lights: vec![Light::default()],
        ambient_occlusion: None,
        shadows: None,
        depth_of_field: None,
        depth_cues: None,
        gradient: Gradient::default(),
        anti_aliasing: Default::default(),
        sparse: None,
        tone: Tone::default(),
    })
}
