//! Points of surfaces whose accessibility has a closed form.

use std::f64::consts::PI;
use std::sync::Arc;

use angioray::extent::{Dims, ImageSize};
use angioray::scene::{
    AmbientOcclusion, Camera, ClipPlane, DistanceMm, Lens, Light, Occlusion, OcclusionBy, Phong,
    Picture, RayCount, Refine, Rgb, Sampling, Scene, Share, Tone,
};
use angioray::volume::{Geometry, NonFinite, Rescale, Volume};
use glam::DVec3;

/// A point of a surface, seen in one pixel, with its accessibility.
pub struct Case {
    pub name: String,
    pub volume: Arc<Volume>,
    pub scene: Scene,
    pub accessibility: f64,
}

impl Case {
    fn new(
        name: impl Into<String>,
        volume: &Arc<Volume>,
        [eye, point]: [DVec3; 2],
        distance_mm: f64,
        accessibility: f64,
    ) -> Self {
        Self {
            name: name.into(),
            volume: Arc::clone(volume),
            scene: scene(eye, point, distance_mm),
            accessibility,
        }
    }
}

/// One pixel: the ray from an eye through a point; the iso value is 0.
pub fn scene(eye: DVec3, point: DVec3, distance_mm: f64) -> Scene {
    let up = (point - eye).any_orthonormal_vector();
    let lens = Lens::Orthographic { height_mm: 1e-3 };
    Scene {
        size: ImageSize::new(1, 1).unwrap(),
        camera: Camera::look_at(eye, point, up, lens).unwrap(),
        picture: Picture::Surface {
            iso: 0.0,
            caps: true,
            refine: Refine::default(),
            color: Rgb([0.8, 0.6, 0.4]),
            phong: Some(Phong::default()),
        },
        clip_planes: Vec::new(),
        sampling: Sampling::default(),
        lights: vec![Light::HEADLIGHT],
        ambient_occlusion: Some(occlusion(1024, distance_mm)),
        shadows: None,
        depth_of_field: None,
        depth_cues: None,
        gradient: Default::default(),
        anti_aliasing: Default::default(),
        sparse: None,
        tone: Tone::default(),
    }
}

pub fn occlusion(rays: u32, distance_mm: f64) -> Occlusion {
    let rays = RayCount::new(rays).unwrap();
    occlusion_by(OcclusionBy::Rays(rays), distance_mm)
}

pub fn occlusion_by(by: OcclusionBy, distance_mm: f64) -> Occlusion {
    Occlusion::Volume(AmbientOcclusion {
        by,
        distance: DistanceMm::new(distance_mm).unwrap(),
        strength: Share::default(),
    })
}

/// A volume of unit spacing from a function of the place.
pub fn volume(dims: [u64; 3], f: impl Fn(DVec3) -> f64) -> Arc<Volume> {
    let [nx, ny, nz] = dims;
    let places = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    let voxels: Vec<f32> = places
        .map(|place| f(DVec3::from_array(place.map(|n| n as f64))) as f32)
        .collect();
    let dims = Dims::new(dims).unwrap();
    let geometry = Geometry::default();
    let volume = Volume::new(
        dims,
        voxels.into(),
        geometry,
        Rescale::IDENTITY,
        NonFinite::Refuse,
    );
    Arc::new(volume.unwrap())
}

/// Planes at every tilt: nothing is in the way.
pub fn planes() -> Vec<Case> {
    let center = DVec3::splat(15.3);
    let tilted = |degrees: f64, turn: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let normal = DVec3::new(sin * turn.cos(), sin * turn.sin(), cos);
        let plane = volume([32; 3], |p| (center - p).dot(normal));
        let eye = center + 40.0 * (normal + 0.3 * normal.any_orthonormal_vector());
        Case::new(
            format!("plane at {degrees}"),
            &plane,
            [eye, center],
            30.0,
            1.0,
        )
    };
    [0.0, 10.0, 30.0, 45.0, 60.0, 80.0, 89.0, 90.0]
        .into_iter()
        .enumerate()
        .map(|(n, degrees)| tilted(degrees, 0.4 + n as f64))
        .collect()
}

/// A floor with a wall at its side: of the disc below the hemisphere that part is seen, within a distance R of a point
/// d from the wall, whose share of the way to the wall is below d/R. A half of it where R has no end.
pub fn inside_edge() -> Vec<Case> {
    let (floor, wall) = (10.25, 12.5);
    let corner = volume([60, 40, 60], |p| (floor - p.z).max(wall - p.x));
    let at = |from_wall: f64, distance_mm: f64| {
        let point = DVec3::new(wall + from_wall, 20.0, floor);
        let eye = point + DVec3::new(3.0, 2.0, 9.0);
        let c: f64 = from_wall / distance_mm;
        let share = 0.5 + (c.asin() + c * (1.0 - c * c).sqrt()) / PI;
        let name = format!("inside edge, {from_wall} from the wall, within {distance_mm}");
        Case::new(name, &corner, [eye, point], distance_mm, share)
    };
    let mut cases = vec![at(3.0, 30.0), at(5.0, 15.0), at(6.0, 12.0), at(8.0, 9.0)];
    // What is cut away is in nobody's way.
    let mut cut = at(5.0, 15.0);
    cut.name = "the wall cut away".to_owned();
    let plane = ClipPlane::new(DVec3::X, -(wall + 1.0)).unwrap();
    cut.scene.clip_planes = vec![plane];
    cut.accessibility = 1.0;
    cases.push(cut);
    cases
}

/// Balls: from outside nothing of a ball is in the way of itself; from inside all of it, within a distance R as far as the
/// chords are that short.
pub fn balls() -> Vec<Case> {
    let (center, radius) = (DVec3::splat(20.2), 14.0);
    let ball = volume([41; 3], |p| radius - p.distance(center));
    let toward = DVec3::new(0.3, 0.5, -0.8).normalize();
    let point = center + radius * toward;
    let outside = [center + 40.0 * toward, center];
    let inside = [center - 0.1 * toward, point];
    let within = |distance_mm: f64| {
        let cosine: f64 = distance_mm / (2.0 * radius);
        let name = format!("a ball from inside, within {distance_mm}");
        Case::new(name, &ball, inside, distance_mm, 1.0 - cosine * cosine)
    };
    vec![
        Case::new("a ball from outside", &ball, outside, 50.0, 1.0),
        Case::new("a ball from inside", &ball, inside, 50.0, 0.0),
        within(10.0),
        within(20.0),
    ]
}

/// A tube along y above a plane, of a radius of 5 voxels; x and H are in radii. The share that it keeps from a point is
/// (sin(c + a) − sin(c − a))/2, c = atan(x/H), a = asin(r/√(x² + H²)).
pub fn tubes() -> Vec<Case> {
    let (r, plane) = (5.0, 4.25);
    let at = |x: f64, height: f64| {
        let axis = [15.0, plane + height * r];
        let dims = [
            (2.0 * axis[0] + x * r) as u64 + 8,
            401,
            (axis[1] + r) as u64 + 4,
        ];
        let volume = volume(dims, |p| {
            (plane - p.z).max(r - (p.x - axis[0]).hypot(p.z - axis[1]))
        });
        let point = DVec3::new(axis[0] + x * r, 200.3, plane);
        let eye = point + DVec3::new(0.3, 6.0, 2.0);
        let (c, a) = ((x / height).atan(), (1.0 / x.hypot(height)).asin());
        let share = ((c + a).sin() - (c - a).sin()) / 2.0;
        let name = format!("a tube {x} beside and {height} above");
        Case::new(name, &volume, [eye, point], 400.0, 1.0 - share)
    };
    vec![
        at(0.0, 2.0),
        at(2.0, 2.0),
        at(3.0, 5.0),
        at(5.0, 5.0),
        at(8.0, 2.0),
    ]
}

#[test]
fn the_closed_forms_are_those_of_the_table() {
    let occluded: Vec<f64> = tubes()
        .iter()
        .map(|case| 1.0 - case.accessibility)
        .collect();
    for (share, tabled) in occluded.iter().zip([0.5, 0.25, 0.147, 0.1, 0.029]) {
        assert!((share - tabled).abs() < 6e-4, "{share} {tabled}");
    }
    // The floor of an edge that has no end is half open.
    let far = inside_edge().remove(0).accessibility;
    assert!(far > 0.5 && far < 0.6, "{far}");
}
