//! The settings of a scene side by side: each mode in each setting, judged against the reference,
//! timed in turn.

mod columns;
mod configs;
mod contender;
mod folder;
mod mode;
mod page;
mod pictures;
mod row;

pub use columns::printed_table;
pub use configs::Configs;
pub use folder::Folder;
pub use mode::ModeSettings;
pub use row::{PassMs, Row, RowFiles, RowMemory, RowTimes, Spread};

use serde_json::Value;

use crate::error::{Error, Result};
use crate::frame::error::figures;
use crate::frame::{Frame, Wanted};
use crate::measure::{
    FrameTime, Peer, PeerScene, Readiness, Tradeoff, Truth, Wrongness, family, front, judge,
    judged_planes, rounds, scale_of, time,
};
use crate::progress::Progress;
use crate::render::Renderer;
use crate::report::{self, Section};
use crate::scene::{Mode, Scene, Setting, Subject};
use crate::tolerance::{Choice, Task, choose};
use crate::volume::Volume;

use contender::Contender;

/// How rows call this renderer.
const OURS: &str = "angioray";

/// Of the tiles upon which a bound chooses.
const SEED: u64 = 1;

/// What is compared.
pub struct Comparison<'a> {
    pub volume: &'a Volume,
    pub subject: Subject,
    pub truth: Truth<'a>,
    pub modes: Vec<ModeSettings>,
    /// How often each contender is timed.
    pub repeats: usize,
    pub folder: Folder,
    /// What results say beside their rows, for programs.
    pub about: Value,
    pub progress: &'a dyn Progress,
}

/// The rows of a comparison, and the files that it left.
pub struct Compared {
    pub rows: Vec<Row>,
    /// A section a mode.
    pub sections: Vec<Section>,
    /// What came out, a sentence each.
    pub findings: Vec<String>,
}

impl Comparison<'_> {
    /// Judges and times every contender. What is known is written as it is learnt, so that a later
    /// failure loses nothing; a contender that fails has a row that says why.
    ///
    /// # Errors
    /// The reference or the disk fails.
    pub fn run(&self, renderer: &mut Renderer, peers: &mut [Peer]) -> Result<Compared> {
        let mut compared = Compared {
            rows: Vec::new(),
            sections: Vec::new(),
            findings: Vec::new(),
        };
        for of_mode in &self.modes {
            let before = compared.rows.len();
            let (truth, reference) = self.truth(of_mode)?;
            let mut pictures = vec![reference];
            let mut of_mode = of_mode.clone();
            if let Some(choice) = self.choose(&mut of_mode, renderer)? {
                compared
                    .findings
                    .push(format!("{}: {choice}", of_mode.mode));
            }
            let of_mode = &of_mode;
            let mut contenders = contenders(of_mode, peers);
            for (number, contender) in contenders.iter_mut().enumerate() {
                let (mut row, frame) = self.contend(of_mode, contender, &truth, renderer, peers);
                match frame {
                    Ok(frame) => {
                        let picture = self.keep(&mut row, number + 1, &truth, &frame)?;
                        pictures.push(picture);
                    }
                    Err(error) => row.failure = Some(error.to_string()),
                }
                compared.rows.push(row);
                self.folder.write_results(&self.about, &compared.rows)?;
            }
            let rows = &mut compared.rows[before..];
            self.time(of_mode, &contenders, rows, renderer, peers)?;
            for peer in peers.iter_mut() {
                // One that died has told so in its rows.
                let _ = peer.forget();
            }
            mark_front(of_mode.mode, rows);
            let pictured = rows.iter().filter(|row| row.files.is_some());
            for (row, picture) in pictured.zip(&mut pictures[1..]) {
                picture.caption = page::caption(of_mode.mode, row);
            }
            let about = self.about_mode(of_mode, &truth);
            let section = page::section(of_mode.mode, about, rows, pictures);
            compared.sections.push(section);
            compared.findings.extend(page::finding(of_mode.mode, rows));
            self.folder.write_results(&self.about, &compared.rows)?;
        }
        Ok(compared)
    }

    /// Adds the setting that a bound chooses, where there is a bound.
    fn choose(
        &self,
        of_mode: &mut ModeSettings,
        renderer: &mut Renderer,
    ) -> Result<Option<Choice>> {
        let Some(bound) = of_mode.bound else {
            return Ok(None);
        };
        let task = Task {
            volume: self.volume,
            subject: &self.subject,
            options: &of_mode.resolved.options.what(),
            bound,
            wanted: Wanted {
                display: true,
                ..Wanted::default()
            },
            seed: SEED,
            elsewhere: &[],
        };
        let choice = choose(&task, renderer, self.progress)?;
        let how = choice.setting.options().clone();
        of_mode.add(
            Setting::new(format!("max-error {bound}"), how)?,
            &self.subject,
        )?;
        Ok(Some(choice))
    }

    /// The reference's picture, as it is and as the report shows it.
    fn truth(&self, of_mode: &ModeSettings) -> Result<(Frame, report::Picture)> {
        let scene = &of_mode.resolved.scene;
        let wanted = judged_planes(&scene.picture);
        let frame = self.truth.frame(scene, wanted, self.progress)?.frame;
        let name = Folder::picture_name(scene.picture.mode(), 0, "reference");
        let (png, _, _) = pictures::write(&self.folder, &name, &frame)?;
        let picture = report::Picture {
            label: "reference".into(),
            caption: "in double precision, by definition".into(),
            png: pictures::bytes(&self.folder.file(&png))?,
            error_map: None,
        };
        Ok((frame, picture))
    }

    /// A contender's row, judged but not timed yet, and its picture.
    fn contend(
        &self,
        of_mode: &ModeSettings,
        contender: &mut Contender,
        truth: &Frame,
        renderer: &mut Renderer,
        peers: &mut [Peer],
    ) -> (Row, Result<Frame>) {
        let scale = scale_of(self.volume);
        let seen = &of_mode.resolved.scene;
        match contender {
            Contender::Setting(at) => {
                let (setting, scene) = &of_mode.settings[*at];
                let mut row = Row::new(seen.picture.mode(), setting.name(), OURS);
                row.flags = setting.flags();
                row.family = family(scene);
                let judged = judge(renderer, scene, truth, scale);
                let frame = judged.map(|judged| row.judged(judged));
                (row, frame)
            }
            Contender::Peer {
                peer,
                setting,
                scene,
            } => {
                let peer = &mut peers[*peer];
                let name = format!("{} {}", peer.name(), peer.version());
                let mut row = Row::new(seen.picture.mode(), setting, &name);
                let frame = self.ready(peer, seen, setting).and_then(|ready| {
                    row.times_ms.prepare = Some(ready.ready_ms);
                    row.note.clone_from(&ready.note);
                    let frame = peer.render(scene.insert(ready))?.frame;
                    row.error = Some(figures(truth, &frame, scale)?);
                    Ok(frame)
                });
                (row, frame)
            }
        }
    }

    /// Writes a contender's picture and error map; gives them as the report shows them.
    fn keep(
        &self,
        row: &mut Row,
        number: usize,
        truth: &Frame,
        frame: &Frame,
    ) -> Result<report::Picture> {
        let name = Folder::picture_name(row.mode, number, &row.title());
        let scale = scale_of(self.volume);
        let (files, encode_ms, map) =
            pictures::write_judged(&self.folder, &name, truth, frame, scale)?;
        let picture = report::Picture {
            label: row.title(),
            caption: String::new(),
            png: pictures::bytes(&self.folder.file(&files.png))?,
            error_map: Some(pictures::shown(&map)?),
        };
        row.files = Some(files);
        row.times_ms.encode = Some(encode_ms);
        Ok(picture)
    }

    fn about_mode(&self, of_mode: &ModeSettings, truth: &Frame) -> String {
        let pixels = truth.size.pixels();
        let frames = match self.repeats {
            1 => "one frame".to_owned(),
            repeats => format!("{repeats} frames"),
        };
        format!(
            "{pixels} rays; every setting drew {frames} in turn with the others after one to warm \
             up, and its error is over all pixels against the reference. {}",
            of_mode.resolved.notes.join("; ")
        )
    }

    fn ready(&self, peer: &mut Peer, scene: &Scene, setting: &str) -> Result<PeerScene> {
        match peer.prepare(self.volume, scene, setting)? {
            Readiness::Ready(ready) => Ok(ready),
            Readiness::Unsupported { why } => Err(Error::failed(why)),
        }
    }

    /// All that have a picture, in turn.
    fn time(
        &self,
        of_mode: &ModeSettings,
        contenders: &[Contender],
        rows: &mut [Row],
        renderer: &mut Renderer,
        peers: &mut [Peer],
    ) -> Result<()> {
        let sound: Vec<usize> = (0..rows.len())
            .filter(|&at| rows[at].failure.is_none())
            .collect();
        let frames = sound.len() * (self.repeats + 1);
        self.progress.begin("timing", frames as u64);
        // One that fails now keeps its picture and says so.
        let times = rounds(&sound, self.repeats, |&at| {
            self.progress.advance(1);
            Ok(match &contenders[at] {
                Contender::Setting(at) => time(renderer, &of_mode.settings[*at].1),
                Contender::Peer { peer, scene, .. } => match scene {
                    Some(scene) => peer_time(&mut peers[*peer], scene),
                    None => Err(Error::failed("it has no scene ready")),
                },
            })
        });
        self.progress.end();
        for (&at, times) in sound.iter().zip(times?) {
            match times.into_iter().collect::<Result<Vec<FrameTime>>>() {
                Ok(times) => rows[at].timed(&times),
                Err(error) => rows[at].failure = Some(error.to_string()),
            }
        }
        Ok(())
    }
}

fn peer_time(peer: &mut Peer, scene: &PeerScene) -> Result<FrameTime> {
    let time = peer.time(scene)?;
    Ok(FrameTime {
        frame_ms: time.ms,
        render_ms: time.ms,
        passes: Vec::new(),
    })
}

/// The settings, then what the peers have for the mode.
fn contenders(of_mode: &ModeSettings, peers: &[Peer]) -> Vec<Contender> {
    let mode = of_mode.resolved.scene.picture.mode();
    let settings = (0..of_mode.settings.len()).map(Contender::Setting);
    let others = peers.iter().enumerate().flat_map(|(peer, one)| {
        let settings = one.settings(mode).into_iter();
        settings.map(move |setting| Contender::Peer {
            peer,
            setting,
            scene: None,
        })
    });
    settings.chain(others).collect()
}

/// By each way of telling how wrong the mode's pictures are.
fn mark_front(mode: Mode, rows: &mut [Row]) {
    for wrongness in Wrongness::of_mode(mode) {
        let point = |row: &Row| {
            let error = wrongness.of(row.error.as_ref()?)?;
            let time = row.frame_ms()?;
            Some(Tradeoff { time, error })
        };
        let placed: Vec<(usize, Tradeoff)> = (0..rows.len())
            .filter_map(|at| Some((at, point(&rows[at])?)))
            .collect();
        let points: Vec<Tradeoff> = placed.iter().map(|(_, point)| *point).collect();
        for ((at, _), on_front) in placed.iter().zip(front(&points)) {
            if on_front {
                rows[*at].on_front.push(wrongness.key);
            }
        }
    }
}
