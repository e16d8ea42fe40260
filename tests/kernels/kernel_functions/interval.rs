//! The interval of a ray inside the volume.

use angioray::gpu::Args;
use angioray::scene::Filter;

use super::{Random, U8, build, common, room, run, upload, variant};

#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub size: [u32; 3],
    pub origin: [f32; 3],
    pub dir: [f32; 3],
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inside {
    pub enter: f64,
    pub exit: f64,
    pub axis: u32,
    pub by_face: bool,
}

fn on_device(cases: &[Case]) -> Option<Vec<Inside>> {
    let device = common::device()?;
    let pass = build("interval", variant(U8, Filter::Linear, 8));
    let vectors = |of: fn(&Case) -> [f32; 3]| -> Vec<[f32; 4]> {
        let vector = |case| {
            let [x, y, z] = of(case);
            [x, y, z, 0.0]
        };
        cases.iter().map(vector).collect()
    };
    let sizes: Vec<[u32; 4]> = cases
        .iter()
        .map(|case| [case.size[0], case.size[1], case.size[2], 0])
        .collect();
    let mut inside = room::<[f32; 2]>(&device, cases.len());
    let mut entry = room::<[u32; 4]>(&device, cases.len());
    run(
        &device,
        &pass,
        Args::new()
            .value("count", &(cases.len() as u32))
            .read("sizes", &upload(&device, &sizes))
            .read("origins", &upload(&device, &vectors(|case| case.origin)))
            .read("dirs", &upload(&device, &vectors(|case| case.dir)))
            .write("inside", &mut inside)
            .write("entry", &mut entry),
        cases.len(),
    );
    let inside = inside.download(&device).unwrap();
    let entry = entry.download(&device).unwrap();
    Some(
        inside
            .iter()
            .zip(entry)
            .map(|(&[enter, exit], [axis, by_face, ..])| Inside {
                enter: f64::from(enter),
                exit: f64::from(exit),
                axis,
                by_face: by_face != 0,
            })
            .collect(),
    )
}

/// The part of the ray with t ≥ 0 inside the box of voxel centres, half a voxel either side of a
/// single one. `border` widens the box: 0 is right.
pub fn expected(case: &Case, border: f64) -> Inside {
    let mut found = Inside {
        enter: 0.0,
        exit: f64::INFINITY,
        axis: 0,
        by_face: false,
    };
    for axis in 0..3 {
        let n = f64::from(case.size[axis]);
        let (low, high) = if n == 1.0 {
            (-0.5, 0.5)
        } else {
            (-border, n - 1.0 + border)
        };
        let [origin, dir] = [case.origin[axis], case.dir[axis]].map(f64::from);
        if dir.abs() < 1e-20 {
            if !(low..=high).contains(&origin) {
                found.exit = f64::NEG_INFINITY;
            }
            continue;
        }
        let (a, b) = ((low - origin) / dir, (high - origin) / dir);
        if a.min(b) > found.enter {
            found.enter = a.min(b);
            found.axis = axis as u32;
            found.by_face = true;
        }
        found.exit = found.exit.min(a.max(b));
    }
    found
}

/// Whether the device's interval is as expected but for rounding. A ray that grazes may miss or not; a ray
/// through an edge may enter by either face.
fn agrees(case: &Case, got: Inside, border: f64) -> bool {
    let expected = expected(case, border);
    let scale = 1.0
        + expected.enter.abs().max(if expected.exit.is_finite() {
            expected.exit.abs()
        } else {
            0.0
        });
    let near = 2e-6 * scale;
    if (expected.exit - expected.enter).abs() <= near {
        return true;
    }
    if expected.enter > expected.exit {
        return got.enter > got.exit;
    }
    (got.enter - expected.enter).abs() <= near
        && (got.exit - expected.exit).abs() <= near
        && got.enter <= got.exit
        && got.by_face == expected.by_face
}

pub fn random_cases(random: &mut Random) -> Vec<Case> {
    (0..20_000)
        .map(|_| {
            let size: [u32; 3] = std::array::from_fn(|_| 1 + random.below(20));
            let [x, y, z, _] = random.direction();
            let mut dir = [x, y, z];
            if random.below(3) == 0 {
                let tiny = [0.0, -0.0, 1e-40, -1e-40, 1e-25, -1e-25];
                dir[random.below(3) as usize] = tiny[random.below(6) as usize];
            }
            let toward: [f32; 3] =
                std::array::from_fn(|a| random.within(-0.3, 1.3) * (size[a] - 1) as f32);
            let back = random.within(-5.0, 60.0);
            let origin = std::array::from_fn(|a| toward[a] - back * dir[a]);
            Case { size, origin, dir }
        })
        .collect()
}

#[test]
fn random_rays_enter_and_leave_where_slabs_say() {
    let cases = random_cases(&mut Random(2));
    let Some(got) = on_device(&cases) else {
        return;
    };
    for (case, &got) in cases.iter().zip(&got) {
        assert!(
            agrees(case, got, 0.0),
            "{case:?}: {got:?}, not {:?}",
            expected(case, 0.0)
        );
    }
    let hits = got.iter().filter(|i| i.enter <= i.exit).count();
    assert!((5_000..18_000).contains(&hits), "{hits}");
    // A box of voxel borders, half a voxel larger, is seen.
    let as_larger = cases
        .iter()
        .zip(&got)
        .filter(|(case, got)| agrees(case, **got, 0.5))
        .count();
    assert!(as_larger < cases.len() * 3 / 4, "{as_larger}");
}

/// Rays along an axis and along diagonals from and through faces, edges and corners, with every
/// kind of zero in the other components: exact, since all numbers are small integers.
// long: the cases and what is expected of them.
#[test]
fn rays_in_faces_edges_and_corners_are_exact() {
    let zeros = [
        0.0f32,
        -0.0,
        1e-40,
        -1e-40,
        f32::MIN_POSITIVE,
        -f32::MIN_POSITIVE,
        1e-21,
        -1e-21,
    ];
    let mut cases = Vec::new();
    for size in [[5, 5, 5], [2, 9, 5], [1, 5, 5], [1, 1, 5], [1, 1, 1]] {
        let ends = |axis: usize| {
            if size[axis] == 1 {
                [-0.5, 0.5]
            } else {
                [0.0, (size[axis] - 1) as f32]
            }
        };
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for (from, sign) in [(-3.0f32, 1.0f32), (12.0, -1.0), (0.0, 1.0), (0.0, -1.0)] {
                for (k, &zero) in zeros.iter().enumerate() {
                    // In the face or edge itself, and beside it.
                    for (pu, pv) in [
                        (ends(u)[0], ends(v)[0]),
                        (ends(u)[1], ends(v)[0]),
                        (ends(u)[1], ends(v)[1]),
                        (0.25, ends(v)[1]),
                        (ends(u)[0] - 1e-3, ends(v)[0]),
                        (ends(u)[0], ends(v)[1] + 1e-3),
                    ] {
                        let mut case = Case {
                            size,
                            origin: [0.0; 3],
                            dir: [0.0; 3],
                        };
                        case.origin[axis] = from;
                        case.dir[axis] = sign;
                        case.origin[u] = pu;
                        case.origin[v] = pv;
                        case.dir[u] = zero;
                        case.dir[v] = zeros[(k + 3) % zeros.len()];
                        cases.push(case);
                    }
                }
            }
        }
        // Corner to corner, from outside, from the corner inward, and outward.
        for step in [-4.0, 0.0] {
            for sign in [1.0, -1.0] {
                cases.push(Case {
                    size,
                    origin: [step; 3],
                    dir: [sign; 3],
                });
            }
        }
    }
    let Some(got) = on_device(&cases) else {
        return;
    };
    for (case, got) in cases.iter().zip(&got) {
        let expected = expected(case, 0.0);
        let misses = expected.enter > expected.exit;
        assert_eq!(
            got.enter > got.exit,
            misses,
            "{case:?}: {got:?}, not {expected:?}"
        );
        assert!(
            misses || *got == expected,
            "{case:?}: {got:?}, not {expected:?}"
        );
    }
    let hits = got.iter().filter(|i| i.enter <= i.exit).count();
    assert!(
        hits > cases.len() / 4 && hits < cases.len() * 3 / 4,
        "{hits} of {}",
        cases.len()
    );
    // A box a little smaller, which loses what lies in faces, is seen.
    let lost = |(case, got): &(&Case, &Inside)| {
        let smaller = expected(case, -1e-4);
        (smaller.enter > smaller.exit) != (got.enter > got.exit)
    };
    assert!(cases.iter().zip(&got).any(|pair| lost(&pair)));
}
