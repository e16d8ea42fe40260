//! Volumes, scenes and rays of the tests, and a field evaluated without the renderer's code.

use angioray::extent::{Dims, ImageSize};
use angioray::reference::{RayResult, Tracer};
use angioray::scene::{
    Camera, Emission, Filter, Gradient, Lens, Light, Phong, Picture, Projection, Ray, Refine, Rgb,
    Sampling, Scene, Termination, Tone, TransferFunction, Window,
};
use angioray::volume::{Geometry, NonFinite, Rescale, Volume};
use glam::{DMat3, DQuat, DVec3};

/// An f32 volume with `f` of the index position at every voxel centre.
pub fn volume(dims: [u64; 3], geometry: Geometry, f: impl Fn(DVec3) -> f64) -> Volume {
    let [nx, ny, nz] = dims;
    let mut voxels = Vec::new();
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                voxels.push(f(DVec3::new(x as f64, y as f64, z as f64)) as f32);
            }
        }
    }
    let dims = Dims::new(dims).unwrap();
    Volume::new(
        dims,
        voxels.into(),
        geometry,
        Rescale::IDENTITY,
        NonFinite::Replace,
    )
    .unwrap()
}

/// A volume along x alone: the field is piecewise linear through `values`.
pub fn profile(values: &[f64]) -> Volume {
    let dims = [values.len() as u64, 2, 2];
    volume(dims, Geometry::default(), |p| values[p.x as usize])
}

/// One cell whose field along the main diagonal is the cubic with these Bernstein coefficients.
pub fn diagonal(bernstein: [f64; 4]) -> Volume {
    volume([2, 2, 2], Geometry::default(), |p| {
        bernstein[p.element_sum() as usize]
    })
}

pub const DIAGONAL_MM: f64 = 1.732_050_807_568_877_2;

/// Anisotropic and oblique, its axes not orthogonal, left-handed when `mirrored`.
pub fn oblique(mirrored: bool) -> Geometry {
    let turn = DMat3::from_quat(DQuat::from_axis_angle(
        DVec3::new(1.0, 2.0, -0.5).normalize(),
        0.7,
    ));
    let shear = DMat3::from_cols(
        DVec3::X,
        DVec3::new(0.2, 1.0, 0.0),
        if mirrored { DVec3::NEG_Z } else { DVec3::Z },
    );
    Geometry::new(
        DVec3::new(12.0, -7.0, 30.0),
        turn * shear,
        DVec3::new(0.5, 1.25, 2.0),
    )
    .unwrap()
}

pub fn scene(picture: Picture) -> Scene {
    let lens = Lens::Perspective { fov_deg: 30.0 };
    Scene {
        size: ImageSize::new(8, 8).unwrap(),
        camera: Camera::look_at(DVec3::NEG_Y * 100.0, DVec3::ZERO, DVec3::Z, lens).unwrap(),
        picture,
        clip_planes: Vec::new(),
        sampling: Sampling::default(),
        lights: vec![Light::HEADLIGHT],
        ambient_occlusion: None,
        shadows: None,
        depth_of_field: None,
        depth_cues: None,
        gradient: Gradient::default(),
        anti_aliasing: Default::default(),
        sparse: None,
        tone: Tone::default(),
    }
}

pub fn iso(iso: f64, caps: bool) -> Picture {
    Picture::Surface {
        iso,
        caps,
        refine: Refine::default(),
        color: Rgb([0.8, 0.6, 0.4]),
        phong: None,
    }
}

pub fn projection(of: Projection) -> Picture {
    let window = Window::new(0.0, 10.0).unwrap();
    Picture::Projection { of, window }
}

pub fn dvr(transfer: TransferFunction, phong: Option<Phong>) -> Picture {
    Picture::Emission(Emission {
        phong,
        termination: Termination::new(0.5).unwrap(),
        ..Emission::of(transfer)
    })
}

pub fn cast_scene(volume: &Volume, scene: &Scene, origin: DVec3, toward: DVec3) -> RayResult {
    Tracer::new(volume, scene).unwrap().cast(Ray {
        origin_world: origin,
        dir_world: (toward - origin).normalize(),
    })
}

pub fn cast(volume: &Volume, picture: Picture, origin: DVec3, toward: DVec3) -> RayResult {
    cast_scene(volume, &scene(picture), origin, toward)
}

pub fn cast_nearest(volume: &Volume, picture: Picture, origin: DVec3, toward: DVec3) -> RayResult {
    let mut scene = scene(picture);
    scene.sampling.filter = Filter::Nearest;
    cast_scene(volume, &scene, origin, toward)
}

/// A fixed sequence of numbers in [0, 1).
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn point(&mut self, low: DVec3, high: DVec3) -> DVec3 {
        DVec3::new(
            self.between(low.x, high.x),
            self.between(low.y, high.y),
            self.between(low.z, high.z),
        )
    }

    pub fn direction(&mut self) -> DVec3 {
        loop {
            let p = self.point(DVec3::NEG_ONE, DVec3::ONE);
            if (0.01..1.0).contains(&p.length()) {
                return p.normalize();
            }
        }
    }

    /// White noise, 0..`high`.
    pub fn noise(&mut self, n: u64, geometry: Geometry, high: f64) -> Volume {
        let values: Vec<f64> = (0..n * n * n).map(|_| self.between(0.0, high)).collect();
        let n = n as usize;
        volume([n as u64; 3], geometry, |p| {
            values[p.x as usize + n * (p.y as usize + n * p.z as usize)]
        })
    }
}

/// The last index coordinate of each axis.
pub fn last(volume: &Volume) -> DVec3 {
    DVec3::from_array(volume.dims().array().map(|n| f64::from(n - 1)))
}

/// Φ at an index position inside a volume with at least two voxels an axis, as the weighted sum of
/// eight voxels.
pub fn phi(volume: &Volume, p: DVec3) -> f64 {
    let [nx, ny, nz] = volume.dims().usize();
    let cell = |p: f64, n: usize| (p.floor().max(0.0) as usize).min(n - 2);
    let base = [cell(p.x, nx), cell(p.y, ny), cell(p.z, nz)];
    let mut sum = 0.0;
    for corner in 0..8 {
        let bit = |axis: usize| corner >> axis & 1;
        let weight = |axis: usize| {
            let f = p[axis] - base[axis] as f64;
            if bit(axis) == 1 { f } else { 1.0 - f }
        };
        let index = base[0] + bit(0) + nx * (base[1] + bit(1) + ny * (base[2] + bit(2)));
        let value = volume.rescale().physical(volume.voxels().stored(index));
        sum += value * weight(0) * weight(1) * weight(2);
    }
    sum
}

/// ∇Φ in world space by the contract's central differences.
pub fn gradient(volume: &Volume, p: DVec3) -> DVec3 {
    let gradient = DVec3::from_array([0, 1, 2].map(|axis| {
        let mut e = DVec3::ZERO;
        e[axis] = 1.0;
        let at = |p: DVec3| phi(volume, p.clamp(DVec3::ZERO, last(volume)));
        (at(p + e) - at(p - e)) / 2.0
    }));
    let to_world = volume
        .geometry()
        .world_from_index()
        .matrix3
        .inverse()
        .transpose();
    to_world * gradient
}

/// −∇Φ/|∇Φ|; `otherwise` where it is zero.
pub fn normal(gradient: DVec3, otherwise: DVec3) -> DVec3 {
    if gradient == DVec3::ZERO {
        otherwise
    } else {
        -gradient.normalize()
    }
}

/// Where the ray from `origin` toward `toward` (world) is inside the volume: mm, found by halving,
/// from a point between which is known to be inside.
pub fn path(volume: &Volume, origin: DVec3, toward: DVec3, inside: DVec3) -> (f64, f64) {
    let index = volume.geometry().index_from_world();
    let dir = (toward - origin).normalize();
    let is_in = |t: f64| {
        let p = index.transform_point3(origin + dir * t);
        p.cmpge(DVec3::ZERO).all() && p.cmple(last(volume)).all()
    };
    let middle = (inside - origin).dot(dir);
    assert!(is_in(middle));
    let edge = |mut inner: f64, mut outer: f64| {
        for _ in 0..200 {
            let t = 0.5 * (inner + outer);
            if is_in(t) {
                inner = t;
            } else {
                outer = t;
            }
        }
        inner
    };
    let enter = if is_in(0.0) { 0.0 } else { edge(middle, 0.0) };
    (enter, edge(middle, middle + 1e4))
}

/// A ray through a random inner point of the volume, from outside: origin and that point, world.
pub fn random_ray(random: &mut Random, volume: &Volume) -> (DVec3, DVec3) {
    let world = volume.geometry().world_from_index();
    let (_, radius) = volume.bounding_sphere();
    let inner = random.point(last(volume) * 0.05, last(volume) * 0.95);
    let inner = world.transform_point3(inner);
    (inner + random.direction() * radius * 3.0, inner)
}
