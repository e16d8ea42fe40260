//! The interval of a ray inside the volume and on the kept side of planes.

use angioray::gpu::Args;
use angioray::scene::{ClipPlane, Filter};

use super::interval::{Case, Inside, expected, random_cases};
use super::{Random, U8, build, common, dot, room, run, upload, variant, xyz};

/// What `axis` is where a ray enters through plane 0.
const FIRST_AXIS: u32 = 3;

type Plane = [f32; 4];

fn on_device(cases: &[(Case, Vec<Plane>)]) -> Option<Vec<Inside>> {
    let device = common::device()?;
    let pass = build("clip", variant(U8, Filter::Linear, 8));
    let mut first = 0;
    let mut sizes = Vec::new();
    for (case, planes) in cases {
        let [nx, ny, nz] = case.size;
        sizes.push([nx, ny, nz, first]);
        first += planes.len() as u32;
    }
    let planes: Vec<Plane> = cases.iter().flat_map(|(_, p)| p.clone()).collect();
    let counts: Vec<u32> = cases.iter().map(|(_, p)| p.len() as u32).collect();
    let vectors = |of: fn(&Case) -> [f32; 3]| -> Vec<[f32; 4]> {
        let vector = |(case, _): &(Case, Vec<Plane>)| {
            let [x, y, z] = of(case);
            [x, y, z, 0.0]
        };
        cases.iter().map(vector).collect()
    };
    let mut inside = room::<[f32; 2]>(&device, cases.len());
    let mut entry = room::<[u32; 4]>(&device, cases.len());
    run(
        &device,
        &pass,
        Args::new()
            .value("count", &(cases.len() as u32))
            .read("sizes", &upload(&device, &sizes))
            .read("planes", &upload(&device, &planes))
            .read("counts", &upload(&device, &counts))
            .read("origins", &upload(&device, &vectors(|case| case.origin)))
            .read("dirs", &upload(&device, &vectors(|case| case.dir)))
            .write("inside", &mut inside)
            .write("entry", &mut entry),
        cases.len(),
    );
    let inside = inside.download(&device).unwrap();
    let entry = entry.download(&device).unwrap();
    let found = inside.iter().zip(entry);
    Some(
        found
            .map(|(&[enter, exit], [axis, by_face, ..])| Inside {
                enter: enter.into(),
                exit: exit.into(),
                axis,
                by_face: by_face == 1,
            })
            .collect(),
    )
}

/// By the definition, from the numbers that the device has. `error` is how far the interval's ends
/// may be off for what single precision makes of the planes; a plane along the ray makes it infinite
/// where the ray lies in it but for rounding.
fn clipped(case: &Case, planes: &[Plane]) -> (Inside, f64) {
    let mut found = expected(case, 0.0);
    let mut error = 2e-6 * (1.0 + found.enter.abs());
    let (origin, dir) = (case.origin.map(f64::from), case.dir.map(f64::from));
    for (i, &plane) in planes.iter().enumerate() {
        let (normal, offset) = (xyz(plane), f64::from(plane[3]));
        let rate = dot(normal, dir);
        let height = dot(normal, origin) + offset;
        let size = |v: [f64; 3]| dot(normal.map(f64::abs), v.map(f64::abs));
        let rounding = 6e-7 * (size(origin) + offset.abs());
        if rate.abs() <= 6e-7 * size(dir) {
            if height.abs() <= rounding {
                error = f64::INFINITY;
            } else if height < 0.0 {
                found.exit = f64::NEG_INFINITY;
            }
            continue;
        }
        let t = -height / rate;
        error = error.max((rounding + 6e-7 * size(dir) * t.abs()) / rate.abs());
        if rate < 0.0 {
            found.exit = found.exit.min(t);
        } else if t > found.enter {
            found.enter = t;
            found.axis = FIRST_AXIS + i as u32;
            found.by_face = true;
        }
    }
    (found, error)
}

/// Whether the device's interval is as expected but for rounding. A ray that grazes may miss or not.
fn agrees(case: &Case, planes: &[Plane], got: Inside) -> bool {
    let (expected, error) = clipped(case, planes);
    if (expected.exit - expected.enter).abs() <= 2.0 * error || error > 1e-2 {
        return true;
    }
    if expected.enter > expected.exit {
        return got.enter > got.exit;
    }
    (got.enter - expected.enter).abs() <= error
        && (got.exit - expected.exit).abs() <= error
        && got.by_face == expected.by_face
        && (got.axis == expected.axis || expected.enter <= 2.0 * error)
}

#[test]
fn random_planes_cut_where_their_equations_say() {
    let mut random = Random(21);
    let cases: Vec<(Case, Vec<Plane>)> = random_cases(&mut random)
        .into_iter()
        .map(|case| {
            let count = [0, 1, 2, 7, ClipPlane::MAX_COUNT as u32][random.below(5) as usize];
            let plane = |_| {
                let [x, y, z, _] = random.direction();
                let normal = [x, y, z].map(f64::from);
                let center = case.size.map(|n| f64::from(n - 1) / 2.0);
                let radius = center.iter().fold(0.5, |max: f64, c| max.max(*c));
                let beyond = f64::from(random.within(-0.2, 1.2)) * radius;
                [x, y, z, (beyond - dot(normal, center)) as f32]
            };
            let planes = (0..count).map(plane).collect();
            (case, planes)
        })
        .collect();
    let Some(got) = on_device(&cases) else {
        return;
    };
    for ((case, planes), &got) in cases.iter().zip(&got) {
        let expected = clipped(case, planes);
        assert!(
            agrees(case, planes, got),
            "{case:?} {planes:?}: {got:?}, not {expected:?}"
        );
    }
    let is_hit = |i: &&Inside| i.enter <= i.exit;
    let by_plane = got.iter().filter(is_hit).filter(|i| i.axis >= FIRST_AXIS);
    let (by_plane, hits) = (by_plane.count(), got.iter().filter(is_hit).count());
    assert!(by_plane > 500 && hits > 5_000, "{by_plane} of {hits}");
    // Planes a thousandth of a voxel aside, and a missing last one, are seen.
    let wrong = |planes: fn(&[Plane]) -> Vec<Plane>| {
        let pairs = cases.iter().zip(&got);
        pairs
            .filter(|((case, own), got)| !agrees(case, &planes(own), **got))
            .count()
    };
    let aside = |own: &[Plane]| {
        own.iter()
            .map(|&[x, y, z, w]| [x, y, z, w + 1e-3])
            .collect()
    };
    let fewer = |own: &[Plane]| own[..own.len().saturating_sub(1)].to_vec();
    assert!(wrong(aside) > 1_000, "{}", wrong(aside));
    assert!(wrong(fewer) > 300, "{}", wrong(fewer));
}

/// Small whole numbers: a ray in a plane, beside it, along it, and planes through its start.
// long: the table of cases.
#[test]
fn rays_along_and_in_planes_are_exact() {
    let case = |origin, dir| Case {
        size: [9, 9, 9],
        origin,
        dir,
    };
    let along_x = case([-2.0, 4.0, 4.0], [1.0, 0.0, 0.0]);
    let inside = case([4.0, 4.0, 4.0], [0.0, 0.0, -0.5]);
    let face = |axis, enter, exit| Inside {
        enter,
        exit,
        axis,
        by_face: true,
    };
    let free = |exit| Inside {
        enter: 0.0,
        exit,
        axis: 0,
        by_face: false,
    };
    let whole = face(0, 2.0, 10.0);
    let table: Vec<(Case, Vec<Plane>, Option<Inside>)> = vec![
        (along_x, vec![], Some(whole)),
        // In the plane, above it, below it; the same seen from its other side.
        (along_x, vec![[0.0, 1.0, 0.0, -4.0]], Some(whole)),
        (along_x, vec![[0.0, 1.0, 0.0, -3.0]], Some(whole)),
        (along_x, vec![[0.0, 1.0, 0.0, -5.0]], None),
        (along_x, vec![[0.0, -1.0, 0.0, 4.0]], Some(whole)),
        (along_x, vec![[0.0, -1.0, 0.0, 3.0]], None),
        (along_x, vec![[-0.0, 1.0, 1.0, -8.0]], Some(whole)),
        (along_x, vec![[0.0, 1.0, -1.0, 0.0]], Some(whole)),
        // Across: the later entry and the earlier exit of two each.
        (
            along_x,
            vec![[1.0, 0.0, 0.0, -3.0], [1.0, 0.0, 0.0, -5.0]],
            Some(face(4, 7.0, 10.0)),
        ),
        (
            along_x,
            vec![[-1.0, 0.0, 0.0, 5.0], [-0.5, 0.0, 0.0, 1.0]],
            Some(face(0, 2.0, 4.0)),
        ),
        // A face of the volume once more; what is left is a point; what is left is nothing.
        (along_x, vec![[1.0, 0.0, 0.0, 0.0]], Some(whole)),
        (
            along_x,
            vec![[1.0, 0.0, 0.0, -5.0], [-1.0, 0.0, 0.0, 5.0]],
            Some(face(3, 7.0, 7.0)),
        ),
        (
            along_x,
            vec![[1.0, 0.0, 0.0, -5.0], [-1.0, 0.0, 0.0, 4.5]],
            None,
        ),
        // From the eye inside: planes behind it, through it and ahead of it.
        (inside, vec![[0.0, 0.0, -1.0, 6.0]], Some(free(8.0))),
        (inside, vec![[0.0, 0.0, -1.0, 4.0]], Some(free(8.0))),
        (inside, vec![[0.0, 0.0, -1.0, 3.0]], Some(face(3, 2.0, 8.0))),
        (inside, vec![[0.0, 0.0, 1.0, -4.0]], Some(free(0.0))),
        (inside, vec![[0.0, 0.0, 1.0, -5.0]], None),
        // Farther than any number of the volume.
        (inside, vec![[0.0, 1.0, 1.0, 1e30]], Some(free(8.0))),
        (inside, vec![[0.0, 1.0, 1.0, -1e30]], None),
    ];
    let cases: Vec<(Case, Vec<Plane>)> = (table.iter())
        .map(|(case, planes, _)| (*case, planes.clone()))
        .collect();
    let Some(got) = on_device(&cases) else {
        return;
    };
    let mut others = 0;
    for ((case, planes, expected), got) in table.iter().zip(&got) {
        match expected {
            Some(expected) => assert_eq!(got, expected, "{case:?} {planes:?}"),
            None => assert!(got.enter > got.exit, "{case:?} {planes:?}: {got:?}"),
        }
        others += usize::from(*got != whole && *got != free(8.0));
    }
    // The control: half of them are not what they are without planes.
    assert!(others >= 9, "{others}");
}
