//! Growing the tree: each vessel heads for a set of tips, and branches where it serves them with
//! the least volume of vessel.

use std::ops::Range;

use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::super::PhantomSpec;
use super::centreline::{Span, centreline, free_axes};
use super::targets::{Target, spread, uniform_box};
use super::tree::{MURRAY_EXPONENT, VesselSegment, VesselTree, branching_cosines};
use crate::error::{Error, Result};

/// The thickest root that leaves room for a tree, as a share of the extent.
const MAX_ROOT_SHARE: f64 = 0.125;
/// The finest tip, as a share of the root's radius.
const MIN_TIP_SHARE: f64 = 1e-3;

/// A vessel still to be grown: it starts here, in this direction, toward these targets.
struct Bud {
    start_mm: DVec3,
    direction: DVec3,
    targets: Range<usize>,
    parent: Option<usize>,
    generation: u32,
}

/// Radii of the root and of the finest tips, mm.
fn radii_mm(spec: &PhantomSpec) -> Result<(f64, f64)> {
    let extent_mm = spec.extent_mm();
    let voxel_mm = spec.spacing_mm.min_element();
    let thickest = MAX_ROOT_SHARE * extent_mm;
    let root = spec
        .radius_mm
        .unwrap_or_else(|| (extent_mm / 40.0).max(2.0 * voxel_mm).min(thickest));
    let tip = spec
        .tip_radius_mm
        .unwrap_or_else(|| (0.5 * voxel_mm).clamp(MIN_TIP_SHARE * root, root));
    if root > thickest {
        return Err(Error::usage(format!(
            "a root of {root} mm radius does not fit: at most {thickest} mm in this volume"
        )));
    }
    if tip > root || tip < MIN_TIP_SHARE * root {
        return Err(Error::usage(format!(
            "tips of {tip} mm radius on a root of {root} mm: they must be {MIN_TIP_SHARE} to 1 times the root's"
        )));
    }
    Ok((root, tip))
}

/// The tree of `spec`, the same for the same seed.
pub(in super::super) fn grow(spec: &PhantomSpec) -> Result<VesselTree> {
    let (root_mm, tip_mm) = radii_mm(spec)?;
    let voxel_mm = spec.spacing_mm.min_element();
    let mut random = Pcg64::seed_from_u64(spec.seed);

    // Centrelines keep to this box, so that the vessels' surfaces stay inside the volume.
    let domain_mm = (spec.lengths_mm() - spec.spacing_mm) / 2.0;
    let margin_mm = DVec3::splat(root_mm) + 1.5 * spec.spacing_mm;
    let half_mm = (domain_mm - margin_mm).max(domain_mm * 0.25);

    let total_flow = (root_mm / tip_mm).powf(MURRAY_EXPONENT);
    let mut targets = spread(half_mm, total_flow, &mut random);
    let root = root_bud(spec, half_mm, targets.len(), &mut random);
    let mut grower = Grower {
        tip_mm,
        voxel_mm,
        half_mm,
        buds: vec![root],
        segments: Vec::new(),
    };
    while let Some(bud) = grower.buds.pop() {
        grower.grow(&bud, &mut targets, &mut random);
    }
    Ok(VesselTree {
        dims: spec.dims,
        spacing_mm: spec.spacing_mm.to_array(),
        seed: spec.seed,
        murray_exponent: MURRAY_EXPONENT,
        segments: grower.segments,
    })
}

/// Where the tree begins: it serves all targets.
fn root_bud(spec: &PhantomSpec, half_mm: DVec3, targets: usize, random: &mut Pcg64) -> Bud {
    let up = upward(spec);
    let inlet = (uniform_box(random) * 0.2 * (DVec3::ONE - up) - up) * half_mm;
    Bud {
        start_mm: inlet,
        direction: (up + 0.2 * free_axes(half_mm) * uniform_box(random)).normalize(),
        targets: 0..targets,
        parent: None,
        generation: 0,
    }
}

/// A tree while it grows.
struct Grower {
    tip_mm: f64,
    voxel_mm: f64,
    half_mm: DVec3,
    /// The buds, which have no segment yet.
    buds: Vec<Bud>,
    segments: Vec<VesselSegment>,
}

impl Grower {
    /// Makes a bud's segment, and the buds of the two branches where it forks.
    fn grow(&mut self, bud: &Bud, targets: &mut [Target], random: &mut Pcg64) {
        let served = &mut targets[bud.targets.clone()];
        let radius_mm = self.tip_mm * total(served).cbrt();
        let fork = (served.len() > 1).then(|| Fork::of(bud, served, random));
        let (end_mm, end_direction) = match &fork {
            Some(fork) => (fork.p_mm, Some(fork.direction)),
            None => (served[0].p_mm, None),
        };
        let line = centreline(
            &Span {
                start_mm: bud.start_mm,
                end_mm,
                start_direction: bud.direction,
                end_direction,
                half_mm: self.half_mm,
                step_mm: 1.5 * self.voxel_mm,
            },
            random,
        );
        let id = self.segments.len();
        if let Some(fork) = &fork {
            let first = bud.targets.start;
            let cut = first + fork.cut;
            let shares = [first..cut, cut..bud.targets.end];
            for (share, direction) in shares.into_iter().zip(fork.branches) {
                self.buds.push(Bud {
                    start_mm: end_mm,
                    direction,
                    targets: share,
                    parent: Some(id),
                    generation: bud.generation + 1,
                });
            }
        }
        self.segments.push(VesselSegment {
            id,
            parent: bud.parent,
            generation: bud.generation,
            radius_mm,
            radius_voxels: radius_mm / self.voxel_mm,
            start_mm: bud.start_mm.to_array(),
            end_mm: end_mm.to_array(),
            start_direction: bud.direction.to_array(),
            end_direction: line.end_direction.to_array(),
            points_mm: line.points_mm.iter().map(|p| p.to_array()).collect(),
        });
    }
}

/// The root rises along z, as the arteries of the neck do; along y or x in a flat volume.
fn upward(spec: &PhantomSpec) -> DVec3 {
    let n = spec.dims.array();
    let axis = (0..3).rev().find(|&axis| n[axis] > 1).unwrap_or(2);
    DVec3::AXES[axis]
}

fn total(targets: &[Target]) -> f64 {
    targets.iter().map(|target| target.flow).sum()
}

fn centroid(targets: &[Target]) -> DVec3 {
    let sum: DVec3 = targets.iter().map(|target| target.p_mm * target.flow).sum();
    sum / total(targets)
}

/// A branching: its place, the parent's direction there, the branches' directions, and which
/// targets (the first `cut`) the first branch serves.
struct Fork {
    p_mm: DVec3,
    direction: DVec3,
    branches: [DVec3; 2],
    cut: usize,
}

impl Fork {
    /// Splits the bud's targets (two or more), reordering them.
    fn of(bud: &Bud, served: &mut [Target], random: &mut Pcg64) -> Self {
        let cut = split(bud, served, random);
        let (a, b) = served.split_at(cut);
        // Relative radii are enough: balance knows no unit.
        let [flow_a, flow_b] = [total(a), total(b)];
        let [r0, r1, r2] = [flow_a + flow_b, flow_a, flow_b].map(f64::cbrt);
        let toward = [centroid(a), centroid(b)];
        let p_mm = branching_point(bud.start_mm, toward, [r0, r1, r2]);

        let wish = toward.map(|c| (c - p_mm).normalize_or(bud.direction));
        let direction = (r1 * r1 * wish[0] + r2 * r2 * wish[1]).normalize_or(bud.direction);
        let across = wish[0] - wish[1];
        let across = (across - across.dot(direction) * direction)
            .normalize_or(direction.any_orthonormal_vector());
        let [cos1, cos2] = branching_cosines(r0, r1, r2);
        let side = |cosine: f64| (1.0 - cosine * cosine).max(0.0).sqrt();
        Self {
            p_mm,
            direction,
            branches: [
                cos1 * direction + side(cos1) * across,
                cos2 * direction - side(cos2) * across,
            ],
            cut,
        }
    }
}

/// Cuts the targets in two across the direction in which they spread most, counting their spread
/// along the vessel less, so that branches part sideways. Uneven cuts make trunks with side
/// branches.
fn split(bud: &Bud, served: &mut [Target], random: &mut Pcg64) -> usize {
    const ALONG: f64 = 0.6;
    let centre = centroid(served);
    let ahead = (centre - bud.start_mm).normalize_or(bud.direction);
    let spread = |p: DVec3| {
        let d = p - centre;
        d - (1.0 - ALONG) * d.dot(ahead) * ahead
    };
    // Power iteration on the covariance, from a random start.
    let mut axis = uniform_box(random);
    for _ in 0..12 {
        let turned: DVec3 = served
            .iter()
            .map(|target| spread(target.p_mm))
            .map(|d| d * d.dot(axis))
            .sum();
        axis = turned.normalize_or(DVec3::X);
    }
    let axis = (axis + 0.25 * uniform_box(random)).normalize_or(DVec3::X);
    let key = |target: &Target| spread(target.p_mm).dot(axis);
    served.sort_by(|a, b| key(a).total_cmp(&key(b)));
    let share = 0.2 + 0.3 * random.random::<f64>();
    let share = if random.random() { share } else { 1.0 - share };
    ((share * served.len() as f64).round() as usize).clamp(1, served.len() - 1)
}

/// Where three straight vessels of radii r0, r1, r2 to `start` and to the branches' centroids have
/// the smallest volume: the minimum of Σ r² · distance, by Weiszfeld's iteration. It stays at a distance from
/// the start, since a sharp fan of branches would pull it all the way back.
fn branching_point(start_mm: DVec3, toward: [DVec3; 2], [r0, r1, r2]: [f64; 3]) -> DVec3 {
    const MIN_SHARE: f64 = 0.35;
    let ends = [(start_mm, r0), (toward[0], r1), (toward[1], r2)];
    let mut p = (start_mm + toward[0] + toward[1]) / 3.0;
    let nearest = 1e-6 * (toward[0].distance(start_mm) + toward[1].distance(start_mm));
    for _ in 0..40 {
        let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
        for (end, r) in ends {
            let pull = r * r / p.distance(end).max(nearest).max(f64::MIN_POSITIVE);
            sum += end * pull;
            weight += pull;
        }
        p = sum / weight;
    }
    let middle = (toward[0] * r1 * r1 + toward[1] * r2 * r2) / (r1 * r1 + r2 * r2);
    let min_mm = MIN_SHARE * middle.distance(start_mm);
    if p.distance(start_mm) < min_mm {
        start_mm + (middle - start_mm) * MIN_SHARE
    } else {
        p
    }
}
