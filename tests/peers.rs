//! Peers: what one is told, what it may answer, and that one which ends, babbles or falls silent
//! costs a sentence and never a wait without end. The peers here are shell scripts.
#![cfg(unix)]

mod common;

use std::fs;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use angioray::Result;
use angioray::extent::{Dims, ImageSize};
use angioray::frame::Frame;
use angioray::frame::error::{color_error, depth_error};
use angioray::measure::{Peer, PeerFrame, PeerScene, Readiness};
use angioray::scene::{
    Camera, Emission, Knot, Lens, Light, Phong, Picture, Projection, Refine, Rgb, Scene,
    TransferFunction, Window, srgb_from_linear,
};
use angioray::volume::{Geometry, NonFinite, Rescale, Volume};
use glam::{DMat3, DVec3};
use serde_json::{Value, json};
use tempfile::TempDir;

const HELLO: &str = r#"echo '{"peer":"fake","version":"1.2","device":"none","settings":[{"name":"fine","modes":["mip","iso"]},{"name":"coarse","modes":["mip"]}]}'"#;
const LOAD: &str = r#"*'"load"'*) echo '{"loaded":1.5}' ;;"#;
const READY: &str = r#"*'"scene"'*) echo '{"ready":2.5,"supported":true,"note":"flat"}' ;;"#;

/// A peer of the answers given as branches of a `case`; `$1` is the folder of the script, into
/// which it copies what it hears.
struct Fake {
    folder: TempDir,
    command: String,
}

impl Fake {
    fn new(script: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a peer.sh");
        fs::write(&path, script).unwrap();
        let command = format!("sh '{}' '{}'", path.display(), folder.path().display());
        Self { folder, command }
    }

    fn answering(branches: &[&str]) -> Self {
        Self::new(&format!(
            "{HELLO}\nwhile read -r line; do\nprintf '%s\\n' \"$line\" >>\"$1/heard\"\n\
             case \"$line\" in\n{}\nesac\ndone\n",
            branches.join("\n")
        ))
    }

    /// With a limit that no working script reaches.
    fn start(&self) -> Result<Peer> {
        Peer::start_with_patience(&self.command, Duration::from_secs(60))
    }

    fn heard(&self) -> Vec<Value> {
        let text = fs::read_to_string(self.folder.path().join("heard")).unwrap();
        text.lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect()
    }
}

/// A branch that writes planes, given as `printf` formats, and says how long it took.
fn renders(color: &str, depth: Option<&str>) -> String {
    let file =
        |name: &str| format!(r#""$(printf '%s' "$line" | sed 's/.*"{name}":"\([^"]*\)".*/\1/')""#);
    let write = |name: &str, bytes: &str| format!("printf '{bytes}' >{}", file(name));
    let depth_said = depth.is_some();
    let depth = depth.map_or(":".into(), |bytes| write("depth", bytes));
    format!(
        "*'\"color\"'*) {}; {depth}; echo '{{\"ms\":7,\"cpu_ms\":13,\"depth\":{depth_said}}}' ;;\n\
         *'\"render\"'*) echo '{{\"ms\":6}}' ;;",
        write("color", color)
    )
}

/// As bytes for `printf`.
const ONE: &str = r"\000\000\200\077";
const HALF: &str = r"\000\000\000\077";
const ZERO: &str = r"\000\000\000\000";
const INFINITE: &str = r"\000\000\200\177";
const NAN: &str = r"\000\000\300\177";

/// Two pixels: a white one, and half a white one.
fn two_pixels() -> String {
    [[ONE; 4], [HALF; 4]].concat().concat()
}

fn volume() -> Volume {
    let geometry = Geometry::new(
        DVec3::new(5.0, 6.0, 7.0),
        DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z),
        DVec3::new(0.5, 0.5, 2.0),
    )
    .unwrap();
    let rescale = Rescale {
        slope: 2.0,
        intercept: -100.0,
    };
    Volume::new(
        Dims::new([3, 2, 2]).unwrap(),
        vec![0_i16, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100, 110].into(),
        geometry,
        rescale,
        NonFinite::Refuse,
    )
    .unwrap()
}

fn scene_of(volume: &Volume, picture: Picture) -> Scene {
    Scene {
        size: ImageSize::new(2, 1).unwrap(),
        ..common::scene(volume, 2, picture)
    }
}

fn maximum() -> Picture {
    Picture::Projection {
        of: Projection::Maximum,
        window: Window::new(-100.0, 20.0).unwrap(),
    }
}

/// A picture of a peer, through all steps.
fn picture_of(fake: &Fake) -> Result<PeerFrame> {
    let volume = volume();
    let mut peer = fake.start()?;
    peer.load(&volume)?;
    let scene = prepared(&mut peer, &volume, &scene_of(&volume, maximum()))?;
    peer.render(&scene)
}

fn prepared(peer: &mut Peer, volume: &Volume, scene: &Scene) -> Result<PeerScene> {
    match peer.prepare(volume, scene, "fine")? {
        Readiness::Ready(scene) => Ok(scene),
        Readiness::Unsupported { why } => panic!("{why}"),
    }
}

fn refusal(fake: &Fake) -> String {
    picture_of(fake).unwrap_err().to_string()
}

#[test]
fn a_peer_says_what_it_is_and_draws_as_often_as_it_is_asked() {
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
    assert_eq!(peer.load(&volume).unwrap(), 1.5);
    prepared(&mut peer, &volume, &scene).unwrap();
    let scene = prepared(&mut peer, &volume, &scene).unwrap();
    assert_eq!((scene.ready_ms, scene.note.as_deref()), (2.5, Some("flat")));

    let picture = peer.render(&scene).unwrap();
    assert_eq!((picture.time.ms, picture.time.cpu_ms), (7.0, Some(13.0)));
    let time = peer.time(&scene).unwrap();
    assert_eq!((time.ms, time.cpu_ms), (6.0, None));
    peer.forget().unwrap();
    let heard = fake.heard();
    assert_eq!(heard[2]["scene"]["id"], 1);
    assert_eq!(heard[3]["render"]["id"], 1);
    assert_eq!(heard[4], json!({"render": {"id": 1}}));
    assert_eq!(heard[5], json!({"forget": {}}));
    assert_eq!(picture.frame.color, [[1.0; 4], [0.5; 4]]);
    assert_eq!(picture.frame.depth, Some(vec![1.0, f32::INFINITY]));
    // Shown over a background of one fifth of white.
    let display = picture.frame.display.as_ref().unwrap();
    let grey = srgb_from_linear(0.5 + 0.5 * 0.2) as f32;
    assert_eq!(*display, [[1.0; 4], [grey, grey, grey, 1.0]]);

    // It is judged as any picture is.
    let mut truth = picture.frame.clone();
    assert_eq!(color_error(&truth, &picture.frame).unwrap().max, 0.0);
    truth.display.as_mut().unwrap()[1] = [grey - 0.25; 4];
    truth.depth = Some(vec![f32::INFINITY, f32::INFINITY]);
    assert!((color_error(&truth, &picture.frame).unwrap().max - 0.25).abs() < 1e-6);
    assert_eq!(depth_error(&truth, &picture.frame, 1.0).unwrap().extra, 1);
}

#[test]
fn a_picture_without_depth_is_one() {
    let fake = Fake::answering(&[LOAD, READY, &renders(&two_pixels(), None)]);
    assert_eq!(picture_of(&fake).unwrap().frame.depth, None);
}

#[test]
fn a_volume_is_told_in_its_own_voxels() {
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
fn a_scene_is_told_in_stored_values_and_linear_light() {
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
    scene.light = Light::Distant {
        toward_light: DVec3::X,
    };
    let lens = Lens::Orthographic { height_mm: 30.0 };
    scene.camera = Camera::look_at(DVec3::NEG_Y * 9.0, DVec3::ZERO, DVec3::Z, lens).unwrap();
    for scene in [scene_of(&volume, maximum()), scene] {
        prepared(&mut peer, &volume, &scene).unwrap();
    }

    let heard = fake.heard();
    assert_eq!(heard[1]["scene"]["mode"], "mip");
    assert_eq!(heard[1]["scene"]["window"], json!([0.0, 60.0]));
    assert_eq!(heard[1]["scene"]["toward_light"], Value::Null);
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
            "diffuse": 0.9,
            "specular": 0.2,
            "shininess": 32.0,
        },
        "toward_light": [1.0, 0.0, 0.0],
        "clip_planes": [],
    });
    assert_eq!(heard[2]["scene"], expected);
}

#[test]
fn what_a_peer_cannot_draw_it_says_and_goes_on() {
    let unable = r#"*'"scene"'*) echo '{"supported":false,"why":"no such light"}' ;;"#;
    let fake = Fake::answering(&[LOAD, unable]);
    let volume = volume();
    let scene = scene_of(&volume, maximum());
    let mut peer = fake.start().unwrap();
    for _ in 0..2 {
        let said = peer.prepare(&volume, &scene, "fine").unwrap();
        let expected = Readiness::Unsupported {
            why: "no such light".into(),
        };
        assert_eq!(said, expected);
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

#[test]
fn planes_that_are_none_are_refused() {
    let render = |color: &str, depth| {
        let fake = Fake::answering(&[LOAD, READY, &renders(color, depth)]);
        refusal(&fake)
    };
    assert_eq!(
        render(&[ONE; 7].concat(), None),
        "the peer fake 1.2 wrote 28 bytes of color.f32: a picture of 2x1 has 32"
    );
    let nan = [[ONE; 4], [NAN; 4]].concat().concat();
    assert!(render(&nan, None).ends_with("infinite or NaN"));
    let depth = [ZERO, NAN].concat();
    assert!(render(&two_pixels(), Some(&depth)).ends_with("negative or NaN"));

    let forgets = r#"*'"render"'*) echo '{"ms":1}' ;;"#;
    assert!(
        refusal(&Fake::answering(&[LOAD, READY, forgets])).ends_with("did not write color.f32")
    );
    let quick = r#"*'"render"'*) echo '{"ms":-1}' ;;"#;
    assert!(refusal(&Fake::answering(&[LOAD, READY, quick])).ends_with("took -1 ms"));
}

#[test]
fn a_peer_that_babbles_is_quoted() {
    let babbles = r#"*'"render"'*) echo 'Warning: no depth buffer' ;;"#;
    assert_eq!(
        refusal(&Fake::answering(&[LOAD, READY, babbles])),
        "the peer fake 1.2 was to render and said 'Warning: no depth buffer', which is no JSON object"
    );
    let other = r#"*'"load"'*) echo '{"milliseconds":1}' ;;"#;
    let said = refusal(&Fake::answering(&[other]));
    assert!(
        said.contains("gave no such answer: missing field `loaded`"),
        "{said}"
    );
    let twice = r#"*'"load"'*) printf '{"loaded":1}\nmore\n' ;;"#;
    let fake = Fake::answering(&[twice, READY]);
    let volume = volume();
    let mut peer = fake.start().unwrap();
    peer.load(&volume).unwrap();
    let said = peer.load(&volume).unwrap_err().to_string();
    assert!(said.contains("'more'"), "{said}");
    // Without end, and without a line's end.
    let said = Fake::new("yes | tr -d '\\n'").start().err().unwrap();
    assert!(said.to_string().contains("yyy…"), "{said}");
}

#[test]
fn a_peer_that_ends_is_quoted_and_stays_ended() {
    let dies = r#"*'"render"'*) echo 'no display: giving up' >&2; exit 3 ;;"#;
    let fake = Fake::answering(&[LOAD, READY, dies]);
    let volume = volume();
    let mut peer = fake.start().unwrap();
    peer.load(&volume).unwrap();
    let scene = prepared(&mut peer, &volume, &scene_of(&volume, maximum())).unwrap();
    let first = peer.render(&scene).unwrap_err().to_string();
    assert_eq!(
        first,
        "the peer fake 1.2 ended (exit status: 3) where it was to render: no display: giving up"
    );
    assert_eq!(peer.time(&scene).unwrap_err().to_string(), first);

    let at_once = Fake::new("exit 0");
    let said = at_once.start().err().unwrap().to_string();
    let expected = format!(
        "the peer '{}' ended (exit status: 0) where it was to say hello",
        at_once.command
    );
    assert_eq!(said, expected);
}

#[test]
fn a_silent_peer_is_not_waited_for() {
    let start = Instant::now();
    let silent = Fake::new("exec sleep 600");
    let said = Peer::start_with_patience(&silent.command, Duration::from_millis(300));
    let said = said.err().unwrap().to_string();
    assert!(
        said.ends_with("was to say hello and has not answered for 0.3 s"),
        "{said}"
    );
    // Nor is one that does not listen: a transfer function larger than any pipe.
    let deaf = Fake::new(&format!("{HELLO}\nexec sleep 600"));
    let mut peer = Peer::start_with_patience(&deaf.command, Duration::from_secs(4)).unwrap();
    let volume = volume();
    let knots = (0..4096).map(|i| Knot {
        value: -100.0 + f64::from(i) / 37.0,
        color: Rgb([0.123_456_789_012_345; 3]),
        opacity: 0.123_456_789_012_345,
    });
    let transfer = TransferFunction::new(knots.collect(), 1.0).unwrap();
    let scene = scene_of(&volume, Picture::Emission(Emission::of(transfer)));
    assert!(peer.prepare(&volume, &scene, "fine").is_err());
    drop(peer);
    assert!(start.elapsed() < Duration::from_secs(300));
}

#[test]
fn a_command_that_is_none_is_refused() {
    for (command, exit_code) in [("", 2), ("'unfinished", 2), ("/nowhere/a-peer", 1)] {
        let error = Peer::start(command).err().unwrap();
        assert_eq!(error.exit_code(), exit_code, "{error}");
        assert!(error.to_string().contains(command), "{error}");
    }
}

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
        specular: 0.0,
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
    let distant = Light::Distant {
        toward_light: DVec3::new(0.0, -0.6, 0.8),
    };
    let views = [
        (perspective, Light::Headlight),
        (Lens::Orthographic { height_mm: 20.0 }, Light::Headlight),
        (perspective, distant),
    ];
    let (center, _) = volume.bounding_sphere();
    let eye = center + common::OBLIQUE.normalize() * 45.0;
    let scenes = pictures.iter().flat_map(|picture| {
        views.map(|(lens, light)| Scene {
            size: ImageSize::new(160, 120).unwrap(),
            camera: Camera::look_at(eye, center, DVec3::new(0.2, 0.1, 1.0), lens).unwrap(),
            light,
            ..common::scene(&volume, 8, picture.clone())
        })
    });
    let mut drawn = 0;
    for scene in scenes {
        let truth = common::on_reference(&volume, &scene);
        for setting in peer.settings(scene.picture.mode()) {
            let ready = match peer.prepare(&volume, &scene, &setting).unwrap() {
                Readiness::Ready(ready) => ready,
                Readiness::Unsupported { why } => {
                    eprintln!("{setting}: {why}");
                    continue;
                }
            };
            let PeerFrame { frame, .. } = peer.render(&ready).unwrap();
            let off = color_error(&truth, &frame).unwrap().rmse;
            let off_moved = moved(&frame)
                .map(|frame| color_error(&truth, &frame).unwrap().rmse)
                .into_iter()
                .fold(f64::INFINITY, f64::min);
            let depth = frame.depth.is_some().then(|| {
                let voxel_mm = volume.geometry().smallest_spacing_mm();
                depth_error(&truth, &frame, voxel_mm).unwrap()
            });
            let what = format!(
                "{} {:?} {:?} {setting}: rmse {off:.4}, moved {off_moved:.4}, {depth:?} {:?}",
                scene.picture.mode(),
                scene.camera.lens(),
                scene.light,
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
