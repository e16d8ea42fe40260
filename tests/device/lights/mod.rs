//! Lights and material against closed forms, on the device and in the reference.

mod closed_forms;
mod places;
mod shade_from;

use angioray::frame::Frame;
use angioray::scene::{Light, Phong, Picture, Refine, Reflectance, Rgb, Scene};
use angioray::volume::Volume;

use crate::common::{self, on_device, on_reference};

const COLOR: [f64; 3] = [0.8, 0.6, 0.4];

fn light(text: &str) -> Light {
    text.parse().unwrap()
}

/// Neither ambient nor specular light: all that is left is the colour times n·l.
fn matt() -> Phong {
    Phong {
        ambient: Reflectance::new(0.0).unwrap(),
        diffuse: Reflectance::new(1.0).unwrap(),
        specular: Reflectance::new(0.0).unwrap(),
        ..Phong::default()
    }
}

fn surface(iso: f64, phong: Phong) -> Picture {
    Picture::Surface {
        iso,
        caps: false,
        refine: Refine::default(),
        color: Rgb(COLOR),
        phong: Some(phong),
    }
}

/// The scene's picture on the device and in the reference.
fn both(volume: &Volume, scene: &Scene) -> Option<[Frame; 2]> {
    let device = common::device()?;
    let mut frames = on_device(&device, volume, std::slice::from_ref(scene));
    Some([frames.swap_remove(0), on_reference(volume, scene)])
}

/// The greatest difference of two colours' channels.
fn apart(a: [f32; 4], b: [f64; 3]) -> f64 {
    let differ = |c: usize| (f64::from(a[c]) - b[c]).abs();
    (0..3).map(differ).fold(0.0, f64::max)
}
