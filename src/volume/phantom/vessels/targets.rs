//! Where the tips shall end, and how much blood each takes.

use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64;

/// A tip's place, mm from the volume's centre, and its share of the flow, in flows of the finest
/// tip. By Murray's law a vessel's radius is the cube root of the flow it carries.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target {
    /// The tip's place, mm from the volume's centre.
    pub p_mm: DVec3,
    /// The flow that the tip takes, in flows of the finest tip.
    pub flow: f64,
}

/// More tips make a thicket, not an angiogram; coarser tips take what is left of the flow.
const MAX_TIPS: f64 = 1024.0;

/// Tips spread evenly over a rounded box of half edges `half_mm`, their flows adding up to
/// `total_flow` (at least 1), the smallest exactly 1 (where there are two tips or more).
pub(super) fn spread(half_mm: DVec3, total_flow: f64, random: &mut Pcg64) -> Vec<Target> {
    let count = total_flow.clamp(1.0, MAX_TIPS).floor() as usize;
    // Cubed, so that most tips are fine and a few carry most of the flow.
    let mut excess: Vec<f64> = (0..count).map(|_| random.random::<f64>().powi(3)).collect();
    excess[0] = if count == 1 { 1.0 } else { 0.0 };
    let scale = (total_flow - count as f64).max(0.0) / excess.iter().sum::<f64>();
    let mut targets: Vec<Target> = Vec::with_capacity(count);
    for excess in excess {
        targets.push(Target {
            p_mm: farthest(half_mm, &targets, random),
            flow: 1.0 + scale * excess,
        });
    }
    targets
}

/// The best of a few candidates: the one farthest from all others (D. Mitchell, "Spectrally
/// optimal sampling for distribution ray tracing", SIGGRAPH 1991).
fn farthest(half_mm: DVec3, others: &[Target], random: &mut Pcg64) -> DVec3 {
    const CANDIDATES: usize = 10;
    let mut best = (DVec3::ZERO, f64::NEG_INFINITY);
    for _ in 0..CANDIDATES {
        let p_mm = in_rounded_box(random) * half_mm;
        let nearest = others
            .iter()
            .map(|other| other.p_mm.distance_squared(p_mm))
            .fold(f64::INFINITY, f64::min);
        if nearest > best.1 {
            best = (p_mm, nearest);
        }
    }
    best.0
}

/// Uniform in x⁴ + y⁴ + z⁴ ≤ 1.
fn in_rounded_box(random: &mut Pcg64) -> DVec3 {
    // Half the box is inside, so that a hundred failures in a row do not happen.
    for _ in 0..100 {
        let p = uniform_box(random);
        let square = p * p;
        if square.length_squared() <= 1.0 {
            return p;
        }
    }
    DVec3::ZERO
}

/// A uniformly distributed point in [-1, 1]³.
pub(super) fn uniform_box(random: &mut Pcg64) -> DVec3 {
    let mut side = || random.random::<f64>() * 2.0 - 1.0;
    let (x, y, z) = (side(), side(), side());
    DVec3::new(x, y, z)
}
