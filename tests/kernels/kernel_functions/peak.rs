//! Peaks between two samples.

use angioray::gpu::Args;
use angioray::scene::Filter;
use angioray::volume::VoxelType;

use super::{Random, build, common, room, run, upload, variant};

/// A ray through a volume of single-precision voxels.
struct Path {
    size: [u32; 3],
    voxels: Vec<f32>,
    start: [f32; 4],
    dir: [f32; 4],
    length_mm: f32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Peak {
    found: bool,
    t: f32,
    height: f32,
    samples: f32,
}

impl Path {
    /// Along x through voxels whose values are given, 1 mm apart.
    fn along_x(voxels: Vec<f32>) -> Self {
        let length_mm = (voxels.len() - 1) as f32;
        Self {
            size: [voxels.len() as u32, 1, 1],
            voxels,
            start: [0.0; 4],
            dir: [1.0, 0.0, 0.0, 0.0],
            length_mm,
        }
    }

    /// Across one cell from corner to corner of its xy face: the field is `4 s (1 − s)` at the part
    /// s of the path, 0 ≤ t ≤ 1.
    fn parabola() -> Self {
        Self {
            size: [2, 2, 1],
            voxels: vec![0.0, 2.0, 2.0, 0.0],
            start: [0.0; 4],
            dir: [1.0, 1.0, 0.0, 0.0],
            length_mm: 1.0,
        }
    }

    /// Looks between the t of both ends, with sign and goal.
    fn peaks(&self, rays: &[[f32; 4]], any: bool) -> Option<Vec<Peak>> {
        let device = common::device()?;
        let pass = build("peak", variant(VoxelType::F32, Filter::Linear, 8));
        let [nx, ny, nz] = self.size;
        let mut peaks = room::<[f32; 4]>(&device, rays.len());
        let mut found = room::<u32>(&device, rays.len());
        run(
            &device,
            &pass,
            Args::new()
                .value("count", &(rays.len() as u32))
                .value("size", &[nx, ny, nz, 0])
                .read("voxels", &upload(&device, &self.voxels))
                .value("start", &self.start)
                .value("dir", &self.dir)
                .value("length_mm", &self.length_mm)
                .value("first", &u32::from(any))
                .read("rays", &upload(&device, rays))
                .write("peaks", &mut peaks)
                .write("found", &mut found),
            rays.len(),
        );
        let peaks = peaks.download(&device).unwrap();
        let found = found.download(&device).unwrap();
        let peak = |(&found, &[t, height, _, samples]): (&u32, &[f32; 4])| Peak {
            found: found != 0,
            t,
            height,
            samples,
        };
        Some(found.iter().zip(&peaks).map(peak).collect())
    }

    /// The field at t along x.
    fn value_along_x(&self, t: f32) -> f32 {
        let cell = (t as usize).min(self.voxels.len() - 2);
        let f = f64::from(t) - cell as f64;
        (f64::from(self.voxels[cell]) * (1.0 - f) + f64::from(self.voxels[cell + 1]) * f) as f32
    }
}

/// Rises by 2 a voxel to 7 at voxel 3, falls by 1 a voxel.
fn tent() -> Path {
    Path::along_x(vec![1.0, 3.0, 5.0, 7.0, 6.0, 5.0, 4.0])
}

fn mirrored(path: Path) -> Path {
    let voxels = path.voxels.iter().map(|v| -v).collect();
    Path { voxels, ..path }
}

/// A segment about the tent's top from `a` to `b`.
fn segments(goal: f32, sign: f32) -> Vec<[f32; 4]> {
    let mut segments = Vec::new();
    for a in [0.25, 1.5, 2.75, 2.999] {
        for b in [3.001, 3.5, 4.25, 5.75] {
            segments.push([a, b, sign, goal]);
        }
    }
    segments
}

#[test]
fn the_top_of_a_tent_is_found_and_minima_are_peaks_upside_down() {
    let finds = |peak: &Peak, height: f32| {
        peak.found
            && (peak.t - 3.0).abs() < 1e-5
            && (peak.height - height).abs() < 3e-5
            && peak.samples >= 1.0
    };
    for (path, sign) in [(tent(), 1.0), (mirrored(tent()), -1.0)] {
        for any in [false, true] {
            let Some(peaks) = path.peaks(&segments(6.999, sign), any) else {
                return;
            };
            assert!(peaks.iter().all(|peak| finds(peak, 7.0)), "{peaks:?}");
            assert!(!peaks.iter().any(|peak| finds(peak, 6.99)));
        }
    }
}

#[test]
fn nothing_above_the_goal_is_nothing_found() {
    for (path, sign) in [(tent(), 1.0), (mirrored(tent()), -1.0)] {
        let Some(peaks) = path.peaks(&segments(7.001, sign), false) else {
            return;
        };
        assert!(
            peaks.iter().all(|peak| !peak.found && peak.samples == 0.0),
            "{peaks:?}"
        );
        // Looked for on the wrong side there is none; with a lower goal there is one.
        let away = path.peaks(&segments(-100.0, -sign), false).unwrap();
        assert!(away.iter().all(|peak| !peak.found));
        let lower = path.peaks(&segments(6.9, sign), false).unwrap();
        assert!(lower.iter().all(|peak| peak.found));
    }
}

/// Tangents of a parabola meet halfway: each probe halves the distance to its top.
#[test]
fn the_top_of_a_parabola_is_found_to_a_sixteenth_of_the_segment() {
    let path = Path::parabola();
    let mut rays = Vec::new();
    for a in [0.01, 0.1, 0.3, 0.45] {
        for b in [0.55, 0.72, 0.93, 0.99] {
            rays.push([a, b, 1.0, 0.0]);
        }
    }
    let Some(peaks) = path.peaks(&rays, false) else {
        return;
    };
    let near = |ray: &[f32; 4], peak: &Peak| {
        let width = ray[1] - ray[0];
        let deficit = 4.0 * (width / 16.0).powi(2);
        peak.found
            && (peak.t - 0.5).abs() <= width / 16.0 + 1e-6
            && peak.height >= 1.0 - deficit - 1e-6
            && peak.height <= 1.0 + 1e-6
    };
    for (ray, peak) in rays.iter().zip(&peaks) {
        // Wider than the goal lets it be: the ends are no higher than what was found.
        assert!(near(ray, peak), "{ray:?}: {peak:?}");
    }
    // The first probe alone, halfway, is not near in every segment.
    let halfway = |ray: &[f32; 4]| {
        let t = 0.5 * (ray[0] + ray[1]);
        near(
            ray,
            &Peak {
                found: true,
                t,
                height: 4.0 * t * (1.0 - t),
                samples: 1.0,
            },
        )
    };
    assert!(!rays.iter().all(halfway));
}

/// Whatever the field does, what is found is a point of it, inside the segment and above the goal.
#[test]
fn what_is_found_in_noise_is_there() {
    let mut random = Random(6);
    let path = Path::along_x((0..64).map(|_| random.within(-5.0, 5.0)).collect());
    let mut rays = Vec::new();
    for _ in 0..20_000 {
        let a = random.within(0.0, 60.0);
        let b = a + random.within(0.01, 3.0);
        let goal = path.value_along_x(a).max(path.value_along_x(b));
        rays.push([a, b, 1.0, goal]);
    }
    let Some(peaks) = path.peaks(&rays, false) else {
        return;
    };
    let mut found = 0;
    for (&[a, b, _, goal], peak) in rays.iter().zip(&peaks) {
        assert!(peak.samples <= 8.0);
        if peak.found {
            found += 1;
            assert!(
                peak.t > a && peak.t < b && peak.height > goal,
                "{a} {b} {goal}: {peak:?}"
            );
            assert!((peak.height - path.value_along_x(peak.t)).abs() < 5e-5);
        }
    }
    assert!(found > 1_000, "{found}");
    // Heights against those of another place fail.
    let elsewhere =
        |peak: &&Peak| peak.found && (peak.height - path.value_along_x(peak.t - 0.01)).abs() > 5e-5;
    assert!(peaks.iter().filter(elsewhere).count() > found / 2);
}
