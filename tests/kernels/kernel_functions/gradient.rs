//! The field's gradient by each method, and the normal made of it.

use angioray::gpu::{Args, Pass};
use angioray::scene::Filter;
use angioray::volume::VoxelType;

use super::{Random, common, dot, room, run, upload, variant, xyz};

const DIFFERENCES: [&str; 3] = ["CENTRAL", "FORWARD", "FOURTH_ORDER"];

/// The covector map of a sheared, anisotropic volume.
const ROWS: [[f32; 4]; 3] = [
    [1.0, 0.0, 0.0, 0.0],
    [-0.2, 0.5, 0.0, 0.0],
    [0.1, 0.3, 0.25, 0.0],
];
const FALLBACK: [f32; 4] = [0.0, 0.6, -0.8, 0.0];

/// What gradients are made of.
enum Source<'a> {
    Voxels(&'a str, &'a [f32]),
    Directions(&'a [i16], [u32; 4]),
}

struct Seen {
    gradients: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
}

fn on_device(size: [u32; 3], source: &Source, points: &[[f32; 4]]) -> Option<Seen> {
    let device = common::device()?;
    let method = match source {
        Source::Voxels(method, _) => method,
        Source::Directions(..) => "PRECOMPUTED",
    };
    let defines = variant(VoxelType::F32, Filter::Linear, 8).defines();
    let defines = defines.with("GRADIENT", format!("GRADIENT_{method}"));
    let pass = Pass::new("test", "gradient", defines, [1, 1]);
    let mut gradients = room::<[f32; 4]>(&device, points.len());
    let mut normals = room::<[f32; 4]>(&device, points.len());
    let [nx, ny, nz] = size;
    let args = Args::new()
        .value("count", &(points.len() as u32))
        .value("size", &[nx, ny, nz, 0])
        .value("row_x", &ROWS[0])
        .value("row_y", &ROWS[1])
        .value("row_z", &ROWS[2]);
    let args = match source {
        Source::Voxels(_, voxels) => args.read("voxels", &upload(&device, voxels)),
        Source::Directions(directions, grid) => args
            .read("directions", &upload(&device, directions))
            .value("direction_grid", grid),
    };
    let args = args
        .read("points", &upload(&device, points))
        .value("fallback", &FALLBACK)
        .write("gradients", &mut gradients)
        .write("normals", &mut normals);
    run(&device, &pass, args, points.len());
    let read = |buffer: Vec<[f32; 4]>| buffer.into_iter().map(xyz).collect();
    Some(Seen {
        gradients: read(gradients.download(&device).unwrap()),
        normals: read(normals.download(&device).unwrap()),
    })
}

/// A component at a lattice point, interpolated at p, which is clamped to the lattice.
fn interpolated(size: [u32; 3], p: [f64; 3], at: impl Fn(usize) -> f64) -> f64 {
    let p: [f64; 3] = std::array::from_fn(|a| p[a].clamp(0.0, f64::from(size[a] - 1)));
    (0..8).fold(0.0, |sum, corner: usize| {
        let (mut weight, mut index, mut stride) = (1.0, 0, 1);
        for a in 0..3 {
            let low = p[a].floor();
            let up = corner >> a & 1;
            let f = p[a] - low;
            weight *= if up == 1 { f } else { 1.0 - f };
            index += (low as usize + up).min(size[a] as usize - 1) * stride;
            stride *= size[a] as usize;
        }
        sum + weight * at(index)
    })
}

/// By the definitions.
fn difference(method: &str, size: [u32; 3], voxels: &[f32], p: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let phi = |by: f64| {
            let mut moved = p;
            moved[axis] += by;
            interpolated(size, moved, |i| voxels[i].into())
        };
        match method {
            "CENTRAL" => (phi(1.0) - phi(-1.0)) / 2.0,
            "FORWARD" => phi(1.0) - phi(0.0),
            _ => (8.0 * (phi(1.0) - phi(-1.0)) - (phi(2.0) - phi(-2.0))) / 12.0,
        }
    })
}

/// Anywhere in the domain, in the faces of cells and in the volume's.
fn points(size: [u32; 3], count: usize, random: &mut Random) -> Vec<[f32; 4]> {
    let mut coordinate = |n: u32| {
        let anywhere = random.within(0.0, f64::from(n - 1));
        match random.below(5) {
            0 => anywhere.round(),
            1 => 0.0,
            2 => (n - 1) as f32,
            _ => anywhere,
        }
    };
    (0..count)
        .map(|_| {
            let [x, y, z] = size.map(&mut coordinate);
            [x, y, z, 0.0]
        })
        .collect()
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    let d: [f64; 3] = std::array::from_fn(|i| a[i] - b[i]);
    dot(d, d).sqrt()
}

/// The unit vector against the mapped gradient.
fn normal(gradient: [f64; 3]) -> [f64; 3] {
    let world = ROWS.map(|row| dot(xyz(row), gradient));
    let len = dot(world, world).sqrt();
    world.map(|c| -c / len)
}

#[test]
fn differences_are_as_defined_up_to_the_border() {
    let mut random = Random(31);
    for size in [[6, 5, 4], [2, 2, 2], [7, 1, 3]] {
        let count = size.iter().product::<u32>();
        let voxels: Vec<f32> = (0..count).map(|_| random.within(-1.0, 1.0)).collect();
        let points = points(size, 4_000, &mut random);
        for method in DIFFERENCES {
            let Some(seen) = on_device(size, &Source::Voxels(method, &voxels), &points) else {
                return;
            };
            let mut others = 0;
            for (i, &p) in points.iter().enumerate() {
                let expected = difference(method, size, &voxels, xyz(p));
                let error = apart(seen.gradients[i], expected);
                assert!(error < 3e-6, "{method} {size:?} at {p:?}: {error:e}");
                if dot(expected, expected) > 1e-2 {
                    let error = apart(seen.normals[i], normal(expected));
                    assert!(error < 5e-5, "{method} {size:?} at {p:?}: {error:e}");
                }
                // The control: the other methods.
                let other = |m: &&&str| {
                    let wrong = difference(m, size, &voxels, xyz(p));
                    **m != method && apart(seen.gradients[i], wrong) < 1e-3
                };
                others += DIFFERENCES.iter().filter(other).count();
            }
            assert!(others < points.len() / 2, "{method} {size:?}: {others}");
        }
    }
}

/// sin and cos along the axes, `h` the distance of voxels.
fn smooth(h: f64, p: [f64; 3]) -> (f64, [f64; 3]) {
    let [x, y, z] = p.map(|c| c * h);
    let value = (0.9 * x + 0.3).sin() + 0.7 * (1.1 * y).cos() + 0.5 * (0.8 * z + 0.2).sin();
    let slope = [
        0.9 * (0.9 * x + 0.3).cos(),
        -0.77 * (1.1 * y).sin(),
        0.4 * (0.8 * z + 0.2).cos(),
    ];
    (value, slope.map(|s| s * h))
}

/// The largest error at voxel centres three voxels from the border, as a slope of the smooth field.
fn error_at(method: &str, h: f64) -> Option<f64> {
    const N: u32 = 15;
    let at = |i: u32| [i % N, i / N % N, i / N / N].map(f64::from);
    let voxels: Vec<f32> = (0..N.pow(3)).map(|i| smooth(h, at(i)).0 as f32).collect();
    let inner = |p: &[f64; 3]| p.iter().all(|c| (3.0..=11.0).contains(c));
    let centres: Vec<[f64; 3]> = (0..N.pow(3)).map(at).filter(inner).collect();
    let points: Vec<[f32; 4]> = (centres.iter())
        .map(|p| [p[0] as f32, p[1] as f32, p[2] as f32, 0.0])
        .collect();
    let seen = on_device([N; 3], &Source::Voxels(method, &voxels), &points)?;
    let errors = centres.iter().zip(&seen.gradients);
    Some(errors.fold(0.0, |max, (&p, &found)| {
        f64::max(max, apart(found, smooth(h, p).1) / h)
    }))
}

#[test]
fn differences_converge_with_their_order() {
    for (method, order) in [("FORWARD", 1.0), ("CENTRAL", 2.0), ("FOURTH_ORDER", 4.0)] {
        let mut before: Option<f64> = None;
        for h in [0.8, 0.4, 0.2] {
            let Some(error) = error_at(method, h) else {
                return;
            };
            if let Some(before) = before {
                let observed = (before / error).log2();
                println!("| {method} | {h} | {error:.2e} | {observed:.2} |");
                assert!((observed - order).abs() < 0.35, "{method} {h}: {observed}");
            }
            before = Some(error);
        }
    }
}

#[test]
fn precomputed_directions_are_interpolated_between_their_voxels() {
    let mut random = Random(32);
    for (size, voxels_apart) in [
        ([6u32, 5, 4], 2u32),
        ([9, 8, 3], 3),
        ([5, 4, 6], 1),
        ([4, 1, 9], 8),
    ] {
        let grid = size.map(|n| (n - 1).div_ceil(voxels_apart) + 1);
        let count = 3 * grid.iter().product::<u32>();
        let mut directions: Vec<i16> = (0..count).map(|_| random.bits() as i16 / 2).collect();
        directions[..3].fill(0);
        let points = points(size, 4_000, &mut random);
        let [gx, gy, gz] = grid;
        let source = Source::Directions(&directions, [gx, gy, gz, voxels_apart]);
        let Some(seen) = on_device(size, &source, &points) else {
            return;
        };
        let mut caught = 0;
        for (i, &p) in points.iter().enumerate() {
            // In units of the grid; its last interval may be a shorter one.
            let at = |stretched: bool| -> [f64; 3] {
                std::array::from_fn(|a| {
                    let below = (grid[a].max(2) - 2) * voxels_apart;
                    let (p, below) = (f64::from(p[a]), f64::from(below));
                    let last = f64::from(size[a] - 1) - below;
                    let whole = f64::from(voxels_apart);
                    if p <= below || last <= 0.0 || !stretched {
                        p / whole
                    } else {
                        below / whole + (p - below) / last
                    }
                })
            };
            let of = |at: [f64; 3]| -> [f64; 3] {
                std::array::from_fn(|c| interpolated(grid, at, |k| directions[3 * k + c].into()))
            };
            let expected = of(at(true));
            let error = apart(seen.gradients[i], expected);
            assert!(error < 0.05, "{size:?} at {p:?}: {error}");
            if expected == [0.0; 3] {
                assert_eq!(seen.normals[i], xyz(FALLBACK));
            }
            // The control: as if all intervals were whole, and half a voxel aside.
            caught += usize::from(apart(seen.gradients[i], of(at(true).map(|c| c + 0.1))) > 50.0);
            caught += usize::from(apart(seen.gradients[i], of(at(false))) > 50.0);
        }
        assert!(caught > points.len() / 2, "{size:?}: {caught}");
    }
}

#[test]
fn a_flat_field_has_the_normal_toward_the_eye() {
    let voxels = vec![7.25f32; 4 * 3 * 5];
    let mut random = Random(33);
    let points = points([4, 3, 5], 200, &mut random);
    for method in DIFFERENCES {
        let Some(seen) = on_device([4, 3, 5], &Source::Voxels(method, &voxels), &points) else {
            return;
        };
        assert!(seen.normals.iter().all(|&n| n == xyz(FALLBACK)), "{method}");
    }
    let mut tilted = voxels;
    tilted[30] += 1e-3;
    let source = Source::Voxels("CENTRAL", &tilted);
    let Some(seen) = on_device([4, 3, 5], &source, &points) else {
        return;
    };
    assert!(seen.normals.iter().any(|&n| n != xyz(FALLBACK)));
}
