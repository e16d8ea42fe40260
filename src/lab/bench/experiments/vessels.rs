//! What fixed steps lose of thin vessels and of real angiograms, and what exact casting costs.

use serde::{Deserialize, Serialize};

use super::super::papers::axis;
use super::super::{Bench, Conditions, Dataset, Experiment, Outcome};
use crate::error::Result;
use crate::frame::error::{DepthError, ValueError, depth_error, value_error};
use crate::frame::{Frame, Layer, Wanted};
use crate::lab::measure::{Borderline, Closeness, Times, Tradeoff, front};
use crate::lab::report::{Cell, Point, Scatter, Section, Shown, Table};
use crate::number_text::concise;
use crate::reference;
use crate::render::Renderer;
use crate::scene::{Picture, Refine, SamplingMethod, Scene, StepVoxels};

pub const EXPERIMENT: Experiment = Experiment {
    name: "vessels",
    about: "hits missed, errors and times of fixed steps and of exact casting, on straight vessels of \
            four radii and on the volumes named",
    takes_volumes: true,
    counts_rays: false,
    times_frames: true,
    takes_peer: false,
    run,
};

/// The vessels' radii, in voxels.
const RADII: [f64; 4] = [0.5, 0.75, 1.0, 2.5];
/// The number of vessels in each volume.
const VESSELS: usize = 8;
/// The steps, in voxels.
const STEPS: [f64; 4] = [2.0, 1.0, 0.5, 0.25];
const REFINERS: [&str; 5] = [
    "none",
    "bisection:6",
    "regula-falsi:5",
    "illinois:5",
    "newton:3",
];
/// The method that exact surfaces are compared with.
const ISO_BASELINE: Method = Method::Steps(0.5, false);
const ISO_BASELINE_REFINER: &str = "regula-falsi:5";
/// The method that exact projections are compared with.
const MIP_BASELINE: Method = Method::Steps(0.25, false);

/// How a ray is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Method {
    /// Fixed steps of so many voxels; with or without a probe between them.
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
            Self::Steps(_, true) | Self::Exact => &[ISO_BASELINE_REFINER],
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

/// A method and a refiner; exact casting has none.
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
    /// The results for surfaces, in the order of [`Setting::all`].
    iso: Vec<(DepthError, Times)>,
    /// The results for projections, in the order of [`Method::all`].
    mip: Vec<(ValueError, Times)>,
    /// Pixels that are left out, as rounding decides on them: of exact casting, and of all settings
    /// together.
    excused_exact: usize,
    excused: usize,
}

fn run(bench: &Bench) -> Result<Outcome> {
    let vessels = RADII.map(|radius| Dataset::straight_vessels(radius, VESSELS));
    let vessels: Vec<Dataset> = vessels.into_iter().collect::<Result<_>>()?;
    let mut outcome = Outcome::of(Table::new(&COLUMNS));
    outcome.conditions = Conditions::usual(bench);
    let mut costs = Costs::default();
    for dataset in vessels.iter().chain(&bench.datasets) {
        let measured = bench.unit(&dataset.name, || measure(bench, dataset))?;
        let exact = &tabulate(&mut outcome.table, dataset, &measured);
        costs.add(&measured);
        outcome.sections.push(section(dataset, &measured));
        outcome.findings.push(format!(
            "{}: {} rays hit at {}; of exact casting's pixels {} are left out, of all settings' \
             together {}, since 1e-4 voxel beside the ray the reference itself answers so",
            dataset.name,
            exact.reference_hits,
            concise(dataset.iso),
            measured.excused_exact,
            measured.excused
        ));
        if exact.missed + exact.extra > 0 {
            outcome.failure = Some(format!(
                "{}: exact casting missed {} hits and invented {}",
                dataset.name, exact.missed, exact.extra
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
    ("iso_min_ms", "iso ms, min", Shown::Fixed(2)),
    ("iso_median_ms", "median", Shown::Fixed(2)),
    ("iso_ratio", "to step 0.5", Shown::Fixed(2)),
    ("mip_mean_share", "mip mean error, %", Shown::Percent(4)),
    ("mip_p99_share", "mip p99, %", Shown::Percent(4)),
    ("mip_min_ms", "mip ms, min", Shown::Fixed(2)),
    ("mip_median_ms", "median", Shown::Fixed(2)),
    ("mip_ratio", "to step 0.25", Shown::Fixed(2)),
    ("missed", "missed", Shown::Fixed(0)),
    ("hits", "of hits", Shown::Fixed(0)),
];

/// Appends a volume's rows; returns the surface's errors of exact casting.
fn tabulate(table: &mut Table, dataset: &Dataset, measured: &Measured) -> DepthError {
    let (settings, methods) = (Setting::all(), Method::all());
    let iso_baseline = &measured.iso[iso_baseline()].1;
    let mip_baseline = &measured.mip[index_of(&methods, &MIP_BASELINE)].1;
    for (setting, (depth, iso)) in settings.iter().zip(&measured.iso) {
        let (value, mip) = &measured.mip[index_of(&methods, &setting.method)];
        table.push(vec![
            dataset.name.as_str().into(),
            setting.name().into(),
            depth.missed_share().into(),
            depth.extra_share().into(),
            depth.p99.into(),
            depth.max.into(),
            iso.min_ms().into(),
            iso.median_ms().into(),
            iso.over(iso_baseline).into(),
            value.mean.into(),
            value.p99.into(),
            mip.min_ms().into(),
            mip.median_ms().into(),
            mip.over(mip_baseline).into(),
            depth.missed.into(),
            Cell::from(depth.reference_hits),
        ]);
    }
    measured.iso[settings.len() - 1].0
}

/// A volume's part of the page: time against what is missed of its surface and of its maxima.
fn section(dataset: &Dataset, measured: &Measured) -> Section {
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
        title: dataset.name.clone(),
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

/// A plot of names, groups, times and shares.
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

/// The index of a method or setting in its list, which holds it.
fn index_of<T: PartialEq>(list: &[T], one: &T) -> usize {
    list.iter().position(|other| other == one).unwrap_or(0)
}

fn iso_baseline() -> usize {
    let baseline = Setting {
        method: ISO_BASELINE,
        refiner: ISO_BASELINE_REFINER,
    };
    index_of(&Setting::all(), &baseline)
}

fn measure(bench: &Bench, dataset: &Dataset) -> Result<Measured> {
    let octree = bench.octree(dataset)?;
    let mut renderer = bench.renderer(dataset, &octree)?;
    let side_px = bench.preset.side_px();

    let surface = dataset.surface(side_px)?;
    let settings = Setting::all().into_iter();
    let scenes = settings.map(|setting| setting.of(surface.clone()));
    let scenes: Vec<Scene> = scenes.collect::<Result<_>>()?;
    let depth = Wanted::NONE.with([Layer::Depth]);
    let reference = reference::render(&dataset.volume, &surface, depth, bench.progress)?;
    let voxel_mm = dataset.volume.geometry().smallest_spacing_mm();
    let mut borderline = Borderline::new(&dataset.volume, &surface, Closeness::Jumps)?;
    let mut excused_exact = 0; // the last setting's
    let depth_errors = errors(&mut renderer, &scenes, depth, |frame| {
        excused_exact = borderline.excuse(&reference, frame);
        depth_error(&reference, frame, voxel_mm)
    })?;
    let iso_times = bench.times(&mut renderer, &scenes)?;

    let projection = dataset.maximum(side_px)?;
    let methods = Method::all().into_iter();
    let scenes = methods.map(|m| m.of(projection.clone()));
    let scenes: Vec<Scene> = scenes.collect::<Result<_>>()?;
    let value = Wanted::NONE.with([Layer::Value]);
    let reference = reference::render(&dataset.volume, &projection, value, bench.progress)?;
    let width = dataset.volume.range().width();
    let value_errors = errors(&mut renderer, &scenes, value, |frame| {
        value_error(&reference, frame, width)
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

/// The cost of exact casting, as ratios, one for each volume.
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
        self.iso.push(exact.over(&measured.iso[iso_baseline()].1));
        self.probed.push(exact.over(&measured.iso[probed].1));
        let methods = Method::all();
        let exact = &measured.mip[index_of(&methods, &Method::Exact)].1;
        let baseline = &measured.mip[index_of(&methods, &MIP_BASELINE)].1;
        self.mip.push(exact.over(baseline));
    }

    fn findings(&self) -> [String; 3] {
        let sentence = |what: &str, baseline: &str, ratios: &[f64]| {
            let logs: f64 = ratios.iter().map(|ratio| ratio.ln()).sum();
            let mean = (logs / ratios.len() as f64).exp();
            let min = ratios.iter().copied().fold(f64::INFINITY, f64::min);
            let max = ratios.iter().copied().fold(0.0, f64::max);
            format!(
                "exact {what} takes {mean:.2} times as long as {baseline} ({min:.2} to {max:.2} by volume)"
            )
        };
        let regula_falsi = format!("step 0.5 with {ISO_BASELINE_REFINER}");
        [
            sentence("iso", &regula_falsi, &self.iso),
            sentence("iso", &format!("{regula_falsi} and probe"), &self.probed),
            sentence("mip", "step 0.25", &self.mip),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_has_every_refiner_and_the_baselines_are_among_them() {
        let names: Vec<String> = Setting::all().into_iter().map(Setting::name).collect();
        assert_eq!(names.len(), STEPS.len() * REFINERS.len() + 2);
        assert_eq!(names[iso_baseline()], "step 0.5, regula-falsi:5");
        assert_eq!(names[20], "step 0.5, regula-falsi:5, probe");
        assert_eq!(names[21], "exact");
        assert!(Method::all().contains(&MIP_BASELINE));
        assert!(REFINERS.iter().all(|name| name.parse::<Refine>().is_ok()));
    }
}
