//! The device against the double-precision reference: every picture, filter, lens, voxel type and
//! kind of geometry. All limits are in [`ROWS`]; each must be broken by the same picture moved by
//! one pixel. `cargo nextest run --test device --no-capture agreement:: | grep '|'` prints what is measured.

use crate::common;

use angioray::extent::Dims;
use angioray::frame::Frame;
use angioray::scene::{
    Brightness, Camera, ClipPlane, Contrast, Emission, Filter, Gamma, Gradient, Intensity, Knot,
    Lens, Light, Phong, Picture, Projection, Quadrature, Reflection, Rgb, Scene, ShadedFrom,
    StepVoxels, Termination, Tone, TransferFunction, Window,
};
use angioray::volume::{Geometry, NonFinite, Rescale, Volume, Voxels};
use common::Figure::{
    AlphaMax, ColorMax, ColorMean, ColorP99, DepthMean, DepthP99, Kind, NormalMean, NormalP99,
    ValueMax, ValueMean,
};
use common::{Figure, hash, moved_by_a_pixel, on_device, on_reference};
use glam::{DMat3, DQuat, DVec3};

const SIZE_PX: u32 = 56;

#[derive(Debug, Clone, Copy)]
enum Shown {
    Iso {
        refine: &'static str,
        caps: bool,
    },
    Mip,
    Minip,
    Mean,
    Lmip,
    /// By the default rule; by another.
    Dvr,
    DvrBy(&'static str),
}

#[derive(Debug, Clone, Copy)]
enum From {
    Outside,
    Inside,
    Orthographic,
}

/// What lights a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Lit {
    AtEye,
    /// From far away, fixed to the patient; to the camera.
    Side,
    Camera,
    /// From a point among what is seen.
    Near,
    /// From four of all kinds and colours, on a material with colours of its own.
    Four,
}

impl Lit {
    fn lights(self, volume: &Volume) -> Vec<Light> {
        let (center, radius_mm) = volume.bounding_sphere();
        let side = Light::distant(DVec3::new(0.36, -0.48, 0.8)).unwrap();
        let camera = Light::of_camera(DVec3::new(-0.7, 0.6, 0.4)).unwrap();
        let near = center + DVec3::new(0.1, -0.4, 0.3) * radius_mm;
        let near = Light::point(near).unwrap();
        let tinted = |light: Light, color: &str| Light {
            color: color.parse().unwrap(),
            intensity: Intensity::new(0.6).unwrap(),
            ..light
        };
        match self {
            Self::AtEye => vec![Light::HEADLIGHT],
            Self::Side => vec![side],
            Self::Camera => vec![camera],
            Self::Near => vec![near],
            Self::Four => vec![
                tinted(side, "red"),
                tinted(camera, "#80ff40"),
                tinted(near, "0.2,0.3,1"),
                tinted(Light::HEADLIGHT, "ivory"),
            ],
        }
    }

    fn phong(self, reflection: Reflection) -> Phong {
        let white = Phong {
            reflection,
            ..Phong::default()
        };
        match self {
            Self::Four => Phong {
                ambient_color: Rgb([0.2, 0.4, 1.0]),
                diffuse_color: Rgb([1.0, 0.9, 0.7]),
                specular_color: Rgb([0.5, 1.0, 0.8]),
                ..white
            },
            _ => white,
        }
    }
}

/// One picture of one volume, and how far each of its planes may be from the reference's.
#[derive(Clone, Copy)]
struct Row {
    volume: &'static str,
    shown: Shown,
    /// `None`: no shading.
    reflection: Option<Reflection>,
    lit: Lit,
    /// The gradient from which a medium is shaded fully, as a share of the range per voxel.
    shaded_from: f64,
    from: From,
    /// Of planes about the volume's centre: the normal, and how far, in radii of the bounding
    /// sphere, the plane lies beyond it.
    clip: &'static [([f64; 3], f64)],
    gradient: Gradient,
    filter: Filter,
    step_voxels: f64,
    /// Brightness, contrast, gamma, background.
    tone: (f64, f64, f64, [f64; 3]),
    limits: &'static [(Figure, f64)],
}

const PLAIN: Row = Row {
    volume: "u8",
    shown: ISO,
    reflection: None,
    lit: Lit::AtEye,
    shaded_from: 0.0,
    from: From::Outside,
    clip: &[],
    gradient: Gradient::Central,
    filter: Filter::Linear,
    step_voxels: 0.5,
    tone: (0.0, 1.0, 1.0, [0.0; 3]),
    limits: &[],
};
const ISO: Shown = Shown::Iso {
    refine: "regula-falsi",
    caps: true,
};
const fn iso(refine: &'static str, caps: bool) -> Shown {
    Shown::Iso { refine, caps }
}
const PHONG: Option<Reflection> = Some(Reflection::Phong);
const BLINN: Option<Reflection> = Some(Reflection::BlinnPhong);
/// A wedge: one plane cuts away the near side, one the upper.
const WEDGE: &[([f64; 3], f64)] = &[([-0.4, -0.9, 0.3], 0.1), ([0.02, 0.01, -0.05], 0.2)];

#[rustfmt::skip]
const ROWS: &[Row] = &[
    // The refiners, as accurate as their iterations.
    Row { shown: iso("none", true), limits: &[(Kind, 0.002), (DepthMean, 0.3)], ..PLAIN },
    Row { shown: iso("bisection", true), limits: &[(Kind, 0.002), (DepthMean, 0.01)], ..PLAIN },
    Row { shown: iso("regula-falsi", true), limits: &[(Kind, 0.002), (DepthMean, 1e-4), (DepthP99, 1e-3), (NormalMean, 0.01), (NormalP99, 0.01), (ValueMean, 1e-5)], ..PLAIN },
    Row { shown: iso("illinois", true), limits: &[(Kind, 0.002), (DepthMean, 1e-4), (DepthP99, 1e-3)], ..PLAIN },
    Row { shown: iso("newton", true), limits: &[(Kind, 0.002), (DepthMean, 0.002), (DepthP99, 0.03)], ..PLAIN },
    // Caps, eyes, lenses, filter.
    Row { shown: iso("regula-falsi", false), limits: &[(Kind, 0.002), (DepthP99, 1e-3), (NormalMean, 0.01)], ..PLAIN },
    // Two grazing rays of 3,136 pass a ridge that the steps do not see and hit what is behind it.
    Row { from: From::Inside, limits: &[(Kind, 0.002), (DepthMean, 0.02), (DepthP99, 1e-3), (NormalMean, 0.2)], ..PLAIN },
    Row { shown: iso("regula-falsi", false), from: From::Inside, limits: &[(Kind, 0.002), (DepthP99, 1e-3)], ..PLAIN },
    Row { from: From::Orthographic, limits: &[(Kind, 0.002), (DepthP99, 1e-3), (NormalMean, 0.01)], ..PLAIN },
    // Corners of voxels are clipped; normals jump where voxels meet, which is where the surface is.
    Row { filter: Filter::Nearest, limits: &[(Kind, 0.006), (DepthMean, 0.06), (NormalMean, 6.0)], ..PLAIN },
    // Cut open.
    Row { clip: WEDGE, reflection: PHONG, limits: &[(Kind, 0.002), (DepthMean, 2e-4), (DepthP99, 1e-3), (NormalMean, 0.01), (ColorMean, 1e-4)], ..PLAIN },
    Row { clip: WEDGE, shown: iso("regula-falsi", false), from: From::Inside, limits: &[(Kind, 0.002), (DepthP99, 1e-3)], ..PLAIN },
    Row { clip: WEDGE, shown: Shown::Mip, from: From::Orthographic, limits: &[(Kind, 0.001), (ValueMean, 0.001), (DepthMean, 0.3)], ..PLAIN },
    Row { clip: WEDGE, shown: Shown::Mean, step_voxels: 0.25, limits: &[(ValueMean, 3e-4), (ValueMax, 0.005)], ..PLAIN },
    Row { clip: WEDGE, shown: Shown::Dvr, limits: &[(AlphaMax, 0.006), (ColorMax, 0.015)], ..PLAIN },
    Row { volume: "u16", clip: WEDGE, limits: &[(Kind, 0.002), (DepthP99, 1e-3), (NormalMean, 0.01)], ..PLAIN },
    Row { volume: "falling", clip: WEDGE, shown: Shown::Dvr, reflection: PHONG, step_voxels: 0.25, limits: &[(ColorMax, 0.02)], ..PLAIN },
    // Gradients.
    Row { gradient: Gradient::Forward, reflection: PHONG, limits: &[(NormalMean, 0.01), (NormalP99, 0.01), (ColorMean, 1e-5)], ..PLAIN },
    Row { gradient: Gradient::FourthOrder, reflection: PHONG, limits: &[(NormalMean, 0.01), (NormalP99, 0.01), (ColorMean, 1e-5)], ..PLAIN },
    Row { gradient: Gradient::FourthOrder, filter: Filter::Nearest, limits: &[(NormalMean, 6.0)], ..PLAIN },
    Row { gradient: Gradient::Forward, shown: Shown::Dvr, reflection: PHONG, step_voxels: 0.25, limits: &[(ColorMax, 0.02)], ..PLAIN },
    Row { volume: "u16", gradient: Gradient::FourthOrder, limits: &[(NormalMean, 0.01)], ..PLAIN },
    Row { volume: "i16", gradient: Gradient::FourthOrder, shown: Shown::Dvr, reflection: PHONG, step_voxels: 0.25, limits: &[(ColorMax, 0.02)], ..PLAIN },
    Row { volume: "falling", gradient: Gradient::Forward, limits: &[(NormalMean, 0.01)], ..PLAIN },
    Row { volume: "sheet", gradient: Gradient::FourthOrder, shown: iso("regula-falsi", false), limits: &[(NormalMean, 0.01)], ..PLAIN },
    // Shading and tone.
    Row { limits: &[(ColorMean, 1e-5)], ..PLAIN },
    Row { reflection: PHONG, limits: &[(ColorP99, 1e-4), (ColorMean, 1e-5)], ..PLAIN },
    Row { reflection: BLINN, limits: &[(ColorP99, 1e-4), (ColorMean, 1e-5)], ..PLAIN },
    Row { reflection: PHONG, lit: Lit::Side, limits: &[(ColorP99, 1e-4), (ColorMean, 1e-5)], ..PLAIN },
    Row { reflection: BLINN, lit: Lit::Side, limits: &[(ColorP99, 1e-4), (ColorMean, 1e-5)], ..PLAIN },
    Row { reflection: PHONG, lit: Lit::Camera, limits: &[(ColorP99, 1e-4), (ColorMean, 1e-5)], ..PLAIN },
    Row { reflection: BLINN, lit: Lit::Near, limits: &[(ColorP99, 2e-4), (ColorMean, 2e-5)], ..PLAIN },
    Row { reflection: PHONG, lit: Lit::Near, from: From::Orthographic, limits: &[(ColorP99, 2e-4), (ColorMean, 2e-5)], ..PLAIN },
    Row { reflection: PHONG, lit: Lit::Four, from: From::Inside, limits: &[(ColorP99, 2e-4)], ..PLAIN },
    Row { reflection: PHONG, lit: Lit::Four, clip: WEDGE, limits: &[(ColorP99, 2e-4), (ColorMean, 1e-4)], ..PLAIN },
    Row { volume: "u16", reflection: BLINN, lit: Lit::Four, limits: &[(ColorP99, 2e-4)], ..PLAIN },
    Row { volume: "i16", reflection: PHONG, lit: Lit::Near, limits: &[(ColorP99, 2e-4)], ..PLAIN },
    Row { volume: "falling", reflection: PHONG, lit: Lit::Four, limits: &[(ColorP99, 2e-4)], ..PLAIN },
    Row { reflection: PHONG, tone: (0.1, 1.3, 2.2, [0.1, 0.3, 0.7]), limits: &[(ColorP99, 1e-4), (ColorMean, 1e-5)], ..PLAIN },
    Row { shown: Shown::Dvr, tone: (-0.1, 0.7, 0.6, [0.9, 0.2, 0.5]), limits: &[(ColorMax, 0.01)], ..PLAIN },
    // Projections.
    Row { shown: Shown::Mip, limits: &[(Kind, 0.0), (ValueMean, 0.001), (DepthMean, 0.3), (ColorMean, 5e-4)], ..PLAIN },
    Row { shown: Shown::Minip, limits: &[(ValueMean, 0.001)], ..PLAIN },
    Row { shown: Shown::Mean, limits: &[(ValueMean, 3e-4), (ValueMax, 0.005)], ..PLAIN },
    Row { shown: Shown::Lmip, limits: &[(ValueMean, 0.004), (DepthMean, 0.5)], ..PLAIN },
    Row { shown: Shown::Mip, from: From::Inside, limits: &[(ValueMean, 0.001)], ..PLAIN },
    Row { shown: Shown::Mip, from: From::Orthographic, limits: &[(ValueMean, 0.001)], ..PLAIN },
    Row { shown: Shown::Mip, filter: Filter::Nearest, step_voxels: 0.125, limits: &[(ValueMean, 0.005)], ..PLAIN },
    Row { shown: Shown::Mean, filter: Filter::Nearest, step_voxels: 0.125, limits: &[(ValueMean, 0.002)], ..PLAIN },
    // Emission.
    Row { shown: Shown::Dvr, limits: &[(AlphaMax, 0.006), (ColorMax, 0.015)], ..PLAIN },
    Row { shown: Shown::Dvr, step_voxels: 0.25, limits: &[(AlphaMax, 0.004), (ColorMax, 0.008)], ..PLAIN },
    Row { shown: Shown::Dvr, from: From::Inside, limits: &[(AlphaMax, 0.006), (ColorMax, 0.015)], ..PLAIN },
    Row { shown: Shown::Dvr, from: From::Orthographic, limits: &[(AlphaMax, 0.006), (ColorMax, 0.015)], ..PLAIN },
    Row { shown: Shown::Dvr, reflection: PHONG, step_voxels: 0.25, limits: &[(ColorMax, 0.02)], ..PLAIN },
    // The light goes out at once where normals turn from it: fine steps find where.
    Row { shown: Shown::Dvr, reflection: BLINN, lit: Lit::Side, step_voxels: 0.25, limits: &[(ColorP99, 0.01), (ColorMax, 0.05)], ..PLAIN },
    Row { shown: Shown::Dvr, reflection: BLINN, lit: Lit::Side, step_voxels: 0.0625, limits: &[(ColorMax, 0.01)], ..PLAIN },
    Row { shown: Shown::Dvr, reflection: PHONG, lit: Lit::Camera, step_voxels: 0.0625, limits: &[(ColorMax, 0.01)], ..PLAIN },
    Row { shown: Shown::Dvr, reflection: PHONG, lit: Lit::Near, step_voxels: 0.0625, limits: &[(ColorMax, 0.01)], ..PLAIN },
    Row { shown: Shown::Dvr, reflection: BLINN, lit: Lit::Four, step_voxels: 0.0625, limits: &[(ColorMax, 0.01)], ..PLAIN },
    Row { shown: Shown::Dvr, reflection: PHONG, lit: Lit::Four, shaded_from: 0.1, step_voxels: 0.0625, limits: &[(ColorMax, 0.01)], ..PLAIN },
    Row { shown: Shown::DvrBy("adaptive"), reflection: PHONG, lit: Lit::Four, shaded_from: 0.1, from: From::Orthographic, limits: &[(ColorMax, 0.01)], ..PLAIN },
    Row { volume: "u16", shown: Shown::Dvr, reflection: PHONG, lit: Lit::Near, shaded_from: 0.05, step_voxels: 0.0625, limits: &[(ColorMax, 0.01)], ..PLAIN },
    Row { volume: "falling", shown: Shown::DvrBy("adaptive"), reflection: BLINN, lit: Lit::Four, shaded_from: 0.1, clip: WEDGE, limits: &[(ColorMax, 0.01)], ..PLAIN },
    Row { shown: Shown::Dvr, filter: Filter::Nearest, step_voxels: 0.125, limits: &[(AlphaMax, 0.03)], ..PLAIN },
    // Its layers, by every rule; pixels at the opacity from which there are any may have them or not.
    Row { shown: Shown::DvrBy("riemann"), step_voxels: 0.25, limits: &[(Kind, 0.003), (DepthMean, 0.2), (NormalMean, 3.0), (ValueMean, 0.008)], ..PLAIN },
    Row { shown: Shown::DvrBy("midpoint"), step_voxels: 0.25, limits: &[(Kind, 0.002), (DepthMean, 0.006), (DepthP99, 0.04), (NormalMean, 0.4), (ValueMean, 1e-3)], ..PLAIN },
    Row { shown: Shown::DvrBy("simpson"), limits: &[(Kind, 0.002), (DepthMean, 0.006), (DepthP99, 0.04), (NormalMean, 0.6), (ValueMean, 1e-3)], ..PLAIN },
    Row { shown: Shown::DvrBy("romberg"), limits: &[(Kind, 0.002), (DepthMean, 0.002), (DepthP99, 0.01), (NormalMean, 0.2), (ValueMean, 2e-4)], ..PLAIN },
    Row { shown: Shown::DvrBy("rk4"), limits: &[(Kind, 0.002), (DepthMean, 0.006), (DepthP99, 0.04), (NormalMean, 0.6), (ValueMean, 1e-3)], ..PLAIN },
    Row { shown: Shown::DvrBy("preintegrated"), step_voxels: 0.25, limits: &[(Kind, 0.002), (DepthMean, 0.006), (DepthP99, 0.04), (NormalMean, 0.4), (ValueMean, 1e-3)], ..PLAIN },
    Row { shown: Shown::DvrBy("adaptive"), limits: &[(Kind, 0.001), (DepthMean, 1e-4), (DepthP99, 1e-3), (NormalMean, 0.3), (ValueMean, 1e-5)], ..PLAIN },
    Row { shown: Shown::DvrBy("adaptive:1e-5"), limits: &[(Kind, 0.001), (DepthMean, 5e-5), (DepthP99, 2e-4), (NormalMean, 0.1), (ValueMean, 1e-6)], ..PLAIN },
    Row { shown: Shown::DvrBy("adaptive"), filter: Filter::Nearest, limits: &[(Kind, 0.001), (DepthMean, 1e-4), (NormalMean, 0.01), (ValueMean, 1e-6)], ..PLAIN },
    Row { shown: Shown::DvrBy("adaptive"), from: From::Inside, reflection: PHONG, gradient: Gradient::FourthOrder, limits: &[(DepthMean, 1e-4), (NormalMean, 0.1), (ValueMean, 1e-5)], ..PLAIN },
    Row { volume: "u16", shown: Shown::DvrBy("adaptive"), limits: &[(Kind, 0.001), (DepthMean, 1e-4), (NormalMean, 0.3), (ValueMean, 1e-5)], ..PLAIN },
    Row { volume: "falling", shown: Shown::DvrBy("adaptive"), clip: WEDGE, limits: &[(Kind, 0.001), (DepthMean, 1e-4), (NormalMean, 0.4), (ValueMean, 1e-5)], ..PLAIN },
    Row { volume: "f32", shown: Shown::DvrBy("romberg"), from: From::Orthographic, limits: &[(Kind, 0.002), (DepthMean, 0.005), (NormalMean, 0.2), (ValueMean, 2e-4)], ..PLAIN },
    // Spacing 1:1:10, oblique; the calibration of a CT scanner.
    Row { volume: "u16", reflection: PHONG, limits: &[(Kind, 0.002), (DepthP99, 1e-3), (NormalMean, 0.01), (ColorP99, 1e-4)], ..PLAIN },
    Row { volume: "u16", shown: Shown::Mip, limits: &[(ValueMean, 0.001)], ..PLAIN },
    Row { volume: "u16", shown: Shown::Mean, limits: &[(ValueMean, 0.001)], ..PLAIN },
    Row { volume: "u16", shown: Shown::Dvr, limits: &[(AlphaMax, 0.006), (ColorMax, 0.015)], ..PLAIN },
    // Left-handed, signed.
    Row { volume: "i16", reflection: PHONG, lit: Lit::Side, limits: &[(Kind, 0.002), (DepthP99, 1e-3), (NormalMean, 0.01), (ColorP99, 1e-4)], ..PLAIN },
    Row { volume: "i16", shown: Shown::Mip, from: From::Orthographic, limits: &[(ValueMean, 0.001)], ..PLAIN },
    Row { volume: "i16", shown: Shown::Dvr, limits: &[(AlphaMax, 0.006), (ColorMax, 0.015)], ..PLAIN },
    // Sheared axes; the calibration falls, so that the voxels are stored negated.
    Row { volume: "falling", reflection: PHONG, limits: &[(Kind, 0.002), (DepthP99, 1e-3), (NormalMean, 0.01), (ColorP99, 1e-4)], ..PLAIN },
    Row { volume: "falling", shown: Shown::Lmip, limits: &[(ValueMean, 0.004)], ..PLAIN },
    Row { volume: "falling", shown: Shown::Minip, limits: &[(ValueMean, 0.001)], ..PLAIN },
    Row { volume: "falling", shown: Shown::Dvr, reflection: PHONG, step_voxels: 0.25, limits: &[(ColorMax, 0.02)], ..PLAIN },
    // Smooth floats.
    Row { volume: "f32", reflection: PHONG, limits: &[(Kind, 0.002), (DepthP99, 1e-3), (NormalMean, 0.01), (ColorP99, 1e-4)], ..PLAIN },
    Row { volume: "f32", shown: Shown::Mip, limits: &[(ValueMean, 0.001)], ..PLAIN },
    Row { volume: "f32", shown: Shown::Dvr, limits: &[(AlphaMax, 0.005), (ColorMax, 0.01)], ..PLAIN },
    // One voxel thick.
    Row { volume: "sheet", shown: iso("regula-falsi", false), reflection: PHONG, limits: &[(Kind, 0.002), (DepthP99, 1e-3), (ColorP99, 1e-4)], ..PLAIN },
    Row { volume: "sheet", limits: &[(Kind, 0.002), (DepthP99, 1e-3)], ..PLAIN },
    Row { volume: "sheet", shown: Shown::Mip, limits: &[(ValueMean, 0.001)], ..PLAIN },
    Row { volume: "sheet", shown: Shown::Mean, limits: &[(ValueMean, 0.001)], ..PLAIN },
    Row { volume: "sheet", shown: Shown::Dvr, limits: &[(AlphaMax, 0.01)], ..PLAIN },
];

/// Curved vessels over faint noise, 0..1; `p` in 0..1.
fn vessels(p: DVec3, noise: f64) -> f64 {
    let tube = |cx: f64, cz: f64, r: f64| {
        let bend = DVec3::new(0.12 * (p.y * 5.0).sin(), 0.0, 0.1 * (p.y * 7.0).cos());
        let d = (p.x - cx - bend.x).hypot(p.z - cz - bend.z);
        ((r - d) / 0.06 + 0.5).clamp(0.0, 1.0)
    };
    let bright = tube(0.3, 0.35, 0.09)
        .max(tube(0.65, 0.6, 0.06))
        .max(tube(0.5, 0.5, 0.16) * 0.7);
    0.92 * bright + 0.06 * noise
}

fn built<T>(
    dims: [u64; 3],
    geometry: Geometry,
    rescale: Rescale,
    voxel: impl Fn(f64) -> T,
) -> Volume
where
    Voxels: std::convert::From<Vec<T>>,
{
    let last = DVec3::from_array(dims.map(|n| (n as f64 - 1.0).max(1.0)));
    let mut voxels = Vec::new();
    for z in 0..dims[2] {
        for y in 0..dims[1] {
            for x in 0..dims[0] {
                let p = DVec3::new(x as f64, y as f64, z as f64);
                let middle = DVec3::from_array(dims.map(|n| if n == 1 { 0.5 } else { 0.0 }));
                voxels.push(voxel(vessels(p / last + middle, hash(p.x, p.y, p.z))));
            }
        }
    }
    let dims = Dims::new(dims).unwrap();
    Volume::new(
        dims,
        Voxels::from(voxels),
        geometry,
        rescale,
        NonFinite::Refuse,
    )
    .unwrap()
}

/// Turned about no axis of the grid; left-handed where `mirrored`; its axes not orthogonal by `shear`.
fn geometry(spacing_mm: [f64; 3], mirrored: bool, shear: f64) -> Geometry {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.7);
    let z = if mirrored { DVec3::NEG_Z } else { DVec3::Z };
    let axes = DMat3::from_cols(DVec3::X, DVec3::new(shear, 1.0, 0.0), z);
    let direction = DMat3::from_quat(turn) * axes;
    Geometry::new(DVec3::new(-120.0, 80.0, 35.0), direction, spacing_mm.into()).unwrap()
}

fn volume(name: &str) -> Volume {
    let rescale = |slope, intercept| Rescale { slope, intercept };
    let upright = Geometry::default();
    match name {
        "u8" => built([37, 29, 34], upright, Rescale::IDENTITY, |v| {
            (255.0 * v) as u8
        }),
        "sheet" => built([33, 1, 29], upright, rescale(0.5, 3.0), |v| {
            (255.0 * v) as u8
        }),
        "u16" => built(
            [35, 30, 9],
            geometry([0.7, 0.7, 7.0], false, 0.0),
            rescale(0.25, -1024.0),
            |v| (9000.0 * v) as u16,
        ),
        "i16" => built(
            [31, 33, 27],
            geometry([0.4, 0.6, 0.9], true, 0.0),
            rescale(2.0, -50.0),
            |v| (1400.0 * v - 700.0) as i16,
        ),
        "falling" => built(
            [26, 23, 29],
            geometry([1.5, 1.0, 1.2], true, 0.2),
            rescale(-0.5, 100.0),
            |v| (700.0 - 1400.0 * v) as i16,
        ),
        "f32" => built(
            [30, 31, 33],
            geometry([1.0; 3], false, 0.0),
            rescale(1e-3, 5.0),
            |v| (40.0 * (v * 2.0).tanh()) as f32,
        ),
        other => panic!("no volume {other}"),
    }
}

fn camera(volume: &Volume, from: From) -> Camera {
    let (center, radius_mm) = volume.bounding_sphere();
    let toward_eye = -common::OBLIQUE.normalize();
    let shown = |distance_mm: f64, lens| {
        let eye = center + toward_eye * distance_mm;
        Camera::look_at(eye, eye - toward_eye, DVec3::Z, lens).unwrap()
    };
    match from {
        From::Outside => shown(radius_mm * 3.5, Lens::Perspective { fov_deg: 30.0 }),
        From::Inside => shown(radius_mm * 0.31, Lens::Perspective { fov_deg: 80.0 }),
        From::Orthographic => shown(
            radius_mm * 2.0,
            Lens::Orthographic {
                height_mm: radius_mm * 1.7,
            },
        ),
    }
}

fn picture(row: &Row, volume: &Volume) -> Picture {
    let range = volume.range();
    let window = Window::new(range.at(0.05), range.at(0.95)).unwrap();
    let phong = row.reflection.map(|reflection| row.lit.phong(reflection));
    let projection = |of| Picture::Projection { of, window };
    match row.shown {
        Shown::Iso { refine, caps } => Picture::Surface {
            iso: range.at(0.43),
            caps,
            refine: refine.parse().unwrap(),
            color: Rgb([0.9, 0.7, 0.4]),
            phong,
        },
        Shown::Mip => projection(Projection::Maximum),
        Shown::Minip => projection(Projection::Minimum),
        Shown::Mean => projection(Projection::Mean),
        Shown::Lmip => projection(Projection::LocalMaximum {
            threshold: range.at(0.4),
        }),
        Shown::Dvr | Shown::DvrBy(_) => {
            let quadrature = match row.shown {
                Shown::DvrBy(rule) => rule.parse().unwrap(),
                _ => Quadrature::default(),
            };
            let knot = |at, color, opacity| Knot {
                value: range.at(at),
                color: Rgb(color),
                opacity,
            };
            let knots = vec![
                knot(0.1, [0.1, 0.1, 0.4], 0.0),
                knot(0.5, [0.9, 0.3, 0.1], 0.2),
                knot(0.8, [1.0, 0.9, 0.8], 0.6),
            ];
            let per_voxel = range.width() / volume.geometry().smallest_spacing_mm();
            let unit_mm = 2.0 * volume.geometry().smallest_spacing_mm();
            let transfer = TransferFunction::new(knots, unit_mm).unwrap();
            Picture::Emission(Emission {
                phong,
                shaded_from: ShadedFrom::new(row.shaded_from * per_voxel).unwrap(),
                quadrature,
                termination: Termination::NEVER,
                ..Emission::of(transfer)
            })
        }
    }
}

fn scene(row: &Row, volume: &Volume) -> Scene {
    let mut scene = common::scene(volume, SIZE_PX, picture(row, volume));
    scene.camera = camera(volume, row.from);
    let (center, radius_mm) = volume.bounding_sphere();
    let plane = |&(normal, beyond): &([f64; 3], f64)| {
        let normal = DVec3::from_array(normal);
        let offset = normal.length() * beyond * radius_mm - normal.dot(center);
        ClipPlane::new(normal, offset).unwrap()
    };
    scene.clip_planes = row.clip.iter().map(plane).collect();
    scene.gradient = row.gradient;
    scene.sampling.filter = row.filter;
    scene.sampling.step = StepVoxels::new(row.step_voxels).unwrap();
    scene.lights = row.lit.lights(volume);
    let (brightness, contrast, gamma, background) = row.tone;
    scene.tone = Tone {
        background: Rgb(background),
        brightness: Brightness::new(brightness).unwrap(),
        contrast: Contrast::new(contrast).unwrap(),
        gamma: Gamma::new(gamma).unwrap(),
    };
    scene
}

fn describe(row: &Row) -> String {
    format!(
        "{} {:?} {:?} {:?} from {} {:?} {} planes {:?} {:?} step {}",
        row.volume,
        row.shown,
        row.reflection,
        row.lit,
        row.shaded_from,
        row.from,
        row.clip.len(),
        row.gradient,
        row.filter,
        row.step_voxels
    )
}

/// Renders a volume's rows; all broken limits are reported at once.
fn check(name: &str) {
    let Some(device) = common::device() else {
        return;
    };
    let volume = volume(name);
    let rows: Vec<&Row> = ROWS.iter().filter(|row| row.volume == name).collect();
    let scenes: Vec<Scene> = rows.iter().map(|row| scene(row, &volume)).collect();
    let frames: Vec<Frame> = on_device(&device, &volume, &scenes);
    let mut wrong = Vec::new();
    for ((row, scene), frame) in rows.iter().zip(&scenes).zip(&frames) {
        let reference = on_reference(&volume, scene);
        let seen = reference.color.iter().any(|c| c[3] > 0.0);
        assert!(seen, "{}: nothing to see", describe(row));
        common::assert_sound(&describe(row), frame);
        let moved = moved_by_a_pixel(frame);
        for &(figure, limit) in row.limits {
            let measured = figure.of(&reference, frame, &volume);
            let control = figure.of(&reference, &moved, &volume);
            let line = format!(
                "| {} | {figure:?} | {measured:.2e} | {limit} | {control:.2e} |",
                describe(row)
            );
            println!("{line}");
            if !(measured <= limit && control > limit) {
                wrong.push(line);
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "measured, limit, control:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn unsigned_bytes() {
    check("u8");
}

#[test]
fn one_voxel_thick() {
    check("sheet");
}

#[test]
fn unsigned_words_one_to_ten_and_oblique() {
    check("u16");
}

#[test]
fn signed_words_left_handed() {
    check("i16");
}

#[test]
fn falling_calibration_and_sheared_axes() {
    check("falling");
}

#[test]
fn floats() {
    check("f32");
}
