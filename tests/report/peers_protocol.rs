//! Peers: what one is sent, and what it may answer. The peers here are shell scripts.
#![cfg(unix)]

use crate::fake_peer;

use std::fs;
use std::path::PathBuf;

use angioray::frame::DEPTH;
use angioray::frame::error::{color_error, depth_error};
use angioray::lab::measure::Readiness;
use angioray::scene::{
    Camera, Emission, Knot, Lens, Light, Phong, Picture, Rgb, TransferFunction, srgb_from_linear,
};
use glam::DVec3;
use serde_json::json;

use fake_peer::{
    Fake, INFINITE, LOAD, ONE, READY, maximum, picture_of, prepared, renders, scene_of, two_pixels,
    volume,
};

#[test]
fn a_peer_says_what_it_is_and_draws_as_often_as_requested() {
    let depth = [ONE, INFINITE].concat();
    let forgets = r#"*'"forget"'*) echo '{}' ;;"#;
    let pictures = renders(&two_pixels(), Some(&depth));
    let fake = Fake::answering(&[LOAD, READY, &pictures, forgets]);
    let mut peer = fake.start().unwrap();
    assert_eq!(
        (peer.name(), peer.version(), peer.device()),
        ("fake", "1.2", "none")
    );
    assert_eq!(peer.settings("mip"), ["fine", "coarse"]);
    assert_eq!(peer.settings("iso"), ["fine"]);
    assert!(peer.settings("dvr").is_empty());

    let volume = volume();
    let mut scene = scene_of(&volume, maximum());
    scene.tone.background = Rgb([0.2; 3]);
    let elsewhere = scene.camera.turned(DVec3::Z, DVec3::ZERO, 30.0);
    assert_eq!(peer.load(&volume).unwrap(), 1.5);
    prepared(&mut peer, &volume, &scene).unwrap();
    let scene = prepared(&mut peer, &volume, &scene).unwrap();
    assert_eq!((scene.ready_ms, scene.note.as_deref()), (2.5, Some("flat")));

    let picture = peer.render(&scene).unwrap();
    assert_eq!((picture.time.ms, picture.time.cpu_ms), (7.0, Some(13.0)));
    let time = peer.time(&scene).unwrap();
    assert_eq!((time.ms, time.cpu_ms), (6.0, None));
    assert_eq!(peer.time_from(&scene, &elsewhere).unwrap(), time);
    peer.forget().unwrap();
    let heard = fake.heard();
    assert_eq!(heard[2]["scene"]["id"], 1);
    assert_eq!(heard[3]["render"]["id"], 1);
    assert_eq!(heard[4], json!({"render": {"id": 1}}));
    let eye = &heard[5]["render"]["camera"]["eye"];
    assert_eq!(*eye, json!(elsewhere.eye_world().to_array()));
    assert_ne!(*eye, heard[2]["scene"]["camera"]["eye"]);
    assert_eq!(heard[6], json!({"forget": {}}));
    assert_eq!(picture.frame.color, [[1.0; 4], [0.5; 4]]);
    assert_eq!(picture.frame.plane(DEPTH).unwrap(), [1.0, f32::INFINITY]);
    // Shown over a background of one fifth of white.
    let display = picture.frame.display.as_ref().unwrap();
    let grey = srgb_from_linear(0.5 + 0.5 * 0.2) as f32;
    assert_eq!(*display, [[1.0; 4], [grey, grey, grey, 1.0]]);

    // It is evaluated as any picture is.
    let mut reference = picture.frame.clone();
    assert_eq!(color_error(&reference, &picture.frame).unwrap().max, 0.0);
    reference.display.as_mut().unwrap()[1] = [grey - 0.25; 4];
    reference.layers.insert(DEPTH, vec![f32::INFINITY; 2]);
    assert!((color_error(&reference, &picture.frame).unwrap().max - 0.25).abs() < 1e-6);
    assert_eq!(
        depth_error(&reference, &picture.frame, 1.0).unwrap().extra,
        1
    );
}

#[test]
fn a_picture_without_depth_is_one() {
    let fake = Fake::answering(&[LOAD, READY, &renders(&two_pixels(), None)]);
    assert_eq!(picture_of(&fake).unwrap().frame.plane(DEPTH), None);
}

#[test]
fn a_volume_is_sent_in_its_own_voxels() {
    let keep = r#"*'"load"'*) cp "$(printf '%s' "$line" | sed 's/.*"file":"\([^"]*\)".*/\1/')" "$1/voxels"; echo '{"loaded":0}' ;;"#;
    let fake = Fake::answering(&[keep]);
    let volume = volume();
    fake.start().unwrap().load(&volume).unwrap();
    let heard = &fake.heard()[0]["load"];
    let file = PathBuf::from(heard["file"].as_str().unwrap());
    assert!(!file.exists(), "{} is left over", file.display());
    let expected = json!({
        "file": file,
        "dims": [3, 2, 2],
        "type": "i16",
        "spacing": [0.5, 0.5, 2.0],
        "origin": [5.0, 6.0, 7.0],
        "direction": [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        "range": [0.0, 110.0],
    });
    assert_eq!(*heard, expected);
    let voxels = fs::read(fake.folder.path().join("voxels")).unwrap();
    assert_eq!(voxels, volume.voxels().bytes());
}

#[test]
fn a_scene_is_sent_in_stored_values_and_linear_light() {
    let fake = Fake::answering(&[LOAD, READY]);
    let volume = volume();
    let mut peer = fake.start().unwrap();
    peer.load(&volume).unwrap();

    let knot = |value, grey, opacity| Knot {
        value,
        color: Rgb([grey; 3]),
        opacity,
    };
    let knots = vec![knot(-100.0, 0.0, 0.0), knot(120.0, 1.0, 0.5)];
    let mut emission = Emission::of(TransferFunction::new(knots, 3.0).unwrap());
    emission.phong = Some(Phong::default());
    let mut scene = scene_of(&volume, Picture::Emission(emission));
    scene.lights = vec![
        Light::distant(DVec3::X).unwrap(),
        "point:1,2,3@lime@0.5".parse().unwrap(),
        Light::HEADLIGHT,
    ];
    let lens = Lens::Orthographic { height_mm: 30.0 };
    scene.camera = Camera::look_at(DVec3::NEG_Y * 9.0, DVec3::ZERO, DVec3::Z, lens).unwrap();
    for scene in [scene_of(&volume, maximum()), scene] {
        prepared(&mut peer, &volume, &scene).unwrap();
    }

    let heard = fake.heard();
    assert_eq!(heard[1]["scene"]["mode"], "mip");
    assert_eq!(heard[1]["scene"]["window"], json!([0.0, 60.0]));
    assert_eq!(
        heard[1]["scene"]["lights"],
        json!([{"color": [1.0, 1.0, 1.0]}])
    );
    assert_eq!(heard[1]["scene"]["camera"]["fov_deg"], 30.0);
    let expected = json!({
        "id": 1,
        "setting": "fine",
        "mode": "dvr",
        "size": [2, 1],
        "camera": {
            "eye": [0.0, -9.0, 0.0],
            "right": [1.0, 0.0, 0.0],
            "up": [0.0, 0.0, 1.0],
            "forward": [0.0, 1.0, 0.0],
            "ortho_height_mm": 30.0,
        },
        "filter": "linear",
        "gradient": "central",
        "unit_length_mm": 3.0,
        "points": [[0.0, 0.0, 0.0, 0.0, 0.0], [110.0, 1.0, 1.0, 1.0, 0.5]],
        "phong": {
            "reflection": "phong",
            "ambient": 0.1,
            "ambient_color": [1.0, 1.0, 1.0],
            "diffuse": 0.9,
            "diffuse_color": [1.0, 1.0, 1.0],
            "specular": 0.2,
            "specular_color": [1.0, 1.0, 1.0],
            "shininess": 32.0,
        },
        "shaded_from": 0.0,
        "lights": [
            {"color": [1.0, 1.0, 1.0], "toward": [1.0, 0.0, 0.0]},
            {"color": [0.0, 0.5, 0.0], "at": [1.0, 2.0, 3.0]},
            {"color": [1.0, 1.0, 1.0]},
        ],
        "clip_planes": [],
    });
    assert_eq!(heard[2]["scene"], expected);
}

#[test]
fn a_peer_reports_what_it_cannot_draw_and_stays_usable() {
    let unable = r#"*'"scene"'*) echo '{"supported":false,"why":"no such light"}' ;;"#;
    let fake = Fake::answering(&[LOAD, unable]);
    let volume = volume();
    let scene = scene_of(&volume, maximum());
    let mut peer = fake.start().unwrap();
    for _ in 0..2 {
        let readiness = peer.prepare(&volume, &scene, "fine").unwrap();
        let expected = Readiness::Unsupported {
            why: "no such light".into(),
        };
        assert_eq!(readiness, expected);
    }

    let failing = r#"*'"scene"'*) echo '{"error":"out of memory"}' ;;"#;
    let fake = Fake::answering(&[LOAD, failing]);
    let mut peer = fake.start().unwrap();
    assert_eq!(
        (peer.prepare(&volume, &scene, "fine").unwrap_err()).to_string(),
        "the peer fake 1.2 cannot prepare the scene: out of memory"
    );
    assert_eq!(peer.load(&volume).unwrap(), 1.5);
}
