//! What fixed steps lose of thin vessels and of real angiograms, and what exact casting costs.

use serde::{Deserialize, Serialize};

use super::super::borderline::Borderline;
use super::super::ways::axis;
use super::super::{Bench, Conduct, Experiment, Outcome, Specimen};
use crate::error::Result;
use crate::frame::error::{DepthError, ValueError, depth_error, value_error};
use crate::frame::{Frame, Wanted};
use crate::measure::{Times, Tradeoff, front};
use crate::number_text::concise;
use crate::reference;
use crate::render::Renderer;
use crate::report::{Cell, Point, Scatter, Section, Shown, Table};
use crate::scene::{Picture, Refine, SamplingMethod, Scene, StepVoxels};

pub const EXPERIMENT: Experiment = Experiment {
    name: "vessels",
    about: "hits missed, errors and times of fixed steps and of exact casting, on straight vessels of \
            four radii and on the volumes named",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    races: false,
    run,
};

/// Voxels.
const RADII: [f64; 4] = [0.5, 0.75, 1.0, 2.5];
/// In each volume.
const VESSELS: usize = 8;
/// Voxels.
const STEPS: [f64; 4] = [2.0, 1.0, 0.5, 0.25];
const REFINERS: [&str; 5] = [
    "none",
    "bisection:6",
    "regula-falsi:5",
    "illinois:5",
    "newton:3",
];
/// What exact surfaces are held against.
const ISO_RIVAL: Method = Method::Steps(0.5, false);
const ISO_RIVAL_REFINER: &str = "regula-falsi:5";
/// What exact projections are held against.
const MIP_RIVAL: Method = Method::Steps(0.25, false);

/// Where a ray is looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Method {
    /// At steps of so many voxels; with or without a look between them.
    Steps(f64, bool),
    Exact,
}

impl Method {
    /// Fixed steps as in the papers, one step as it is by default, exact.
    fn all() -> Vec<Self> {
        let plain = STEPS.map(|step| Self::Steps(step, false));
        let others = [Self::Steps(0.5, true), Self::Exact];
        plain.into_iter().chain(others).collect()
    }

    fn refiners(self) -> &'static [&'static str] {
        match self {
            Self::Steps(_, false) => &REFINERS,
            Self::Steps(_, true) | Self::Exact => &[ISO_RIVAL_REFINER],
        }
    }

    fn of(self, mut scene: Scene) -> Result<Scene> {
        match self {
            Self::Exact => scene.sampling.method = SamplingMethod::Exact,
            Self::Steps(step_voxels, probe) => {
                scene.sampling.method = SamplingMethod::Fixed;
                scene.sampling.step = StepVoxels::new(step_voxels)?;
                scene.sampling.probe = probe;
            }
        }
        Ok(scene)
    }
}

/// A method and a refiner, which exact casting has none of.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Setting {
    method: Method,
    refiner: &'static str,
}

impl Setting {
    fn all() -> Vec<Self> {
        let of = |method: Method| {
            let refiners = method.refiners().iter();
            refiners.map(move |&refiner| Self { method, refiner })
        };
        Method::all().into_iter().flat_map(of).collect()
    }

    fn name(self) -> String {
        match self.method {
            Method::Exact => "exact".into(),
            Method::Steps(step, probe) => {
                let probe = if probe { ", probe" } else { "" };
                format!("step {step}, {}{probe}", self.refiner)
            }
        }
    }

    fn of(self, scene: Scene) -> Result<Scene> {
        let mut scene = self.method.of(scene)?;
        if let Picture::Surface { refine, .. } = &mut scene.picture {
            *refine = self.refiner.parse::<Refine>()?;
        }
        Ok(scene)
    }
}

/// One volume's figures.
#[derive(Serialize, Deserialize)]
struct Measured {
    /// In the order of [`Setting::all`].
    iso: Vec<(DepthError, Times)>,
    /// In the order of [`Method::all`].
    mip: Vec<(ValueError, Times)>,
    /// Pixels that are not judged, for a hair decides on them: of exact casting, and of all settings
    /// together.
    excused_exact: usize,
    excused: usize,
}

fn run(bench: &Bench) -> Result<Outcome> {
    let vessels = RADII.map(|radius| Specimen::straight_vessels(radius, VESSELS));
    let vessels: Vec<Specimen> = vessels.into_iter().collect::<Result<_>>()?;
    let mut outcome = Outcome::of(Table::new(&COLUMNS));
    outcome.conduct = Conduct::usual(bench);
    let mut costs = Costs::default();
    for specimen in vessels.iter().chain(&bench.specimens) {
        let measured = bench.unit(&specimen.name, || measure(bench, specimen))?;
        let exact = &tabulate(&mut outcome.table, specimen, &measured);
        costs.add(&measured);
        outcome.sections.push(section(specimen, &measured));
        outcome.findings.push(format!(
            "{}: {} rays hit at {}; of exact casting's pixels {} are not judged, of all settings' \
             together {}, for 1e-4 voxel beside the ray the reference itself answers so",
            specimen.name,
            exact.reference_hits,
            concise(specimen.iso),
            measured.excused_exact,
            measured.excused
        ));
        if exact.missed + exact.extra > 0 {
            outcome.failure = Some(format!(
                "{}: exact casting missed {} hits and invented {}",
                specimen.name, exact.missed, exact.extra
            ));
        }
        bench.so_far(&outcome)?;
    }
    outcome.findings.extend(costs.findings());
    outcome.findings.push(bench.timed());
    Ok(outcome)
}

const COLUMNS: [(&str, &str, Shown); 16] = [
    ("volume", "volume", Shown::Short),
    ("method", "method", Shown::Short),
    ("missed_share", "missed hits, %", Shown::Percent(3)),
    ("extra_share", "extra hits, %", Shown::Percent(3)),
    ("depth_p99_voxels", "depth p99, voxels", Shown::Short),
    ("depth_max_voxels", "depth max, voxels", Shown::Short),
    ("iso_min_ms", "iso ms, least", Shown::Fixed(2)),
    ("iso_median_ms", "median", Shown::Fixed(2)),
    ("iso_ratio", "to step 0.5", Shown::Fixed(2)),
    ("mip_mean_share", "mip mean error, %", Shown::Percent(4)),
    ("mip_p99_share", "mip p99, %", Shown::Percent(4)),
    ("mip_min_ms", "mip ms, least", Shown::Fixed(2)),
    ("mip_median_ms", "median", Shown::Fixed(2)),
    ("mip_ratio", "to step 0.25", Shown::Fixed(2)),
    ("missed", "missed", Shown::Fixed(0)),
    ("hits", "of hits", Shown::Fixed(0)),
];

/// Appends a volume's rows; gives the surface's errors of exact casting.
fn tabulate(table: &mut Table, specimen: &Specimen, measured: &Measured) -> DepthError {
    let (settings, methods) = (Setting::all(), Method::all());
    let iso_rival = &measured.iso[iso_rival()].1;
    let mip_rival = &measured.mip[at(&methods, &MIP_RIVAL)].1;
    for (setting, (depth, iso)) in settings.iter().zip(&measured.iso) {
        let (value, mip) = &measured.mip[at(&methods, &setting.method)];
        table.push(vec![
            specimen.name.as_str().into(),
            setting.name().into(),
            depth.missed_share().into(),
            depth.extra_share().into(),
            depth.p99.into(),
            depth.max.into(),
            iso.min_ms().into(),
            iso.median_ms().into(),
            iso.over(iso_rival).into(),
            value.mean.into(),
            value.p99.into(),
            mip.min_ms().into(),
            mip.median_ms().into(),
            mip.over(mip_rival).into(),
            depth.missed.into(),
            Cell::from(depth.reference_hits),
        ]);
    }
    measured.iso[settings.len() - 1].0
}

/// A volume's part of the page: time against what is missed of its surface and of its maxima.
fn section(specimen: &Specimen, measured: &Measured) -> Section {
    let missed = measured.iso.iter().zip(Setting::all());
    let missed = missed.filter_map(|((depth, times), setting)| {
        let share = depth.missed_share()?;
        Some((setting.name(), setting.refiner.to_owned(), times, share))
    });
    let lost = measured.mip.iter().zip(Method::all());
    let lost = lost.filter_map(|((value, times), method)| {
        let setting = Setting {
            method,
            refiner: "unrefined",
        };
        Some((setting.name(), "maximum".to_owned(), times, value.mean?))
    });
    Section {
        title: specimen.name.clone(),
        scatters: vec![
            scatter("Surface: time against hits missed", "missed hits", missed),
            scatter(
                "Maximum: time against error",
                "mean error of the value",
                lost,
            ),
        ],
        ..Section::default()
    }
}

/// Of names, families, times and shares.
fn scatter<'a>(
    title: &str,
    error: &str,
    settings: impl Iterator<Item = (String, String, &'a Times, f64)>,
) -> Scatter {
    let settings: Vec<_> = settings.collect();
    let tradeoff = |(_, _, times, share): &(_, _, &Times, f64)| Tradeoff {
        time: times.median_ms(),
        error: *share,
    };
    let on_front = front(&settings.iter().map(tradeoff).collect::<Vec<_>>());
    let points = settings.into_iter().zip(on_front);
    let points = points.map(|((label, group, times, share), on_front)| Point {
        label,
        group,
        x: times.median_ms(),
        y: 100.0 * share,
        on_front,
        ..Point::default()
    });
    Scatter {
        title: title.into(),
        x: axis("time", "ms"),
        y: axis(error, "%"),
        points: points.collect(),
    }
}

/// Where a method or setting is in its list, all of which hold those that are looked for.
fn at<T: PartialEq>(list: &[T], one: &T) -> usize {
    list.iter().position(|other| other == one).unwrap_or(0)
}

fn iso_rival() -> usize {
    let rival = Setting {
        method: ISO_RIVAL,
        refiner: ISO_RIVAL_REFINER,
    };
    at(&Setting::all(), &rival)
}

fn measure(bench: &Bench, specimen: &Specimen) -> Result<Measured> {
    let octree = bench.octree(specimen)?;
    let mut renderer = bench.renderer(specimen, &octree)?;
    let side_px = bench.effort.side_px();

    let surface = specimen.surface(side_px)?;
    let settings = Setting::all().into_iter();
    let scenes = settings.map(|setting| setting.of(surface.clone()));
    let scenes: Vec<Scene> = scenes.collect::<Result<_>>()?;
    let depth = Wanted {
        depth: true,
        ..Wanted::default()
    };
    let truth = reference::render(&specimen.volume, &surface, depth, bench.progress)?;
    let voxel_mm = specimen.volume.geometry().smallest_spacing_mm();
    let mut borderline = Borderline::new(&specimen.volume, &surface)?;
    let mut excused_exact = 0; // the last setting's
    let depth_errors = errors(&mut renderer, &scenes, depth, |frame| {
        excused_exact = borderline.excuse(&truth, frame);
        depth_error(&truth, frame, voxel_mm)
    })?;
    let iso_times = bench.times(&mut renderer, &scenes)?;

    let projection = specimen.maximum(side_px)?;
    let methods = Method::all().into_iter();
    let scenes = methods.map(|m| m.of(projection.clone()));
    let scenes: Vec<Scene> = scenes.collect::<Result<_>>()?;
    let value = Wanted {
        value: true,
        ..Wanted::default()
    };
    let truth = reference::render(&specimen.volume, &projection, value, bench.progress)?;
    let width = specimen.volume.range().width();
    let value_errors = errors(&mut renderer, &scenes, value, |frame| {
        value_error(&truth, frame, width)
    })?;
    let mip_times = bench.times(&mut renderer, &scenes)?;
    Ok(Measured {
        iso: depth_errors.into_iter().zip(iso_times).collect(),
        mip: value_errors.into_iter().zip(mip_times).collect(),
        excused_exact,
        excused: borderline.count(),
    })
}

fn errors<E>(
    renderer: &mut Renderer,
    scenes: &[Scene],
    wanted: Wanted,
    mut error: impl FnMut(&mut Frame) -> Result<E>,
) -> Result<Vec<E>> {
    let scenes = scenes.iter();
    let errors = scenes.map(|scene| error(&mut renderer.render(scene, wanted)?.frame));
    errors.collect()
}

/// What exact casting costs, as ratios, one a volume.
#[derive(Default)]
struct Costs {
    iso: Vec<f64>,
    probed: Vec<f64>,
    mip: Vec<f64>,
}

impl Costs {
    fn add(&mut self, measured: &Measured) {
        let settings = Setting::all();
        let (last, probed) = (settings.len() - 1, settings.len() - 2);
        let exact = &measured.iso[last].1;
        self.iso.push(exact.over(&measured.iso[iso_rival()].1));
        self.probed.push(exact.over(&measured.iso[probed].1));
        let methods = Method::all();
        let exact = &measured.mip[at(&methods, &Method::Exact)].1;
        let rival = &measured.mip[at(&methods, &MIP_RIVAL)].1;
        self.mip.push(exact.over(rival));
    }

    fn findings(&self) -> [String; 3] {
        let told = |what: &str, rival: &str, ratios: &[f64]| {
            let logs: f64 = ratios.iter().map(|ratio| ratio.ln()).sum();
            let mean = (logs / ratios.len() as f64).exp();
            let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
            let most = ratios.iter().copied().fold(0.0, f64::max);
            format!(
                "exact {what} takes {mean:.2} times as long as {rival} ({least:.2} to {most:.2} by volume)"
            )
        };
        let regula_falsi = format!("step 0.5 with {ISO_RIVAL_REFINER}");
        [
            told("iso", &regula_falsi, &self.iso),
            told("iso", &format!("{regula_falsi} and probe"), &self.probed),
            told("mip", "step 0.25", &self.mip),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_has_every_refiner_and_the_rivals_are_among_them() {
        let names: Vec<String> = Setting::all().into_iter().map(Setting::name).collect();
        assert_eq!(names.len(), STEPS.len() * REFINERS.len() + 2);
        assert_eq!(names[iso_rival()], "step 0.5, regula-falsi:5");
        assert_eq!(names[20], "step 0.5, regula-falsi:5, probe");
        assert_eq!(names[21], "exact");
        assert!(Method::all().contains(&MIP_RIVAL));
        assert!(REFINERS.iter().all(|name| name.parse::<Refine>().is_ok()));
    }
}
