//! A real peer, such as VTK, against the reference. Skips unless `ANGIORAY_PEER` is its command.
#![cfg(unix)]

use crate::common;

use angioray::extent::{Dims, ImageSize};
use angioray::frame::error::{color_error, depth_error};
use angioray::frame::{Frame, Layer};
use angioray::lab::measure::{Peer, PeerFrame, Readiness};
use angioray::scene::{
    Camera, Emission, Knot, Lens, Light, Phong, Picture, Projection, Refine, Reflectance, Rgb,
    Scene, TransferFunction, Window,
};
use angioray::volume::{Geometry, NonFinite, Rescale, Volume};
use glam::{DMat3, DVec3};

/// Three tubes of a turned volume of flat voxels, far from the world's origin.
fn tubes() -> Volume {
    let turned = DMat3::from_rotation_z(0.5) * DMat3::from_rotation_x(1.1);
    let geometry = Geometry::new(
        DVec3::new(-120.0, 80.0, 400.0),
        turned,
        DVec3::new(0.4, 0.4, 0.7),
    )
    .unwrap();
    let axes = [
        (DVec3::new(20.0, 22.0, 0.0), DVec3::new(0.1, 0.3, 1.0), 3.0),
        (DVec3::new(0.0, 12.0, 20.0), DVec3::new(1.0, 0.2, -0.2), 2.0),
        (DVec3::new(30.0, 0.0, 10.0), DVec3::new(-0.3, 1.0, 0.2), 4.0),
    ];
    let mut voxels: Vec<i16> = Vec::new();
    for (z, y, x) in
        (0..36_i32).flat_map(|z| (0..40_i32).flat_map(move |y| (0..48_i32).map(move |x| (z, y, x))))
    {
        let p = DVec3::new(x.into(), y.into(), z.into());
        let inside = axes.map(|(on, along, radius)| {
            let away = (p - on).reject_from(along).length();
            // Nowhere flat inside, where a normal would be anybody's choice.
            (1.0 - away / (3.0 * radius)).max(0.0)
        });
        voxels.push((1500.0 * inside.into_iter().fold(0.0, f64::max)) as i16);
    }
    let rescale = Rescale {
        slope: 0.5,
        intercept: -50.0,
    };
    let dims = Dims::new([48, 40, 36]).unwrap();
    Volume::new(dims, voxels.into(), geometry, rescale, NonFinite::Refuse).unwrap()
}

/// The picture moved by a pixel to all four sides.
fn moved(frame: &Frame) -> [Frame; 4] {
    let row = frame.size.width() as usize;
    let rotated = |by: usize| {
        let mut frame = frame.clone();
        frame.display.as_mut().unwrap().rotate_left(by);
        frame
    };
    let all = frame.size.pixels();
    [1, row, all - 1, all - row].map(rotated)
}

/// Every kind of picture from every kind of camera, under every light.
fn scenes(volume: &Volume) -> Vec<Scene> {
    let knot = |value, [r, g, b]: [f64; 3], opacity| Knot {
        value,
        color: Rgb([r, g, b]),
        opacity,
    };
    let knots = vec![
        knot(50.0, [0.2, 0.0, 0.0], 0.0),
        knot(200.0, [0.7, 0.2, 0.1], 0.1),
        knot(450.0, [1.0, 0.9, 0.6], 0.6),
    ];
    let unlit = Emission::of(TransferFunction::new(knots, 1.0).unwrap());
    let matt = Phong {
        specular: Reflectance::new(0.0).unwrap(),
        ..Phong::default()
    };
    let lit = Emission {
        phong: Some(matt),
        ..unlit.clone()
    };
    let pictures = [
        Picture::Surface {
            iso: 200.0,
            caps: false,
            refine: Refine::default(),
            color: Rgb([0.8, 0.4, 0.2]),
            phong: Some(Phong::default()),
        },
        Picture::Projection {
            of: Projection::Maximum,
            window: Window::new(-40.0, 680.0).unwrap(),
        },
        Picture::Emission(unlit),
        Picture::Emission(lit),
    ];
    let perspective = Lens::Perspective { fov_deg: 30.0 };
    let distant = Light::distant(DVec3::new(0.0, -0.6, 0.8)).unwrap();
    let views = [
        (perspective, Light::HEADLIGHT),
        (Lens::Orthographic { height_mm: 20.0 }, Light::HEADLIGHT),
        (perspective, distant),
    ];
    let (center, _) = volume.bounding_sphere();
    let eye = center + common::OBLIQUE.normalize() * 45.0;
    let scenes = pictures.iter().flat_map(|picture| {
        views.map(|(lens, light)| Scene {
            size: ImageSize::new(160, 120).unwrap(),
            camera: Camera::look_at(eye, center, DVec3::new(0.2, 0.1, 1.0), lens).unwrap(),
            lights: vec![light],
            ..common::scene(volume, 8, picture.clone())
        })
    });
    scenes.collect()
}

/// The peer that `ANGIORAY_PEER` names draws the reference's pictures, and not those of a pixel
/// beside, whatever the camera and the volume's place.
#[test]
fn a_real_peer_draws_what_the_reference_draws() {
    let Ok(command) = std::env::var("ANGIORAY_PEER") else {
        eprintln!("skipped: ANGIORAY_PEER names no peer");
        return;
    };
    let volume = tubes();
    let mut peer = Peer::start(&command).unwrap();
    peer.load(&volume).unwrap();
    let mut drawn = 0;
    for scene in scenes(&volume) {
        let reference = common::on_reference(&volume, &scene);
        for setting in peer.settings(scene.picture.mode().name()) {
            let ready = match peer.prepare(&volume, &scene, &setting).unwrap() {
                Readiness::Ready(ready) => ready,
                Readiness::Unsupported { why } => {
                    eprintln!("{setting}: {why}");
                    continue;
                }
            };
            let PeerFrame { frame, .. } = peer.render(&ready).unwrap();
            let off = color_error(&reference, &frame).unwrap().rmse;
            let off_moved = moved(&frame)
                .map(|frame| color_error(&reference, &frame).unwrap().rmse)
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            let depth = frame.layers.has(Layer::Depth).then(|| {
                let voxel_mm = volume.geometry().smallest_spacing_mm();
                depth_error(&reference, &frame, voxel_mm).unwrap()
            });
            let what = format!(
                "{} {:?} {:?} {setting}: rmse {off:.4}, moved {off_moved:.4}, {depth:?} {:?}",
                scene.picture.mode(),
                scene.camera.lens(),
                scene.lights,
                ready.note,
            );
            eprintln!("{what}");
            assert!(off < 0.9 * off_moved, "{what}");
            if let Some(depth) = depth {
                assert!(depth.mean.unwrap() < 2.0, "{what}");
            }
            drawn += 1;
        }
        peer.forget().unwrap();
    }
    assert!(drawn > 0, "{command} draws nothing");
}
