//! A peer that is a shell script, and a volume and scenes to ask it for.
#![allow(dead_code)] // each test program uses its own part

use std::fs;
use std::time::Duration;

use angioray::Result;
use angioray::extent::{Dims, ImageSize};
use angioray::lab::measure::{Peer, PeerFrame, PeerScene, Readiness};
use angioray::scene::{Picture, Projection, Scene, Window};
use angioray::volume::{Geometry, NonFinite, Rescale, Volume};
use glam::{DMat3, DVec3};
use serde_json::Value;
use tempfile::TempDir;

use crate::common;

pub const HELLO: &str = r#"echo '{"peer":"fake","version":"1.2","device":"none","settings":[{"name":"fine","modes":["mip","iso"]},{"name":"coarse","modes":["mip"]}]}'"#;
pub const LOAD: &str = r#"*'"load"'*) echo '{"loaded":1.5}' ;;"#;
pub const READY: &str = r#"*'"scene"'*) echo '{"ready":2.5,"supported":true,"note":"flat"}' ;;"#;

/// A peer of the answers given as branches of a `case`; `$1` is the folder of the script, into
/// which it copies what it reads.
pub struct Fake {
    pub folder: TempDir,
    pub command: String,
}

impl Fake {
    pub fn new(script: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a peer.sh");
        fs::write(&path, script).unwrap();
        let command = format!("sh '{}' '{}'", path.display(), folder.path().display());
        Self { folder, command }
    }

    pub fn answering(branches: &[&str]) -> Self {
        Self::new(&format!(
            "{HELLO}\nwhile read -r line; do\nprintf '%s\\n' \"$line\" >>\"$1/heard\"\n\
             case \"$line\" in\n{}\nesac\ndone\n",
            branches.join("\n")
        ))
    }

    /// With a limit that no working script reaches.
    pub fn start(&self) -> Result<Peer> {
        Peer::start_with_patience(&self.command, Duration::from_secs(60))
    }

    pub fn heard(&self) -> Vec<Value> {
        let text = fs::read_to_string(self.folder.path().join("heard")).unwrap();
        text.lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect()
    }
}

/// A branch that writes planes, given as `printf` formats, and says how long it took.
pub fn renders(color: &str, depth: Option<&str>) -> String {
    let file =
        |name: &str| format!(r#""$(printf '%s' "$line" | sed 's/.*"{name}":"\([^"]*\)".*/\1/')""#);
    let write = |name: &str, bytes: &str| format!("printf '{bytes}' >{}", file(name));
    let has_depth = depth.is_some();
    let depth = depth.map_or(":".into(), |bytes| write("depth", bytes));
    format!(
        "*'\"color\"'*) {}; {depth}; echo '{{\"ms\":7,\"cpu_ms\":13,\"depth\":{has_depth}}}' ;;\n\
         *'\"render\"'*) echo '{{\"ms\":6}}' ;;",
        write("color", color)
    )
}

/// As bytes for `printf`.
pub const ONE: &str = r"\000\000\200\077";
pub const HALF: &str = r"\000\000\000\077";
pub const ZERO: &str = r"\000\000\000\000";
pub const INFINITE: &str = r"\000\000\200\177";
pub const NAN: &str = r"\000\000\300\177";

/// Two pixels: a white one, and half a white one.
pub fn two_pixels() -> String {
    [[ONE; 4], [HALF; 4]].concat().concat()
}

pub fn volume() -> Volume {
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

pub fn scene_of(volume: &Volume, picture: Picture) -> Scene {
    Scene {
        size: ImageSize::new(2, 1).unwrap(),
        ..common::scene(volume, 2, picture)
    }
}

pub fn maximum() -> Picture {
    Picture::Projection {
        of: Projection::Maximum,
        window: Window::new(-100.0, 20.0).unwrap(),
    }
}

/// A picture of a peer, through all steps.
pub fn picture_of(fake: &Fake) -> Result<PeerFrame> {
    let volume = volume();
    let mut peer = fake.start()?;
    peer.load(&volume)?;
    let scene = prepared(&mut peer, &volume, &scene_of(&volume, maximum()))?;
    peer.render(&scene)
}

pub fn prepared(peer: &mut Peer, volume: &Volume, scene: &Scene) -> Result<PeerScene> {
    match peer.prepare(volume, scene, "fine")? {
        Readiness::Ready(scene) => Ok(scene),
        Readiness::Unsupported { why } => panic!("{why}"),
    }
}

pub fn refusal(fake: &Fake) -> String {
    picture_of(fake).unwrap_err().to_string()
}
