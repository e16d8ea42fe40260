//! Another renderer beside this one: a *peer* is a program that is started once and draws the same
//! volume and scene, timing itself, its picture evaluated like ours.
//!
//! It is talked to over its standard input and output, one JSON object a line
//! (scripts/peers/README.md): it says hello, loads a volume, prepares scenes of it in its own
//! settings, and renders any of them, as often as it is requested. Voxels and pictures go through files
//! of a temporary folder.

mod process;
mod protocol;

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use serde::de::DeserializeOwned;
use tempfile::TempDir;

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::frame::{DEPTH, Frame, Layers};
use crate::reference::display;
use crate::scene::{Camera, Scene, Tone};
use crate::volume::Volume;

use process::Process;
use protocol::{
    Forgotten, Hello, Loaded, OfferedSetting, Ready, RenderRequest, Rendered, Request,
    SceneRequest, VolumeFile,
};

/// A peer that runs until it is dropped.
pub struct Peer {
    process: Process,
    name: String,
    version: String,
    device: String,
    settings: Vec<OfferedSetting>,
    /// The folder for voxels that are sent and planes that come back.
    folder: TempDir,
    /// How many scenes it was requested to prepare.
    scenes: u64,
}

/// A scene that a peer has prepared, until it forgets its scenes.
#[derive(Debug, Clone, PartialEq)]
pub struct PeerScene {
    id: u64,
    size: ImageSize,
    tone: Tone,
    /// The time of what is done once for the scene, such as extracting a mesh, ms.
    pub ready_ms: f64,
    /// How the peer's picture differs from what the scene says, other than by sampling.
    pub note: Option<String>,
}

/// The readiness of a peer to draw a scene.
#[derive(Debug, Clone, PartialEq)]
pub enum Readiness {
    /// The scene is prepared, and can be drawn.
    Ready(PeerScene),
    /// The peer cannot draw such a scene.
    Unsupported {
        /// The peer's reason.
        why: String,
    },
}

/// The time of one picture, from the camera set to pixels that the host can read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeerTime {
    /// The elapsed time, ms.
    pub ms: f64,
    /// The processor time of all the peer's threads, ms.
    pub cpu_ms: Option<f64>,
}

/// A picture of a peer.
#[derive(Debug, Clone)]
pub struct PeerFrame {
    /// The time that the picture took.
    pub time: PeerTime,
    /// The picture: its colour, the display computed from it by the scene's tone curve, and the depth if
    /// the peer writes it.
    pub frame: Frame,
}

impl Peer {
    /// The time limit of an answer: longer than any picture, load or mesh should take.
    pub const PATIENCE: Duration = Duration::from_secs(300);

    /// Starts a peer and reads what it is; `command` is written as for a POSIX shell.
    ///
    /// # Errors
    /// Usage: no command. Failed: it cannot be started, ends, gives no valid answer, or none for
    /// [`Self::PATIENCE`].
    pub fn start(command: &str) -> Result<Self> {
        Self::start_with_patience(command, Self::PATIENCE)
    }

    /// Starts a peer with another time limit for each answer; see [`Self::start`].
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn start_with_patience(command: &str, patience: Duration) -> Result<Self> {
        let folder = tempfile::Builder::new()
            .prefix("angioray-peer-")
            .tempdir()
            .map_err(|cause| Error::writing(&std::env::temp_dir(), "make a folder", &cause))?;
        let mut process = Process::start(command, patience)?;
        let hello: Hello = ask(&mut process, None, "say hello")?;
        process.rename(format!("the peer {} {}", hello.peer, hello.version));
        Ok(Self {
            process,
            name: hello.peer,
            version: hello.version,
            device: hello.device,
            settings: hello.settings,
            folder,
            scenes: 0,
        })
    }

    /// The peer's name, such as `vtk`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The version that the peer gives of itself.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// The device that the peer draws with.
    pub fn device(&self) -> &str {
        &self.device
    }

    /// The names of the peer's settings for a mode, by the mode's name.
    pub fn settings(&self, mode: &str) -> Vec<String> {
        let able = |setting: &&OfferedSetting| setting.modes.iter().any(|m| m == mode);
        let settings = self.settings.iter().filter(able);
        settings.map(|setting| setting.name.clone()).collect()
    }

    /// Gives the peer a volume in place of the one before, whose scenes it forgets, and returns the loading
    /// time that it reports, ms.
    ///
    /// # Errors
    /// The temporary folder has no room; the peer fails.
    pub fn load(&mut self, volume: &Volume) -> Result<f64> {
        let path = self.folder.path().join("voxels.raw");
        fs::write(&path, volume.voxels().bytes())
            .map_err(|cause| Error::writing(&path, "write the voxels", &cause))?;
        let request = Request::Load(VolumeFile::of(volume, self.text_of("voxels.raw")?));
        let loaded: Result<Loaded> = ask(&mut self.process, Some(request), "load the volume");
        // It has read them, and they may be large.
        let removed = fs::remove_file(&path);
        let loaded = loaded?;
        removed.map_err(|cause| Error::writing(&path, "remove the voxels", &cause))?;
        self.duration(loaded.loaded)
    }

    /// Requests that the peer prepare a scene of `volume`, which is the one loaded last, in one of its
    /// [`Self::settings`].
    ///
    /// # Errors
    /// The peer fails.
    pub fn prepare(&mut self, volume: &Volume, scene: &Scene, setting: &str) -> Result<Readiness> {
        let id = self.scenes;
        self.scenes += 1;
        let request = Request::Scene(Box::new(SceneRequest::of(id, scene, volume, setting)));
        let ready: Ready = ask(&mut self.process, Some(request), "prepare the scene")?;
        if !ready.supported {
            return Ok(Readiness::Unsupported {
                why: ready.why.unwrap_or_else(|| "it gives no reason".into()),
            });
        }
        Ok(Readiness::Ready(PeerScene {
            id,
            size: scene.size,
            tone: scene.tone,
            ready_ms: self.duration(ready.ready)?,
            note: ready.note,
        }))
    }

    /// Makes the peer drop all scenes, and what it holds for them.
    ///
    /// # Errors
    /// The peer fails.
    pub fn forget(&mut self) -> Result<()> {
        let Forgotten {} = ask(&mut self.process, Some(Request::Forget {}), "forget")?;
        Ok(())
    }

    /// Draws the picture for its time alone.
    ///
    /// # Errors
    /// The peer fails, or has forgotten the scene.
    pub fn time(&mut self, scene: &PeerScene) -> Result<PeerTime> {
        let (time, _) = self.draw(RenderRequest::timed(scene.id))?;
        Ok(time)
    }

    /// Draws the picture that another camera sees of the scene, for its time alone.
    ///
    /// # Errors
    /// As [`Self::time`].
    pub fn time_from(&mut self, scene: &PeerScene, camera: &Camera) -> Result<PeerTime> {
        let (time, _) = self.draw(RenderRequest::timed_from(scene.id, camera))?;
        Ok(time)
    }

    /// Draws the picture.
    ///
    /// # Errors
    /// The peer fails, or has forgotten the scene; a plane is missing, has not the picture's size, or
    /// holds what no picture can.
    pub fn render(&mut self, scene: &PeerScene) -> Result<PeerFrame> {
        const COLOR_FILE: &str = "color.f32";
        const DEPTH_FILE: &str = "depth.f32";
        for old in [COLOR_FILE, DEPTH_FILE].map(|name| self.folder.path().join(name)) {
            if old.exists() {
                fs::remove_file(&old).map_err(|cause| Error::writing(&old, "remove", &cause))?;
            }
        }
        let (time, has_depth) = self.draw(RenderRequest {
            color: Some(self.text_of(COLOR_FILE)?),
            depth: Some(self.text_of(DEPTH_FILE)?),
            ..RenderRequest::timed(scene.id)
        })?;
        let size = scene.size;
        let color = self.plane(COLOR_FILE, size, 4)?;
        if !color.iter().all(|v| v.is_finite()) {
            return Err((self.process).failed("gave a colour that is infinite or NaN"));
        }
        let color: Vec<[f32; 4]> = color.as_chunks().0.to_vec();
        let display =
            |&pixel: &[f32; 4]| display(pixel.map(f64::from), &scene.tone).map(|c| c as f32);
        let mut layers = Layers::default();
        if has_depth {
            let depth = self.plane(DEPTH_FILE, size, 1)?;
            if !depth.iter().all(|&mm| mm >= 0.0) {
                return Err((self.process).failed("gave a depth that is negative or NaN"));
            }
            layers.insert(DEPTH, depth);
        }
        let frame = Frame {
            size,
            display: Some(color.iter().map(display).collect()),
            color,
            layers,
        };
        Ok(PeerFrame { time, frame })
    }

    /// The picture's time, and whether its depth was written.
    fn draw(&mut self, request: RenderRequest) -> Result<(PeerTime, bool)> {
        let rendered: Rendered = ask(&mut self.process, Some(Request::Render(request)), "render")?;
        let time = PeerTime {
            ms: self.duration(rendered.ms)?,
            cpu_ms: (rendered.cpu_ms).map(|ms| self.duration(ms)).transpose()?,
        };
        Ok((time, rendered.depth))
    }

    /// A file of the folder, as JSON can hold it.
    fn text_of(&self, name: &str) -> Result<String> {
        let path: PathBuf = self.folder.path().join(name);
        path.to_str().map(str::to_owned).ok_or_else(|| {
            Error::failed(format!(
                "{}: a peer can be given only paths that are UTF-8",
                path.display()
            ))
            .hint("set TMPDIR to another folder")
        })
    }

    fn plane(&self, name: &str, size: ImageSize, channels: usize) -> Result<Vec<f32>> {
        let path = self.folder.path().join(name);
        let expected = size.pixels() * channels * size_of::<f32>();
        let bytes_written = fs::metadata(&path)
            .map_err(|_| self.process.failed(&format!("did not write {name}")))?
            .len();
        if bytes_written != expected as u64 {
            return Err(self.process.failed(&format!(
                "wrote {bytes_written} bytes of {name}: a picture of {size} has {expected}"
            )));
        }
        let bytes = fs::read(&path).map_err(|cause| Error::reading(&path, "read", &cause))?;
        let floats = bytes.as_chunks().0.iter();
        Ok(floats.map(|&bytes| f32::from_le_bytes(bytes)).collect())
    }

    fn duration(&self, ms: f64) -> Result<f64> {
        if ms.is_finite() && ms >= 0.0 {
            return Ok(ms);
        }
        Err((self.process).failed(&format!("reports that something took {ms} ms")))
    }
}

/// The peer's answer to a request, or its greeting.
fn ask<T: DeserializeOwned>(
    process: &mut Process,
    request: Option<Request>,
    doing: &str,
) -> Result<T> {
    let line = request.map(|request| request.line()).transpose()?;
    let answer = process.answer(line, doing)?;
    serde_json::from_value(serde_json::Value::Object(answer)).map_err(|cause| {
        process.failed(&format!("was to {doing} and gave another answer: {cause}"))
    })
}
