//! Ways to make a picture, each beside what its paper says of it: what the experiments of the
//! field's papers have in common.

use std::cell::OnceCell;

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::frame::error::{color_error, depth_error, flip, ssim};
use crate::frame::{Frame, Wanted};
use crate::measure::{Counts, Times, Tradeoff, front};
use crate::octree::{Leaf, Octree};
use crate::reference;
use crate::render::Renderer;
use crate::report::{Axis, Cell, Point, Scatter, Section, Shown, Table};
use crate::scene::{Emission, Picture, Refine, Sampling, SamplingMethod, Scene};
use crate::volume::PhantomKind;

use super::borderline::Borderline;
use super::compare::same_picture;
use super::{Bench, Effort, Outcome, Protocol, Specimen, display_ms};

/// A way to make a picture.
pub struct Way {
    pub name: String,
    pub scene: Scene,
    pub leaf: Leaf,
    pub paper: Paper,
    /// The way, by its place in the list, whose picture this one's must be to the last bit.
    pub same_as: Option<usize>,
}

/// What the paper measured, on its machine; the first way's figure is what its ratios are to.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Paper {
    pub fps: Option<f64>,
    /// Where the paper gives no frames per second: how many times as fast as the first way.
    pub speedup: Option<f64>,
}

impl Way {
    pub fn new(name: impl Into<String>, scene: Scene) -> Self {
        Self {
            name: name.into(),
            scene,
            leaf: Leaf::default(),
            paper: Paper::default(),
            same_as: None,
        }
    }

    #[must_use]
    pub fn paper_fps(mut self, fps: Option<f64>) -> Self {
        self.paper.fps = fps;
        self
    }

    #[must_use]
    pub fn same_as(mut self, place: usize) -> Self {
        self.same_as = Some(place);
        self
    }

    /// What is seen, whatever the way in which it is made: what the reference shows.
    fn truth_scene(&self) -> Scene {
        let mut scene = self.scene.clone();
        scene.sampling = Sampling {
            filter: scene.sampling.filter,
            ..Sampling::default()
        };
        match &mut scene.picture {
            Picture::Surface { refine, .. } => *refine = Refine::default(),
            Picture::Emission(medium) => {
                *medium = Emission {
                    phong: medium.phong,
                    ..Emission::of(medium.transfer.clone())
                }
            }
            Picture::Projection { .. } => {}
        }
        scene
    }
}

/// A surface's rays at fixed steps as in the papers: nothing is looked for between two samples.
pub fn plain_steps(scene: &Scene, step_voxels: f64, refine: Refine) -> Scene {
    let mut scene = scene.clone();
    scene.sampling.method = SamplingMethod::Fixed;
    scene.sampling.step_voxels = step_voxels;
    scene.sampling.probe = false;
    if let Picture::Surface { refine: of, .. } = &mut scene.picture {
        *of = refine;
    }
    scene
}

/// The same scene without skipping.
pub fn unskipped(mut scene: Scene) -> Scene {
    scene.sampling.skip = false;
    scene
}

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
        .map(|(way, frame)| Some(same_picture(frame, &frames[way.same_as?])))
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
                let wanted = Wanted {
                    display: true,
                    depth: true,
                    ..Wanted::default()
                };
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

/// Which errors a table shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Errors {
    Surface,
    Light,
}

/// A table of ways beside their papers.
pub fn table(case: &'static str, errors: Errors) -> Table {
    let mut columns = vec![
        ("volume", "volume", Shown::Short),
        ("case", case, Shown::Short),
        ("way", "way", Shown::Short),
        ("min_ms", "ms, least", Shown::Fixed(2)),
        ("median_ms", "median", Shown::Fixed(2)),
        ("p95_ms", "p95", Shown::Fixed(2)),
        ("fps", "fps", Shown::Fixed(1)),
        ("speedup", "ours ×", Shown::Fixed(2)),
        ("paper_fps", "paper fps", Shown::Fixed(2)),
        ("paper_speedup", "paper ×", Shown::Fixed(2)),
    ];
    columns.extend(match errors {
        Errors::Surface => [
            ("missed_share", "missed hits, %", Shown::Percent(3)),
            ("extra_share", "extra hits, %", Shown::Percent(3)),
            ("depth_mean_voxels", "depth mean, voxels", Shown::Short),
            ("depth_p99_voxels", "depth p99", Shown::Short),
            ("depth_max_voxels", "depth max", Shown::Short),
        ]
        .as_slice(),
        Errors::Light => [
            ("rmse", "colour rmse", Shown::Short),
            ("max", "colour max", Shown::Short),
            ("ssim", "ssim", Shown::Fixed(4)),
            ("flip", "flip", Shown::Fixed(4)),
        ]
        .as_slice(),
    });
    columns.extend([
        ("samples_per_ray", "samples a ray", Shown::Fixed(1)),
        ("nodes_per_ray", "nodes a ray", Shown::Fixed(1)),
        ("same_bytes", "same bytes", Shown::Short),
    ]);
    Table::new(&columns)
}

/// How many times as fast as the first of a group each is here, and in the paper.
pub fn speedups(group: &[Found]) -> impl Iterator<Item = (f64, Option<f64>)> {
    group.iter().map(|found| {
        let in_fps = found.paper.fps.zip(group[0].paper.fps);
        let paper = in_fps.map(|(own, first)| own / first);
        (
            group[0].times.over(&found.times),
            paper.or(found.paper.speedup),
        )
    })
}

/// Appends a group's rows; a picture that is not the one that it must be is the outcome's failure.
pub fn tabulate(outcome: &mut Outcome, volume: &str, case: &str, group: &[Found]) {
    for (found, (ours, paper)) in group.iter().zip(speedups(group)) {
        let times = &found.times;
        let mut row: Vec<Cell> = vec![
            volume.into(),
            case.into(),
            found.name.as_str().into(),
            times.min_ms().into(),
            times.median_ms().into(),
            times.p95_ms().into(),
            (1e3 / times.median_ms()).into(),
            ours.into(),
            found.paper.fps.into(),
            paper.into(),
        ];
        if let Some(surface) = &found.surface {
            row.extend([
                surface.missed_share.into(),
                surface.extra_share.into(),
                surface.depth_mean.into(),
                surface.depth_p99.into(),
                surface.depth_max.into(),
            ]);
        }
        if let Some(light) = &found.light {
            row.extend([
                light.rmse.into(),
                light.max.into(),
                light.ssim.into(),
                light.flip.into(),
            ]);
        }
        row.extend([
            found.samples.into(),
            found.nodes.into(),
            Cell::from(found.same.map(|same| if same { "yes" } else { "no" })),
        ]);
        outcome.table.push(row);
        if found.same == Some(false) {
            outcome.failure = Some(format!(
                "{volume}, {case}: '{}' gives another picture",
                found.name
            ));
        }
    }
}

/// A group's part of the page: its ways as time against error.
fn section(volume: &str, case: &str, group: &[Found]) -> Section {
    let error = |found: &Found| match (&found.surface, &found.light) {
        (Some(surface), _) => surface.missed_share.map(|share| 100.0 * share),
        (None, Some(light)) => Some(light.rmse),
        (None, None) => None,
    };
    let judged: Vec<(&Found, f64)> = group
        .iter()
        .filter_map(|found| Some((found, error(found)?)))
        .collect();
    let tradeoffs: Vec<Tradeoff> = judged
        .iter()
        .map(|&(found, error)| Tradeoff {
            time: found.times.median_ms(),
            error,
        })
        .collect();
    let points = judged.iter().zip(&tradeoffs).zip(front(&tradeoffs));
    let points = points.map(|(((found, error), at), on_front)| Point {
        label: found.name.clone(),
        group: case.to_owned(),
        x: at.time,
        y: *error,
        on_front,
        details: vec![("samples a ray".into(), format!("{:.1}", found.samples))],
    });
    let is_surface = group.iter().any(|found| found.surface.is_some());
    let (label, unit) = match is_surface {
        true => ("missed hits", "%"),
        false => ("colour rmse", ""),
    };
    Section {
        title: format!("{volume}, {case}"),
        scatters: vec![Scatter {
            title: format!("time against {label}"),
            x: axis("time", "ms"),
            y: axis(label, unit),
            points: points.collect(),
        }],
        ..Section::default()
    }
}

fn axis(label: &str, unit: &str) -> Axis {
    Axis {
        label: label.into(),
        unit: unit.into(),
    }
}

/// A volume that an experiment looks at: one that the user named, or a phantom, made when it is
/// first needed.
pub struct Subject<'a> {
    pub name: String,
    /// Of the three sizes of a paper's table, the one that this volume stands for.
    pub size: usize,
    named: Option<&'a Specimen>,
    phantom: (PhantomKind, u32),
    made: OnceCell<Specimen>,
}

impl<'a> Subject<'a> {
    /// The user's volumes, which stand for the paper's middle size; without any a phantom in three
    /// sizes.
    pub fn in_three_sizes(bench: &'a Bench, kind: PhantomKind) -> Vec<Self> {
        let sides = match bench.effort {
            Effort::Quick => [32, 64, 96],
            Effort::Usual => [64, 128, 256],
            Effort::Full => [128, 256, 512],
        };
        let phantoms = sides.iter().enumerate();
        let phantoms = phantoms.map(|(size, &side)| Self::phantom(kind, side, size));
        Self::named_or(bench, phantoms.collect())
    }

    /// The user's volumes; without any a phantom.
    pub fn in_one_size(bench: &'a Bench, kind: PhantomKind) -> Vec<Self> {
        let side = match bench.effort {
            Effort::Quick => 64,
            Effort::Usual => 128,
            Effort::Full => 256,
        };
        Self::named_or(bench, vec![Self::phantom(kind, side, 1)])
    }

    fn phantom(kind: PhantomKind, side: u32, size: usize) -> Self {
        Self {
            name: format!("{kind} phantom {side}"),
            size,
            named: None,
            phantom: (kind, side),
            made: OnceCell::new(),
        }
    }

    fn named_or(bench: &'a Bench, phantoms: Vec<Self>) -> Vec<Self> {
        if bench.specimens.is_empty() {
            return phantoms;
        }
        let named = bench.specimens.iter().map(|specimen| Self {
            name: specimen.name.clone(),
            size: 1,
            named: Some(specimen),
            phantom: (PhantomKind::Vessels, 0),
            made: OnceCell::new(),
        });
        named.collect()
    }

    /// # Errors
    /// Not enough memory.
    pub fn specimen(&self) -> Result<&Specimen> {
        if let Some(specimen) = self.named.or(self.made.get()) {
            return Ok(specimen);
        }
        let (kind, side) = self.phantom;
        let specimen = Specimen::sized(kind, side)?;
        Ok(self.made.get_or_init(|| specimen))
    }
}

/// Measures a group as one unit of work, and appends its rows.
///
/// # Errors
/// As [`measure`]; those of `ways`; the disk; stopped.
pub fn run_group(
    bench: &Bench,
    outcome: &mut Outcome,
    subject: &Subject,
    case: &str,
    ways: impl FnOnce(&Specimen) -> Result<Vec<Way>>,
) -> Result<Vec<Found>> {
    let found = bench.unit(&format!("{}/{case}", subject.name), || {
        let specimen = subject.specimen()?;
        measure(bench, bench.protocol(), specimen, &ways(specimen)?)
    })?;
    tabulate(outcome, &subject.name, case, &found);
    outcome.sections.push(section(&subject.name, case, &found));
    bench.so_far(outcome)?;
    Ok(found)
}
