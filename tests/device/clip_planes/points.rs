//! Random sets of planes against a test of points: a point is kept when it lies in the volume and
//! on the kept side of every plane.

use super::*;

const SETS: usize = 60;
const SIZE_PX: u32 = 10;
/// Between the points tested along a ray.
const APART_MM: f64 = 0.02;

/// 1 to 64 planes of any length of normal; some sets leave nothing.
fn random_set(random: &mut Random, center: DVec3, radius_mm: f64) -> Vec<ClipPlane> {
    let count = match random.bits() % 4 {
        0 => 1,
        1 => 64,
        _ => 2 + random.bits() % 10,
    };
    let nearest = random.within(-0.6, 0.5);
    (0..count)
        .map(|_| {
            let normal = random.direction();
            let point = center - normal * (radius_mm * random.within(nearest, 1.0));
            plane_at(point, normal * 10f64.powf(random.within(-6.0, 6.0)))
        })
        .collect()
}

/// The kept points of a ray, mm from its origin: the first and the last.
fn visible_points(
    volume: &Volume,
    planes: &[ClipPlane],
    ray: angioray::scene::Ray,
    farthest_mm: f64,
) -> Option<(f64, f64)> {
    let index_from_world = volume.geometry().index_from_world();
    let last = DVec3::from_array(volume.dims().usize().map(|n| n as f64 - 1.0));
    let is_visible = |mm: &f64| {
        let p_world = ray.origin_world + ray.dir_world * *mm;
        let p = index_from_world.transform_point3(p_world);
        let in_volume = p.cmpge(DVec3::ZERO).all() && p.cmple(last).all();
        in_volume
            && planes
                .iter()
                .all(|c| c.normal_world().dot(p_world) + c.offset() >= 0.0)
    };
    let steps = (farthest_mm / APART_MM) as u32;
    let mut visible = (0..steps)
        .map(|k| f64::from(k) * APART_MM)
        .filter(is_visible);
    let first = visible.next()?;
    Some((first, visible.next_back().unwrap_or(first)))
}

/// Pixels whose interval is not where the kept points are, and pixels that see something.
fn compare(
    volume: &Volume,
    planes: &[ClipPlane],
    (camera, size): (Camera, ImageSize),
    [first, through]: [&Frame; 2],
) -> (usize, usize) {
    let (center, radius_mm) = volume.bounding_sphere();
    let farthest_mm = camera.eye_world().distance(center) + radius_mm;
    let depths = depths_mm(first);
    let (mut wrong, mut seen) = (0, 0);
    for (pixel, (depth_mm, length_mm)) in depths.iter().zip(lengths_mm(through)).enumerate() {
        let (i, j) = (pixel as u32 % size.width(), pixel as u32 / size.width());
        let ray = camera.ray(size, f64::from(i) + 0.5, f64::from(j) + 0.5);
        let right = match visible_points(volume, planes, ray, farthest_mm) {
            // A shorter interval may lie between two points.
            None => length_mm < 1.1 * APART_MM,
            Some((first_mm, last_mm)) => {
                seen += 1;
                (first_mm - 1.1 * APART_MM..first_mm + 0.1 * APART_MM).contains(depth_mm)
                    && (length_mm - (last_mm - first_mm)).abs() < 2.1 * APART_MM
            }
        };
        wrong += usize::from(!right);
    }
    (wrong, seen)
}

#[test]
fn random_sets_keep_the_points_that_all_planes_keep() {
    let volume = oblique(DVec3::new(3.0, -5.0, 8.0));
    let (center, radius_mm) = volume.bounding_sphere();
    let size = ImageSize::new(SIZE_PX, SIZE_PX).unwrap();
    let mut random = Random(11);
    let cases: Vec<_> = (0..SETS)
        .map(|_| {
            // From outside, and from inside the sphere.
            let back = random.within(0.2, 4.0);
            let eye = center + random.direction() * (radius_mm * back);
            let fov_deg = if back < 1.2 { 90.0 } else { 40.0 };
            let up = random.direction();
            let camera = Camera::look_at(eye, center, up, Lens::Perspective { fov_deg }).unwrap();
            (random_set(&mut random, center, radius_mm), (camera, size))
        })
        .collect();
    let scenes: Vec<Scene> = (cases.iter())
        .flat_map(|(planes, view)| [maximum(), medium()].map(|p| scene(&volume, p, *view, planes)))
        .collect();
    for engine in engines() {
        let frames = engine.frames(&volume, &scenes);
        let (mut all_seen, mut empty, mut caught) = (0, 0, 0);
        for ((planes, view), pair) in cases.iter().zip(frames.chunks(2)) {
            let pair = [&pair[0], &pair[1]];
            let (wrong, seen) = compare(&volume, planes, *view, pair);
            assert_eq!(wrong, 0, "{}: {planes:?} {:?}", engine.name, view.0);
            all_seen += seen;
            empty += usize::from(seen == 0);
            // The control: the points of the set without its first plane, or with it turned.
            let (lost, _) = compare(&volume, &planes[1..], *view, pair);
            let mut turned = planes.clone();
            turned[0] = plane(-planes[0].normal_world(), -planes[0].offset());
            let (turned, _) = compare(&volume, &turned, *view, pair);
            caught += usize::from(lost > 0 || turned > 0);
        }
        assert!(all_seen > 500, "{}: {all_seen}", engine.name);
        assert!((5..SETS - 20).contains(&empty), "{}: {empty}", engine.name);
        assert!(caught > SETS / 3, "{}: {caught}", engine.name);
    }
}
