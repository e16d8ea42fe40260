//! Random volumes and what is seen in them: the phantoms in every voxel type, looked at from
//! anywhere, in every mode. The same number gives the same scene.

use glam::DVec3;

use super::draws::Draws;
use crate::error::Result;
use crate::extent::Dims;
use crate::options::{ErrorBound, ErrorMetric, SceneOptions};
use crate::scene::Mode;
use crate::subject::Subject;
use crate::volume::{PhantomKind, PhantomSpec, Volume, VoxelType, phantom};

/// A random phantom of 24 to 64 voxels along each axis, its voxels a third of the time longer along
/// one axis, half of the time with noise.
///
/// # Errors
/// Not enough memory.
pub fn volume(number: u64) -> Result<(String, Volume)> {
    let mut draws = Draws::new(number);
    let kind = PhantomKind::ALL[number as usize % PhantomKind::ALL.len()];
    let side = |draws: &mut Draws| draws.between(24.0, 65.0) as u64;
    let dims = [side(&mut draws), side(&mut draws), side(&mut draws)];
    let mut spec = PhantomSpec::new(kind, Dims::new(dims)?);
    spec.voxel_type = VoxelType::ALL[draws.below(4) as usize];
    spec.seed = number;
    if draws.one_in(3) {
        spec.spacing_mm = DVec3::new(0.5, 0.5, draws.between(0.5, 2.0));
    }
    if kind != PhantomKind::Noise && draws.one_in(2) {
        spec.noise = draws.by_magnitude(1e-3, 0.1);
    }
    let name = format!("{kind} {}", spec.dims);
    Ok((name, phantom(&spec)?.volume))
}

/// A random view of a volume in a mode, as text of a scene file; of how rays are followed it says
/// nothing.
pub fn view(number: u64, mode: Mode, side_px: u32, subject: &Subject) -> String {
    let mut draws = Draws::new(number);
    let mut text = format!("mode = '{mode}'\nsize = [{side_px}, {side_px}]\n");
    let mut say = |line: String| text.push_str(&(line + "\n"));
    let radius = subject.radius_mm;
    if draws.one_in(4) {
        // From inside, or nearly so.
        let mut point = |reach: f64| {
            let mut coordinate = || radius * reach * draws.between(-1.0, 1.0);
            subject.center_world + DVec3::new(coordinate(), coordinate(), coordinate())
        };
        let (eye, target) = (point(0.6), point(0.5));
        let list = |p: DVec3| format!("[{:?}, {:?}, {:?}]", p.x, p.y, p.z);
        say(format!("eye = {}\ntarget = {}", list(eye), list(target)));
        say(format!("fov = {:?}", draws.between(30.0, 100.0)));
    } else {
        say(format!("azimuth = {:?}", draws.between(-180.0, 180.0)));
        say(format!("elevation = {:?}", draws.between(-90.0, 90.0)));
        say(format!("roll = {:?}", draws.between(-180.0, 180.0)));
        if draws.one_in(3) {
            say(format!("ortho = {:?}", radius * draws.between(0.5, 2.2)));
        } else {
            say(format!("zoom = {:?}", draws.by_magnitude(0.8, 4.0)));
        }
    }
    let range = subject.range;
    match mode {
        Mode::Iso => {
            say(format!("iso = {:?}", range.at(draws.between(0.1, 0.9))));
            if draws.one_in(3) {
                say("shading = 'none'".into());
            }
            if draws.one_in(4) {
                say("caps = 'off'".into());
            }
        }
        Mode::Dvr => {
            say(transfer_function(&mut draws, subject));
            if draws.one_in(3) {
                say("shading = 'phong'".into());
            }
        }
        _ => {
            let (low, high) = (draws.between(0.0, 0.4), draws.between(0.6, 1.0));
            say(format!(
                "window = [{:?}, {:?}]",
                range.at(low),
                range.at(high)
            ));
            if mode == Mode::Lmip {
                let threshold = range.at(draws.between(0.2, 0.9));
                say(format!("lmip-threshold = {threshold:?}"));
            }
        }
    }
    text
}

/// Two to six points from transparent to anything.
fn transfer_function(draws: &mut Draws, subject: &Subject) -> String {
    let count = 2 + (draws.unit() * 5.0) as usize;
    let mut shares: Vec<f64> = (0..count).map(|_| draws.unit()).collect();
    shares.sort_by(f64::total_cmp);
    let mut points = Vec::new();
    for (at, share) in shares.into_iter().enumerate() {
        let opacity = match at {
            0 => 0.0,
            _ => draws.by_magnitude(0.01, 0.95),
        };
        let [r, g, b] = [draws.unit(), draws.unit(), draws.unit()];
        let value = subject.range.at(share);
        points.push(format!("[{value:?}, {r:?}, {g:?}, {b:?}, {opacity:?}]"));
    }
    let unit = subject.radius_mm * draws.by_magnitude(0.02, 0.5);
    format!(
        "tf = {{ unit_length_mm = {unit:?}, points = [{}] }}",
        points.join(", ")
    )
}

/// A random bound of a metric, from what only the finest settings keep to what nearly all do.
///
/// # Errors
/// None in practice: the bounds are in the metrics' domains.
pub fn bound(number: u64, metric: ErrorMetric) -> Result<ErrorBound> {
    let mut draws = Draws::new(number);
    let bound = match metric {
        ErrorMetric::Rmse => draws.by_magnitude(1e-4, 0.05),
        ErrorMetric::Max => draws.by_magnitude(1e-3, 0.3),
        ErrorMetric::P99 => draws.by_magnitude(1e-4, 0.1),
        ErrorMetric::Psnr => draws.between(30.0, 80.0),
        ErrorMetric::Depth => draws.by_magnitude(1e-3, 0.5),
        ErrorMetric::Missed => draws.by_magnitude(1e-4, 0.03),
        ErrorMetric::Value => draws.by_magnitude(1e-4, 0.1),
    };
    ErrorBound::new(metric, bound)
}

/// What a scene's defaults need to know of a volume.
pub fn subject(volume: &Volume) -> Subject {
    let (center_world, radius_mm) = volume.bounding_sphere();
    let range = volume.range();
    Subject {
        center_world,
        radius_mm,
        spacing_mm: volume.geometry().spacing_mm(),
        range,
        robust_range: range,
        otsu: range.at(0.5),
        suggested_iso: range.at(0.5),
    }
}

/// # Errors
/// None in practice: the texts are sound.
pub fn options(text: &str) -> Result<SceneOptions> {
    SceneOptions::parse(text, "the experiment's scene")?.checked()
}
