//! Certified sparse casting at any length: random pictures of random volumes, each cast sparsely and whole.

use serde::{Deserialize, Serialize};

use super::super::{Bench, Dataset, Experiment, Outcome, Preset, random_scenes, rng::Rng};
use crate::error::{Error, Result};
use crate::extent::Dims;
use crate::frame::{CAST, DEPTH, Frame, KIND, Layer, Wanted};
use crate::lab::report::{Shown, Table};
use crate::octree::{Leaf, Octree};
use crate::render::Renderer;
use crate::scene::{Camera, Lens, Mode, Refill, Scene, ScreenError, Sparse, SparseGrid};
use crate::subject::Subject;
use crate::volume::{PhantomKind, PhantomSpec, Volume, VoxelType, phantom};

pub const EXPERIMENT: Experiment = Experiment {
    name: "sparse-rays",
    about: "pixels of random pictures of random volumes, and of those named, cast sparsely with --refill certified \
            and whole; fails where one is lost or further off than the bound",
    takes_volumes: true,
    counts_rays: true,
    times_frames: false,
    takes_peer: false,
    run,
};

/// The seed of the volumes and the pictures, unless the user chose another.
const SEED: u64 = 4;

/// The depths that certified may be off by, in voxels of the smallest spacing (`--screen-error`), in turn.
const BOUNDS_VOXELS: [f64; 3] = [0.05, 0.3, 1.0];

/// Smooth volumes, in which certified finds something to interpolate, in turn.
const SMOOTH: [PhantomKind; 3] = [
    PhantomKind::Sphere,
    PhantomKind::Blob,
    PhantomKind::MarschnerLobb,
];

/// Width and height of a picture, in pixels: no multiple of a block or a tile.
const SIDE_PX: u32 = 127;

/// Pictures of a volume, before the next is made.
const PICTURES: u64 = 4;

/// The pixels of a unit of work.
const UNIT_PIXELS: u64 = PICTURES * (SIDE_PX * SIDE_PX) as u64;

/// What came of the pixels of one refill.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Tally {
    pixels: u64,
    /// Pixels for which a ray was cast.
    cast: u64,
    /// Pixels that hit in the whole picture.
    hits: u64,
    /// Pixels that hit in the sparse one without a ray.
    interpolated: u64,
    lost: u64,
    extra: u64,
    /// Hits in both, further apart than the bound.
    displaced: u64,
    /// The furthest that hits in both are apart, in voxels.
    max_apart: f64,
}

impl Tally {
    fn wrong(&self) -> u64 {
        self.lost + self.extra + self.displaced
    }

    fn add(&mut self, other: &Self) {
        self.pixels += other.pixels;
        self.cast += other.cast;
        self.hits += other.hits;
        self.interpolated += other.interpolated;
        self.lost += other.lost;
        self.extra += other.extra;
        self.displaced += other.displaced;
        self.max_apart = self.max_apart.max(other.max_apart);
    }

    /// Adds the pixels of a picture.
    fn compare(&mut self, whole: &Frame, sparse: &Frame, bound_voxels: f64, voxel_mm: f64) {
        let kinds = sparse.plane(KIND).unwrap_or_default().iter();
        let cast = kinds.zip(sparse.plane(CAST).unwrap_or_default());
        self.interpolated += cast
            .filter(|&(&kind, &cast)| kind != 0 && cast == 0)
            .count() as u64;
        let plane = |frame: &'_ Frame| -> (Vec<u32>, Vec<f32>) {
            let (kinds, depths) = (frame.plane(KIND), frame.plane(DEPTH));
            (
                kinds.unwrap_or_default().to_vec(),
                depths.unwrap_or_default().to_vec(),
            )
        };
        let (whole, sparse) = (plane(whole), plane(sparse));
        for ((was, is), (a, b)) in whole
            .0
            .iter()
            .zip(&sparse.0)
            .zip(whole.1.iter().zip(&sparse.1))
        {
            let (was, is) = (*was != 0, *is != 0);
            self.pixels += 1;
            self.hits += u64::from(was);
            self.lost += u64::from(was && !is);
            self.extra += u64::from(is && !was);
            if was && is {
                let apart = f64::from((a - b).abs()) / voxel_mm;
                // Both are numbers of single precision.
                let rounding = 4.0 * f64::from(f32::EPSILON * a.abs()) / voxel_mm;
                self.displaced += u64::from(apart.is_nan() || apart > bound_voxels + rounding);
                self.max_apart = self.max_apart.max(apart);
            }
        }
    }
}

/// The tallies of certified and of no refill at all: the control, which loses what lies between its rays.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Tallies {
    certified: Tally,
    unfilled: Tally,
}

impl Tallies {
    fn add(&mut self, other: &Self) {
        self.certified.add(&other.certified);
        self.unfilled.add(&other.unfilled);
    }
}

fn count(bench: &Bench) -> u64 {
    bench.rays.unwrap_or(match bench.preset {
        Preset::Quick => 1_000_000,
        Preset::Usual => 10_000_000,
        Preset::Full => 100_000_000,
    })
}

fn run(bench: &Bench) -> Result<Outcome> {
    let seed = bench.seed.unwrap_or(SEED);
    let mut all = Tallies::default();
    bench.progress.begin("pixels", count(bench));
    for number in 0..count(bench).div_ceil(UNIT_PIXELS) {
        let of_unit = bench.unit(&format!("volume {number}"), || unit(bench, seed, number))?;
        all.add(&of_unit);
        bench.progress.advance(of_unit.certified.pixels);
        bench.so_far(&outcome(&all))?;
    }
    bench.progress.end();
    Ok(outcome(&all))
}

/// The pictures of one volume: a random one, a smooth one, or where some are named one of those, in turn.
fn unit(bench: &Bench, seed: u64, number: u64) -> Result<Tallies> {
    let named = bench.datasets.len() as u64;
    match number % 3 {
        1 => pictures(bench, seed, number, &smooth(seed.wrapping_add(number))?),
        2 if named > 0 => {
            let Dataset { volume, .. } = &bench.datasets[(number / 3 % named) as usize];
            pictures(bench, seed, number, volume)
        }
        _ => {
            let (_, volume) = random_scenes::volume(seed.wrapping_add(number))?;
            pictures(bench, seed, number, &volume)
        }
    }
}

/// A smooth volume of a random size, in single precision.
fn smooth(number: u64) -> Result<Volume> {
    let mut rng = Rng::new(number);
    let kind = SMOOTH[rng.below(SMOOTH.len() as u32) as usize];
    let side = u64::from(24 + rng.below(41));
    let spec = PhantomSpec {
        voxel_type: VoxelType::F32,
        ..PhantomSpec::new(kind, Dims::new([side; 3])?)
    };
    Ok(phantom(&spec)?.volume)
}

fn pictures(bench: &Bench, seed: u64, number: u64, volume: &Volume) -> Result<Tallies> {
    let octree = Octree::build(volume, Leaf::default(), bench.progress)?;
    let mut renderer = Renderer::new(bench.device, volume, &octree, bench.options)?;
    let subject = random_scenes::subject(volume);
    let voxel_mm = volume.geometry().smallest_spacing_mm();
    let wanted = Wanted::NONE.with([Layer::Kind, Layer::Depth, Layer::Cast]);
    let mut tallies = Tallies::default();
    for picture in 0..PICTURES {
        bench.check_stop()?;
        let picture = seed.wrapping_add(number * PICTURES + picture);
        let mut scene = scene(picture, &subject)?;
        if picture.is_multiple_of(2) {
            scene.camera = magnified(&scene.camera)?;
        }
        let whole = renderer.render(&scene, wanted)?.frame;
        let of = [
            (Refill::Certified, &mut tallies.certified),
            (Refill::None, &mut tallies.unfilled),
        ];
        for (refill, tally) in of {
            let bound_voxels = BOUNDS_VOXELS[(picture % BOUNDS_VOXELS.len() as u64) as usize];
            let rule = rule(picture, refill, bound_voxels)?;
            let sparsely = Scene {
                sparse: Some(rule),
                ..scene.clone()
            };
            let sparse = renderer.render(&sparsely, wanted)?;
            tally.cast += sparse.rays_per_round.iter().sum::<u64>();
            tally.compare(&whole, &sparse.frame, bound_voxels, voxel_mm);
        }
    }
    Ok(tallies)
}

/// A random surface from anywhere, by exact casting.
fn scene(number: u64, subject: &Subject) -> Result<Scene> {
    let text = random_scenes::view(number, Mode::Iso, SIDE_PX, subject);
    let resolved = random_scenes::options(&text)?.resolve(subject);
    Ok(resolved
        .map_err(|error| Error::failed(format!("{error}: {text}")))?
        .scene)
}

/// A camera whose pixels are a small part of a voxel: what it sees is smooth.
fn magnified(camera: &Camera) -> Result<Camera> {
    const TIMES: f64 = 8.0;
    let lens = match camera.lens() {
        Lens::Perspective { fov_deg } => Lens::Perspective {
            fov_deg: fov_deg / TIMES,
        },
        Lens::Orthographic { height_mm } => Lens::Orthographic {
            height_mm: height_mm / TIMES,
        },
    };
    let (eye, target) = (camera.eye_world(), camera.target_world());
    Camera::look_at(eye, target, camera.up_given(), lens)
}

fn rule(number: u64, refill: Refill, bound_voxels: f64) -> Result<Sparse> {
    let spacings = SparseGrid::SPACINGS;
    let spacing = spacings[Rng::new(number).below(spacings.len() as u32) as usize];
    let grid = SparseGrid::new(spacing, None)?;
    let is_certified = refill == Refill::Certified;
    let error = is_certified.then(|| ScreenError::new(bound_voxels));
    Sparse::new(Some(grid), Some(refill), error.transpose()?, Mode::Iso)
}

const COLUMNS: [(&str, &str, Shown); 9] = [
    ("refill", "refill", Shown::Short),
    ("pixels", "pixels", Shown::Fixed(0)),
    ("cast_share", "cast, %", Shown::Percent(1)),
    ("hits", "hits", Shown::Fixed(0)),
    ("interpolated", "interpolated", Shown::Fixed(0)),
    ("lost", "lost", Shown::Fixed(0)),
    ("extra", "extra", Shown::Fixed(0)),
    ("displaced", "displaced", Shown::Fixed(0)),
    ("most_apart_voxels", "depth max, voxels", Shown::Short),
];

fn outcome(all: &Tallies) -> Outcome {
    let mut table = Table::new(&COLUMNS);
    for (refill, tally) in [
        (Refill::Certified, &all.certified),
        (Refill::None, &all.unfilled),
    ] {
        let share = tally.cast as f64 / tally.pixels.max(1) as f64;
        table.push(vec![
            refill.name().into(),
            tally.pixels.into(),
            share.into(),
            tally.hits.into(),
            tally.interpolated.into(),
            tally.lost.into(),
            tally.extra.into(),
            tally.displaced.into(),
            tally.max_apart.into(),
        ]);
    }
    let certified = &all.certified;
    let findings = vec![
        format!(
            "certified: {} of {} pixels wrong (lost, extra, or further from the whole picture's depth than 0.05, 0.3 \
             or 1 voxel, the bounds in turn)",
            certified.wrong(),
            certified.pixels
        ),
        "without a refill (the control) pixels between the grid's rays are lost and invented"
            .into(),
    ];
    let failure = if certified.wrong() > 0 {
        let (wrong, pixels) = (certified.wrong(), certified.pixels);
        Some(format!(
            "{wrong} of {pixels} pixels are not the whole picture's"
        ))
    } else if certified.hits > 0 && all.unfilled.lost == 0 {
        Some("no pixel was lost without a refill: nothing was tried".into())
    } else {
        None
    };
    Outcome {
        findings,
        failure,
        ..Outcome::of(table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_fails_and_so_does_a_control_that_is_right() {
        let tally = Tally {
            pixels: 9,
            hits: 4,
            ..Tally::default()
        };
        let all = |lost, control| Tallies {
            certified: Tally { lost, ..tally },
            unfilled: Tally {
                lost: control,
                ..tally
            },
        };
        assert_eq!(outcome(&all(0, 1)).failure, None);
        assert!(outcome(&all(1, 1)).failure.is_some());
        assert!(outcome(&all(0, 0)).failure.is_some());
    }
}
