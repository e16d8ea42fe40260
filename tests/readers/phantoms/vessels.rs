//! The vessel tree against Murray's laws, and its voxels against the tubes it lists.

use angioray::volume::{
    Phantom, PhantomKind, PhantomSpec, VesselSegment, VesselTree, VoxelType, phantom,
};
use glam::DVec3;

use super::{spec, stored, trilinear};

fn vessels(n: u64, seed: u64) -> (PhantomSpec, Phantom) {
    let mut spec = spec(PhantomKind::Vessels, [n; 3]);
    spec.voxel_type = VoxelType::F32;
    spec.seed = seed;
    let made = phantom(&spec).unwrap();
    (spec, made)
}

fn tree(n: u64, seed: u64) -> VesselTree {
    vessels(n, seed).1.tree.unwrap()
}

fn branches(tree: &VesselTree, parent: usize) -> Vec<&VesselSegment> {
    let of_parent = |s: &&VesselSegment| s.parent == Some(parent);
    tree.segments.iter().filter(of_parent).collect()
}

/// Largest relative misfit of r0³ = r1³ + r2³, and of r0² t0 = r1² t1 + r2² t2, over the tree's
/// branchings.
fn murray_misfits(tree: &VesselTree) -> [f64; 2] {
    let mut worst: [f64; 2] = [0.0; 2];
    for parent in &tree.segments {
        let branches = branches(tree, parent.id);
        if branches.is_empty() {
            continue;
        }
        let cubes: f64 = branches.iter().map(|s| s.radius_mm.powi(3)).sum();
        let pulls: DVec3 = branches
            .iter()
            .map(|s| s.radius_mm.powi(2) * DVec3::from_array(s.start_direction))
            .sum();
        let r0 = parent.radius_mm;
        let balance = pulls - r0 * r0 * DVec3::from_array(parent.end_direction);
        worst[0] = worst[0].max((cubes / r0.powi(3) - 1.0).abs());
        worst[1] = worst[1].max(balance.length() / (r0 * r0));
    }
    worst
}

#[test]
fn branchings_obey_murrays_laws() {
    for seed in 1..6 {
        let mut tree = tree(96, seed);
        let [cubes, balance] = murray_misfits(&tree);
        assert!(cubes <= 1e-9 && balance <= 1e-9, "{cubes} {balance}");
        // Mutants: one vessel a millionth too wide, one turned by a thousandth.
        let last = tree.segments.len() - 1;
        tree.segments[last].radius_mm *= 1.0 + 1e-6;
        assert!(murray_misfits(&tree)[0] > 1e-9);
        tree.segments[last].start_direction[0] += 1e-3;
        assert!(murray_misfits(&tree)[1] > 1e-6);
    }
}

/// What of the tree's structure does not hold.
fn structural_fault(tree: &VesselTree) -> Option<String> {
    for (place, s) in tree.segments.iter().enumerate() {
        let points = &s.points_mm;
        if s.id != place {
            return Some(format!("segment {place} is called {}", s.id));
        }
        if points.first() != Some(&s.start_mm) || points.last() != Some(&s.end_mm) {
            return Some(format!("{place}: the centreline does not join its ends"));
        }
        match s.parent {
            None if place != 0 || s.generation != 0 => return Some(format!("{place}: an orphan")),
            None => {}
            Some(parent) => {
                let parent = &tree.segments[parent];
                if parent.id >= place || s.generation != parent.generation + 1 {
                    return Some(format!("{place}: out of order"));
                }
                if s.start_mm != parent.end_mm {
                    return Some(format!("{place}: does not start where its parent ends"));
                }
            }
        }
        if ![0, 2].contains(&branches(tree, place).len()) {
            return Some(format!("{place}: not a bifurcation"));
        }
        for direction in [s.start_direction, s.end_direction] {
            if (DVec3::from_array(direction).length() - 1.0).abs() > 1e-9 {
                return Some(format!("{place}: a direction is not a unit vector"));
            }
        }
    }
    None
}

#[test]
fn vessels_hang_together() {
    let mut tree = tree(96, 4);
    assert_eq!(structural_fault(&tree), None);
    assert!(tree.segments.len() > 100);
    tree.segments[17].start_mm[1] += 1e-12;
    assert!(structural_fault(&tree).is_some());
}

#[test]
fn centrelines_leave_and_arrive_along_their_tangents() {
    // The first and last pieces are chords of a smooth curve; theirs are the tangents' directions
    // but for the curve's bend over half a piece.
    let tree = tree(192, 2);
    let mut angles: Vec<f64> = tree
        .segments
        .iter()
        .flat_map(|s| {
            let p: Vec<DVec3> = s.points_mm.iter().map(|&p| DVec3::from_array(p)).collect();
            let n = p.len();
            let angle = |chord: DVec3, d| chord.angle_between(DVec3::from_array(d)).to_degrees();
            [
                angle(p[1] - p[0], s.start_direction),
                angle(p[n - 1] - p[n - 2], s.end_direction),
            ]
        })
        .collect();
    angles.sort_by(f64::total_cmp);
    let median = angles[angles.len() / 2];
    assert!(median < 15.0, "{median} degrees");
    // Against the other end's tangent, that does not hold.
    let across = tree.segments.iter().map(|s| {
        DVec3::from_array(s.start_direction)
            .angle_between(DVec3::from_array(s.end_direction))
            .to_degrees()
    });
    assert!(across.fold(0.0, f64::max) > 60.0);
}

#[test]
fn radii_run_from_a_few_voxels_to_half_a_voxel() {
    for (n, root) in [(32, 2.0), (128, 3.2), (256, 6.4)] {
        let tree = tree(n, 1);
        let radii: Vec<f64> = tree.segments.iter().map(|s| s.radius_voxels).collect();
        let finest = radii.iter().copied().fold(f64::INFINITY, f64::min);
        assert!((radii[0] - root).abs() < 1e-9, "{} at {n}", radii[0]);
        assert!((finest - 0.5).abs() < 1e-9, "{finest} at {n}");
        assert!(tree.segments.len() > 60);
    }
    let mut coarse = spec(PhantomKind::Vessels, [64; 3]);
    coarse.spacing_mm = DVec3::new(0.5, 0.5, 2.0);
    coarse.radius_mm = Some(1.5);
    coarse.tip_radius_mm = Some(0.4);
    let tree = phantom(&coarse).unwrap().tree.unwrap();
    assert_eq!(tree.segments[0].radius_mm, 1.5);
    assert_eq!(tree.segments[0].radius_voxels, 3.0);
    let finest = tree
        .segments
        .iter()
        .map(|s| s.radius_mm)
        .fold(9.0, f64::min);
    assert!((finest - 0.4).abs() < 1e-9);
}

/// The smallest distance of a vessel's wall from the volume's faces, in voxels.
fn clearance(tree: &VesselTree, n: f64) -> f64 {
    let wall = |s: &VesselSegment| {
        let extent = s
            .points_mm
            .iter()
            .flatten()
            .fold(0.0, |m: f64, x| m.max(x.abs()));
        (n - 1.0) / 2.0 - extent - s.radius_mm
    };
    tree.segments.iter().map(wall).fold(f64::INFINITY, f64::min)
}

#[test]
fn vessels_fill_the_volume_and_stay_inside() {
    for seed in 1..6 {
        let tree = tree(128, seed);
        assert!(clearance(&tree, 128.0) >= 1.0);
        assert!(clearance(&tree, 100.0) < 1.0);
        // Every one of 4³ blocks away from the corners has a vessel; a tree cut short has not.
        let filled = |tree: &VesselTree| {
            let mut blocks = std::collections::HashSet::new();
            for p in tree.segments.iter().flat_map(|s| &s.points_mm) {
                blocks.insert(p.map(|x| ((x + 64.0) / 32.0) as u8));
            }
            blocks.len()
        };
        assert!(filled(&tree) >= 56, "{} of 64 blocks", filled(&tree));
        let mut cut = tree.clone();
        cut.segments.truncate(60);
        assert!(filled(&cut) < 56);
    }
}

#[test]
fn a_flat_volume_has_its_tree_in_its_plane() {
    let mut flat = spec(PhantomKind::Vessels, [96, 96, 1]);
    flat.voxel_type = VoxelType::F32;
    let tree = phantom(&flat).unwrap().tree.unwrap();
    assert_eq!(structural_fault(&tree), None);
    let [cubes, balance] = murray_misfits(&tree);
    assert!(cubes <= 1e-9 && balance <= 1e-9, "{cubes} {balance}");
    let off_plane = |tree: &VesselTree| {
        let points = tree.segments.iter().flat_map(|s| &s.points_mm);
        points.fold(0.0, |max: f64, p| max.max(p[2].abs()))
    };
    assert_eq!(off_plane(&tree), 0.0);
    assert!(off_plane(&self::tree(96, 1)) > 30.0);
}

#[test]
fn a_seed_decides_the_tree_and_its_voxels() {
    let (_, a) = vessels(48, 5);
    let (_, b) = vessels(48, 5);
    let (_, c) = vessels(48, 6);
    assert_eq!(a.tree, b.tree);
    assert_eq!(a.volume.voxels().bytes(), b.volume.voxels().bytes());
    assert_ne!(a.tree, c.tree);
    assert_ne!(a.volume.voxels().bytes(), c.volume.voxels().bytes());
}

#[test]
fn the_tree_is_written_as_json() {
    let tree = tree(32, 1);
    let json = serde_json::to_value(&tree).unwrap();
    assert_eq!(json["dims"], serde_json::json!([32, 32, 32]));
    assert_eq!(json["murray_exponent"], 3.0);
    assert_eq!(json["seed"], 1);
    let second = &json["segments"][1];
    assert_eq!(second["parent"], 0);
    assert_eq!(second["generation"], 1);
    assert_eq!(second["radius_mm"], tree.segments[1].radius_mm);
    assert_eq!(second["points_mm"][0], json["segments"][0]["end_mm"]);
    assert!(json["segments"][0]["parent"].is_null());
}

fn distance_mm(s: &VesselSegment, p: DVec3) -> f64 {
    s.points_mm
        .windows(2)
        .map(|ends| {
            let [a, b] = [ends[0], ends[1]].map(DVec3::from_array);
            let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            p.distance(a + t * (b - a))
        })
        .fold(f64::INFINITY, f64::min)
}

/// The share of a disc of unit area that a disc of `radius` at `distance` covers, by summing
/// strips.
fn covered(distance: f64, radius: f64) -> f64 {
    const STRIPS: i32 = 4000;
    let a = 1.0 / std::f64::consts::PI.sqrt();
    let half = |r: f64, x: f64| (r * r - x * x).max(0.0).sqrt();
    let strip = 2.0 * a / f64::from(STRIPS);
    (0..STRIPS)
        .map(|n| -a + (f64::from(n) + 0.5) * strip)
        .map(|x| 2.0 * strip * half(a, x).min(half(radius, x - distance)))
        .sum()
}

#[test]
fn voxels_show_the_share_that_the_nearest_tube_covers() {
    let (_, made) = vessels(64, 3);
    let tree = made.tree.unwrap();
    let covered_with = |at: [u32; 3], wider: f64| {
        let p = DVec3::from_array(at.map(f64::from)) - 31.5;
        tree.segments
            .iter()
            .map(|s| (distance_mm(s, p), s.radius_mm * wider))
            .filter(|(d, r)| *d < r + 1.0)
            .map(|(d, r)| covered(d, r))
            .fold(0.0, f64::max)
    };
    let mut near = 0;
    let (mut worst, mut worst_if_wider) = (0.0_f64, 0.0_f64);
    for n in 0..64_u32.pow(3) {
        let at = [n % 64, n / 64 % 64, n / 4096];
        let value = stored(&made.volume, at);
        // Everything that is not background, and a scatter of the background.
        if value > 0.0 && n % 3 == 0 || n % 97 == 0 {
            near += i32::from(value > 0.0);
            worst = worst.max((value - covered_with(at, 1.0)).abs());
            worst_if_wider = worst_if_wider.max((value - covered_with(at, 1.1)).abs());
        }
    }
    assert!(near > 1000);
    assert!(worst < 1e-3, "{worst}");
    assert!(worst_if_wider > 0.05);
}

#[test]
fn centrelines_are_bright_and_their_surroundings_dark() {
    let (_, made) = vessels(96, 7);
    let tree = made.tree.unwrap();
    let nearest_voxel = |p: [f64; 3]| p.map(|x| (x + 47.5).round() as u32);
    for s in tree.segments.iter().filter(|s| s.radius_mm >= 0.87) {
        // The nearest voxel's centre is at most √3/2 away: inside the vessel.
        for &p in &s.points_mm {
            assert!(stored(&made.volume, nearest_voxel(p)) >= 0.4, "{}", s.id);
        }
    }
    for s in &tree.segments {
        let along = s
            .points_mm
            .iter()
            .map(|&p| stored(&made.volume, nearest_voxel(p)));
        assert!(along.fold(0.0, f64::max) > 0.1, "{} is lost", s.id);
    }
    let bright: usize = (0..96_usize.pow(3))
        .filter(|&n| made.volume.voxels().stored(n) > 0.0)
        .count();
    // Sparse, as an angiogram is.
    assert!(bright < 96_usize.pow(3) / 20, "{bright}");
}

#[test]
fn the_mid_value_isosurface_tracks_the_radius() {
    let (_, made) = vessels(128, 1);
    let tree = made.tree.unwrap();
    let volume = &made.volume;
    let mut errors: Vec<f64> = Vec::new();
    for s in tree.segments.iter().filter(|s| s.radius_mm >= 1.0) {
        for ends in s.points_mm.windows(2) {
            let [a, b] = [ends[0], ends[1]].map(DVec3::from_array);
            let middle = (a + b) / 2.0;
            let across = (b - a).normalize().any_orthonormal_vector();
            let wall = middle + s.radius_mm * across;
            // Where another vessel is near, or this one turns back, the wall is not this tube's.
            let alone = tree
                .segments
                .iter()
                .all(|other| other.id == s.id || distance_mm(other, wall) > other.radius_mm + 2.0);
            if !alone || (distance_mm(s, wall) - s.radius_mm).abs() > 0.02 {
                continue;
            }
            let field = |r: f64| trilinear(volume, middle + r * across + 63.5);
            let (mut inside, mut outside) = (0.0, s.radius_mm + 1.5);
            for _ in 0..40 {
                let r = (inside + outside) / 2.0;
                if field(r) >= 0.5 {
                    inside = r;
                } else {
                    outside = r;
                }
            }
            errors.push(inside - s.radius_mm);
        }
    }
    let rms = |shift: f64| {
        let sum: f64 = errors.iter().map(|e| (e - shift).powi(2)).sum();
        (sum / errors.len() as f64).sqrt()
    };
    let worst = errors.iter().fold(0.0_f64, |w, e| w.max(e.abs()));
    assert!(errors.len() > 150, "{}", errors.len());
    assert!(
        rms(0.0) < 0.15 && worst < 0.3,
        "rms {}, worst {worst}",
        rms(0.0)
    );
    assert!(rms(0.2) > 0.15);
}
