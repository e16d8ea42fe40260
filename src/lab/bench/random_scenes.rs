//! Random volumes and what is seen in them: the phantoms in every voxel type, seen from
//! anywhere, in every mode. The same number gives the same scene.

use glam::DVec3;

use super::rng::Rng;
use crate::error::Result;
use crate::extent::Dims;
use crate::options::{ErrorBound, ErrorMetric, SceneOptions};
use crate::scene::Mode;
use crate::subject::{Content, Sphere, Subject};
use crate::volume::{PhantomKind, PhantomSpec, Volume, VoxelType, phantom};

/// A random phantom of 24 to 64 voxels along each axis, its voxels a third of the time longer along
/// one axis, half of the time with noise.
///
/// # Errors
/// Not enough memory.
pub fn volume(number: u64) -> Result<(String, Volume)> {
    let mut rng = Rng::new(number);
    let kind = PhantomKind::ALL[number as usize % PhantomKind::ALL.len()];
    let side = |rng: &mut Rng| rng.between(24.0, 65.0) as u64;
    let dims = [side(&mut rng), side(&mut rng), side(&mut rng)];
    let mut spec = PhantomSpec::new(kind, Dims::new(dims)?);
    spec.voxel_type = VoxelType::ALL[rng.below(4) as usize];
    spec.seed = number;
    if rng.one_in(3) {
        spec.spacing_mm = DVec3::new(0.5, 0.5, rng.between(0.5, 2.0));
    }
    if kind != PhantomKind::Noise && rng.one_in(2) {
        spec.noise = rng.by_magnitude(1e-3, 0.1);
    }
    let name = format!("{kind} {}", spec.dims);
    Ok((name, phantom(&spec)?.volume))
}

/// A random view of a volume in a mode, as text of a scene file; of how rays are followed it says
/// nothing.
pub fn view(number: u64, mode: Mode, side_px: u32, subject: &Subject) -> String {
    let mut rng = Rng::new(number);
    let mut text = format!("mode = '{mode}'\nsize = [{side_px}, {side_px}]\n");
    let mut add = |line: String| text.push_str(&(line + "\n"));
    let radius = subject.sphere.radius_mm;
    if rng.one_in(4) {
        // From inside, or nearly so.
        let mut point = |radii: f64| {
            let mut coordinate = || radius * radii * rng.between(-1.0, 1.0);
            subject.sphere.center_world + DVec3::new(coordinate(), coordinate(), coordinate())
        };
        let (eye, target) = (point(0.6), point(0.5));
        let list = |p: DVec3| format!("[{:?}, {:?}, {:?}]", p.x, p.y, p.z);
        add(format!("eye = {}\ntarget = {}", list(eye), list(target)));
        add(format!("fov = {:?}", rng.between(30.0, 100.0)));
    } else {
        add(format!("azimuth = {:?}", rng.between(-180.0, 180.0)));
        add(format!("elevation = {:?}", rng.between(-90.0, 90.0)));
        add(format!("roll = {:?}", rng.between(-180.0, 180.0)));
        if rng.one_in(3) {
            add(format!("ortho = {:?}", radius * rng.between(0.5, 2.2)));
        } else {
            add(format!("zoom = {:?}", rng.by_magnitude(0.8, 4.0)));
        }
    }
    let range = subject.range;
    match mode {
        Mode::Iso => {
            add(format!("iso = {:?}", range.at(rng.between(0.1, 0.9))));
            if rng.one_in(3) {
                add("shading = 'none'".into());
            }
            if rng.one_in(4) {
                add("caps = 'off'".into());
            }
        }
        Mode::Dvr => {
            add(transfer_function(&mut rng, subject));
            if rng.one_in(3) {
                add("shading = 'phong'".into());
            }
        }
        _ => {
            let (low, high) = (rng.between(0.0, 0.4), rng.between(0.6, 1.0));
            add(format!(
                "window = [{:?}, {:?}]",
                range.at(low),
                range.at(high)
            ));
            if mode == Mode::Lmip {
                let threshold = range.at(rng.between(0.2, 0.9));
                add(format!("lmip-threshold = {threshold:?}"));
            }
        }
    }
    text
}

/// Two to six points from transparent to anything.
fn transfer_function(rng: &mut Rng, subject: &Subject) -> String {
    let count = 2 + (rng.unit() * 5.0) as usize;
    let mut shares: Vec<f64> = (0..count).map(|_| rng.unit()).collect();
    shares.sort_by(f64::total_cmp);
    let mut points = Vec::new();
    for (at, share) in shares.into_iter().enumerate() {
        let opacity = match at {
            0 => 0.0,
            _ => rng.by_magnitude(0.01, 0.95),
        };
        let [r, g, b] = [rng.unit(), rng.unit(), rng.unit()];
        let value = subject.range.at(share);
        points.push(format!("[{value:?}, {r:?}, {g:?}, {b:?}, {opacity:?}]"));
    }
    let unit = subject.sphere.radius_mm * rng.by_magnitude(0.02, 0.5);
    format!(
        "tf = {{ unit_length_mm = {unit:?}, points = [{}] }}",
        points.join(", ")
    )
}

/// A random bound of a metric, from what only the finest settings keep to what nearly all do.
///
/// # Errors
/// The bound is outside the metric's domain, which no number gives.
pub fn bound(number: u64, metric: ErrorMetric) -> Result<ErrorBound> {
    let mut rng = Rng::new(number);
    let bound = match metric {
        ErrorMetric::Rmse => rng.by_magnitude(1e-4, 0.05),
        ErrorMetric::Max => rng.by_magnitude(1e-3, 0.3),
        ErrorMetric::P99 => rng.by_magnitude(1e-4, 0.1),
        ErrorMetric::Psnr => rng.between(30.0, 80.0),
        ErrorMetric::Depth => rng.by_magnitude(1e-3, 0.5),
        ErrorMetric::Missed => rng.by_magnitude(1e-4, 0.03),
        ErrorMetric::Value => rng.by_magnitude(1e-4, 0.1),
    };
    ErrorBound::new(metric, bound)
}

/// The properties of a volume from which a scene's defaults are made.
pub fn subject(volume: &Volume) -> Subject {
    let sphere = Sphere::from(volume.bounding_sphere());
    let range = volume.range();
    Subject {
        sphere,
        content: Content::around(sphere),
        spacing_mm: volume.geometry().spacing_mm(),
        range,
        robust_range: range,
        otsu: range.at(0.5),
        suggested_iso: range.at(0.5),
    }
}

/// Parses the text of a random scene.
///
/// # Errors
/// The text does not parse, or its options contradict each other.
pub fn options(text: &str) -> Result<SceneOptions> {
    SceneOptions::parse(text, "the experiment's scene")?.checked()
}
