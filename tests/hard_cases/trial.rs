//! One hard case on trial: its scenes rendered on device and reference and checked, then its mutants.

use angioray::Subject;
use angioray::frame::{DEPTH, Frame, KIND, Kind, NORMAL, VALUE, Wanted};
use angioray::gpu::Device;
use angioray::lab::hardcases::HardCase;
use angioray::lab::measure::{Answer, HitChecker, HitVerdict};
use angioray::octree::{Leaf, Octree};
use angioray::options::SceneOptions;
use angioray::progress::Silent;
use angioray::render::{Options, Renderer};
use angioray::scene::{Picture, Scene, Traverse};
use angioray::volume::Volume;

use crate::common::{self, assert_sound, on_reference};
use crate::limits::{DISPLACED, PROJECTED, WRONG_PIXELS, light};
use crate::mutant::{CAUGHT, Mutant, assert_caught, is_mutant};

/// A scene of a case, to be compared with what is known of it.
pub struct Seen<'a> {
    /// The scene's name.
    pub name: &'a str,
    pub volume: &'a Volume,
    pub scene: &'a Scene,
    /// The device's, or the reference's.
    pub frame: &'a Frame,
}

impl Seen<'_> {
    pub fn kind(&self, pixel: usize) -> u32 {
        self.frame.plane(KIND).unwrap()[pixel]
    }

    pub fn depth_mm(&self, pixel: usize) -> f64 {
        f64::from(self.frame.plane(DEPTH).unwrap()[pixel])
    }

    pub fn alpha(&self, pixel: usize) -> f64 {
        f64::from(self.frame.color[pixel][3])
    }

    pub fn value(&self, pixel: usize) -> f64 {
        f64::from(self.frame.plane(VALUE).unwrap()[pixel])
    }

    pub fn normal(&self, pixel: usize) -> glam::DVec3 {
        glam::DVec3::from_array(self.frame.plane(NORMAL).unwrap()[pixel].map(f64::from))
    }

    pub fn pixels(&self) -> usize {
        self.scene.size.pixels()
    }

    /// The pixel in the middle.
    pub fn middle(&self) -> usize {
        self.pixels() / 2
    }

    /// How many pixels hit; of an emission, are not transparent.
    pub fn hits(&self) -> usize {
        let hit = |pixel: usize| match self.scene.picture {
            Picture::Emission { .. } => self.alpha(pixel) > 0.0,
            _ => self.kind(pixel) != 0,
        };
        (0..self.pixels()).filter(|&pixel| hit(pixel)).count()
    }

    /// The ray of a pixel.
    pub fn ray(&self, pixel: usize) -> angioray::scene::Ray {
        let width = self.scene.size.width() as usize;
        let (x, y) = ((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5);
        self.scene.camera.ray(self.scene.size, x, y)
    }
}

/// Returns a line for each thing that is not as it is known to be.
pub type KnownAnswer = fn(&Seen) -> Vec<String>;

/// A line where `value` is not `expected` to within `limit`.
pub fn near(what: &str, value: f64, expected: f64, limit: f64) -> Vec<String> {
    if (value - expected).abs() <= limit {
        Vec::new()
    } else {
        vec![format!(
            "{what} is {value}, not {expected} within {limit:e}"
        )]
    }
}

/// As [`near`], for things that are so or not.
pub fn is(what: &str, so: bool) -> Vec<String> {
    if so {
        Vec::new()
    } else {
        vec![format!("not so: {what}")]
    }
}

/// Where a change is made on the host.
#[derive(Default)]
struct Change {
    scene: Option<fn(&mut Scene)>,
    volume: Option<fn(&Volume) -> Volume>,
    octree: Option<fn(&Volume) -> Volume>,
}

/// Checks the case `name` and shows that each of its mutants is caught. `test` is the path of the
/// test, for running it again.
pub fn check(test: &str, name: &str, answer: KnownAnswer, mutants: &[Mutant]) {
    let Some(device) = common::device() else {
        return;
    };
    let (case, _) = HardCase::named(name).unwrap();
    let wrong = wrong(&device, case, answer, &Change::default(), true);
    assert!(wrong.is_empty(), "{name}: {CAUGHT}: {}", wrong.join("\n"));
    if is_mutant() {
        return;
    }
    assert!(!mutants.is_empty(), "{name} has no mutant");
    for mutant in mutants {
        let change = match *mutant {
            Mutant::Kernel { file, changes } => {
                assert_caught(test, file, changes);
                continue;
            }
            Mutant::Scene(scene) => Change {
                scene: Some(scene),
                ..Change::default()
            },
            Mutant::Volume(volume) => Change {
                volume: Some(volume),
                ..Change::default()
            },
            // Ray by ray: a ray packet visits the leaves beside it too, and may be saved by them.
            Mutant::Octree(octree) => Change {
                octree: Some(octree),
                scene: Some(|scene| scene.sampling.traverse = Traverse::Uniform),
                ..Change::default()
            },
        };
        let caught = self::wrong(&device, case, answer, &change, false);
        assert!(
            !caught.is_empty(),
            "{name} does not catch a change on the host"
        );
        println!("caught a change on the host: {}", caught[0]);
    }
}

/// What is wrong with the case's pictures.
fn wrong(
    device: &Device,
    case: &HardCase,
    answer: KnownAnswer,
    change: &Change,
    verbose: bool,
) -> Vec<String> {
    let mut wrong = Vec::new();
    for member in 0..case.count() {
        let volume = case.volume(member).unwrap().volume;
        let resolved = resolved(case, &volume);
        let changed = change.volume.map(|change| change(&volume));
        let cast = changed.as_ref().unwrap_or(&volume);
        let ranged = change.octree.map(|change| change(&volume));
        let ranged = ranged.as_ref().unwrap_or(cast);
        let octree = Octree::build(ranged, Leaf::default(), &Silent).unwrap();
        let mut renderer = Renderer::new(device, cast, &octree, Options::default()).unwrap();
        for (scene_name, scene) in &resolved {
            let mut given = scene.clone();
            if let Some(change) = change.scene {
                change(&mut given);
            }
            let frame = renderer.render(&given, Wanted::ALL).unwrap().frame;
            let expected = on_reference(&volume, scene);
            let what = match case.members.get(member) {
                Some(member) => format!("{}.{member} {scene_name}", case.name),
                None => format!("{} {scene_name}", case.name),
            };
            let sound = std::panic::catch_unwind(|| assert_sound(&what, &frame));
            wrong.extend(sound.err().map(|_| format!("{what}: a plane is not sound")));
            let mut lines = apart(&volume, scene, &expected, &frame, &what, verbose);
            for (by, frame) in [("reference", &expected), ("device", &frame)] {
                let seen = Seen {
                    name: scene_name,
                    volume: &volume,
                    scene,
                    frame,
                };
                lines.extend(
                    answer(&seen)
                        .into_iter()
                        .map(|line| format!("{by}: {line}")),
                );
            }
            wrong.extend(lines.into_iter().map(|line| format!("{what}: {line}")));
        }
    }
    wrong
}

/// The case's scenes as `angioray render` resolves them.
pub fn resolved(case: &HardCase, volume: &Volume) -> Vec<(String, Scene)> {
    let subject = Subject::of(volume);
    case.scenes(volume)
        .into_iter()
        .map(|hard| {
            let options = SceneOptions::parse(&hard.toml, &hard.name).unwrap();
            (hard.name, options.resolve(&subject).unwrap().scene)
        })
        .collect()
}

/// Where the device's picture is not the reference's.
fn apart(
    volume: &Volume,
    scene: &Scene,
    expected: &Frame,
    frame: &Frame,
    what: &str,
    verbose: bool,
) -> Vec<String> {
    let mut lines = Vec::new();
    if let Picture::Surface { .. } = scene.picture {
        let verdicts = surface_verdicts(volume, scene, expected, frame);
        if verbose {
            println!("{what}: {verdicts:?}");
        }
        if verdicts.wrong > WRONG_PIXELS {
            lines.push(format!("{verdicts:?}"));
        }
        if verdicts.displaced as f64 > DISPLACED * verdicts.hits as f64 {
            lines.push(format!("{verdicts:?}"));
        }
    }
    let measured = match &scene.picture {
        Picture::Surface { .. } => Vec::new(),
        Picture::Projection { .. } => PROJECTED
            .map(|(figure, limit)| {
                let measured = figure.of(expected, frame, volume);
                (format!("{figure:?}"), measured, limit)
            })
            .to_vec(),
        Picture::Emission(emission) => {
            vec![(
                "light".into(),
                max_light_error(expected, frame),
                light(emission),
            )]
        }
    };
    for (figure, measured, limit) in measured {
        if verbose {
            println!("{what}: {figure} {measured:.2e}");
        }
        if measured > limit {
            lines.push(format!("{figure} {measured:.3e} > {limit:e}"));
        }
    }
    lines
}

/// The largest difference of any channel of premultiplied linear light, and of opacity.
fn max_light_error(expected: &Frame, frame: &Frame) -> f64 {
    let channels = expected.color.iter().flatten();
    let pairs = channels.zip(frame.color.iter().flatten());
    pairs.fold(0.0, |max, (a, b)| {
        let apart = f64::from((a - b).abs());
        if apart.is_nan() {
            f64::INFINITY
        } else {
            apart.max(max)
        }
    })
}

/// Counts of a surface's pixels.
#[derive(Debug, Default)]
struct Verdicts {
    hits: usize,
    /// Missed, extra, or hits of another kind.
    wrong: usize,
    borderline: usize,
    displaced: usize,
    /// Voxels, of those that agree.
    max_apart: f64,
}

fn surface_verdicts(volume: &Volume, scene: &Scene, expected: &Frame, frame: &Frame) -> Verdicts {
    let checker = HitChecker::new(volume, scene).unwrap();
    let depth = frame.plane(DEPTH).unwrap();
    let (kind, kind_expected) = (frame.plane(KIND).unwrap(), expected.plane(KIND).unwrap());
    let mut counts = Verdicts::default();
    for pixel in 0..scene.size.pixels() {
        counts.hits += usize::from(kind_expected[pixel] != 0);
        let seen = Seen {
            name: "",
            volume,
            scene,
            frame,
        };
        let answer = Answer {
            kind: [Kind::Nothing, Kind::Surface, Kind::Cap][kind[pixel] as usize],
            depth_mm: f64::from(depth[pixel]),
        };
        let resolution_mm = if depth[pixel].is_finite() {
            f64::from(depth[pixel].next_up() - depth[pixel])
        } else {
            0.0
        };
        let ray = seen.ray(pixel);
        match checker.verdict(ray, checker.reference(ray), answer, resolution_mm) {
            HitVerdict::Agrees { apart } => counts.max_apart = counts.max_apart.max(apart),
            HitVerdict::Borderline => counts.borderline += 1,
            HitVerdict::Missed | HitVerdict::Extra => counts.wrong += 1,
            HitVerdict::Displaced { apart } if apart.is_infinite() => counts.wrong += 1,
            HitVerdict::Displaced { .. } => counts.displaced += 1,
        }
    }
    counts
}
