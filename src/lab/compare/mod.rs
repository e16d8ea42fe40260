//! The settings of a scene side by side: each mode in each setting, evaluated against the reference,
//! timed in turn.

mod candidate;
mod columns;
mod configs;
mod folder;
mod front;
mod look;
mod mode;
mod page;
mod pictures;
mod row;
mod timing;

pub use columns::printed_table;
pub use configs::Configs;
pub use folder::Folder;
pub use look::{Look, Preset};
pub use mode::ModeSettings;
pub use row::{PassMs, Row, RowFiles, RowMemory, RowTimes, Spread};

use std::collections::BTreeMap;

use serde_json::Value;

use crate::VERSION;
use crate::error::{Error, Result};
use crate::frame::error::{ErrorMap, figures};
use crate::frame::{Frame, Wanted};
use crate::lab::measure::{
    Peer, PeerScene, Readiness, ReferenceCache, ReferenceFrame, error_scale, evaluate,
    evaluated_planes, method_label,
};
use crate::lab::report::{self, Gallery, Section};
use crate::lab::tolerance::{Choice, SEED, Task, ToleranceStats, choose};
use crate::options::{Resolved, SceneOptions, Setting};
use crate::progress::{Progress, Stage};
use crate::render::Renderer;
use crate::scene::Scene;
use crate::subject::Subject;
use crate::volume::Volume;

use candidate::{Candidate, candidates};
use pictures::Metadata;

/// The name of this renderer in rows.
const OURS: &str = "angioray";

/// A comparison: its volume, its scenes and its settings.
pub struct Comparison<'a> {
    /// The volume that all candidates draw.
    pub volume: &'a Volume,
    /// The properties of the volume from which a mode's defaults are made.
    pub subject: Subject,
    /// Where the reference's pictures come from.
    pub reference: ReferenceCache<'a>,
    /// The modes that are compared, each with its settings.
    pub modes: Vec<ModeSettings>,
    /// How often each candidate is timed.
    pub repeats: usize,
    /// Made, and cleared of an earlier comparison, once nothing can be refused any more.
    pub folder: Folder,
    /// Facts that the results hold beside the rows, for programs.
    pub about: Value,
    /// Where progress is reported.
    pub progress: &'a dyn Progress,
}

/// The results of a comparison.
#[derive(Default)]
pub struct Compared {
    /// One row per candidate and mode.
    pub rows: Vec<Row>,
    /// A section a mode, then one of the modes side by side.
    pub sections: Vec<Section>,
    /// The findings, a sentence each.
    pub findings: Vec<String>,
    /// The options of the scene of each mode.
    pub scenes: BTreeMap<String, SceneOptions>,
    /// The choice for an error bound in each mode that has its metric.
    pub choices: BTreeMap<String, ToleranceStats>,
}

impl Comparison<'_> {
    /// Checks that every mode has candidates, each with a name of its own.
    ///
    /// # Errors
    /// Usage: it has none, or two of one name.
    pub fn check(&self, peers: &[Peer]) -> Result<()> {
        let mut modes = self.modes.iter();
        modes.try_for_each(|of_mode| candidate::check(of_mode, peers))
    }

    /// Evaluates and times every candidate of a comparison that passes [`Self::check`]. Results are
    /// written as they come, so that a later failure loses nothing; a candidate that fails has a row
    /// that says why.
    ///
    /// # Errors
    /// The reference or the disk fails.
    pub fn run(&self, renderer: &mut Renderer, peers: &mut [Peer]) -> Result<Compared> {
        self.folder.make()?;
        self.folder.clear()?;
        let mut compared = Compared::default();
        for of_mode in &self.modes {
            self.run_mode(of_mode.clone(), &mut compared, renderer, peers)?;
        }
        let side_by_side = page::side_by_side(&compared.sections);
        compared.sections.extend(side_by_side);
        Ok(compared)
    }

    fn run_mode(
        &self,
        mut of_mode: ModeSettings,
        compared: &mut Compared,
        renderer: &mut Renderer,
        peers: &mut [Peer],
    ) -> Result<()> {
        let (mode, key) = (of_mode.mode, of_mode.name());
        let before = compared.rows.len();
        let seen = of_mode.resolved.options.clone();
        compared.scenes.insert(key.clone(), seen);
        let wanted = evaluated_planes(&of_mode.resolved.scene);
        let reference = (self.reference).frame(&of_mode.resolved.scene, wanted, self.progress)?;
        let mut pictures = vec![self.write_reference(&of_mode, &reference.frame)?];
        let mut maps = Vec::new();
        self.add_choice(&mut of_mode, compared, renderer);
        let first = compared.rows.len();
        let mut candidates = candidates(&of_mode, peers);
        let name = format!("{key}: pictures");
        let stage = Stage::begin(self.progress, &name, candidates.len() as u64);
        for (number, candidate) in candidates.iter_mut().enumerate() {
            let (mut row, frame) =
                self.evaluate(&of_mode, candidate, &reference.frame, renderer, peers);
            let drawn = match frame {
                Ok(frame) => {
                    let seen = candidate.scene(&of_mode);
                    Some(self.write_pictures(
                        &mut row,
                        number + 1,
                        seen,
                        &reference.frame,
                        &frame,
                    )?)
                }
                Err(error) => {
                    row.fail(&error);
                    None
                }
            };
            if let Some((picture, map)) = drawn {
                pictures.push(picture);
                maps.push(map);
            }
            compared.rows.push(row);
            self.folder.write_results(&self.about, compared)?;
            stage.advance(1);
        }
        drop(stage);
        let rows = &mut compared.rows[first..];
        self.time(&of_mode, &candidates, rows, renderer, peers)?;
        for peer in peers.iter_mut() {
            // One that died has its failure in its rows.
            let _ = peer.forget();
        }
        let rows = &mut compared.rows[before..];
        front::mark_front(mode, rows);
        let gallery = self.gallery(rows, pictures, maps)?;
        let about = self.about_mode(&of_mode, &reference);
        let section = page::section((mode, of_mode.look), about, rows, gallery);
        let finding = page::finding((mode, of_mode.look), rows);
        compared.sections.push(section);
        compared.findings.extend(finding);
        self.folder.write_results(&self.about, compared)
    }

    /// A mode's pictures, the reference first, with captions and with the error maps of the rows that have a
    /// picture.
    fn gallery(
        &self,
        rows: &[Row],
        mut pictures: Vec<report::Picture>,
        maps: Vec<ErrorMap>,
    ) -> Result<Gallery> {
        let maps = pictures::to_one_scale(maps)?;
        let pictured = || {
            let rows = rows.iter();
            rows.filter_map(|row| Some((row, row.files.as_ref()?)))
        };
        for (((row, files), picture), map) in pictured().zip(&mut pictures[1..]).zip(&maps) {
            picture.caption = page::caption(row.mode, row);
            picture.error_map = Some(pictures::recolored(&self.folder, files, map)?);
        }
        let rows = pictured().map(|(row, _)| row);
        let opens_on = page::opening_row(rows.zip(&maps)).map(|at| at + 1);
        Ok(Gallery { pictures, opens_on })
    }

    /// Adds what a bound chooses for the mode, or a row that says why it chose nothing.
    fn add_choice(
        &self,
        of_mode: &mut ModeSettings,
        compared: &mut Compared,
        renderer: &mut Renderer,
    ) {
        let key = of_mode.name();
        match self.choose(of_mode, renderer) {
            Ok(None) => {}
            Ok(Some(choice)) => {
                compared.findings.push(format!("{key}: {choice}"));
                let stored = ToleranceStats::of(&choice);
                compared.choices.insert(key, stored);
            }
            Err(error) => {
                let names = of_mode.names();
                let name = names.last().map_or("max-error", String::as_str);
                let mut row = Row::new(of_mode.seen_as(), name, OURS);
                row.fail(&error);
                compared.rows.push(row);
            }
        }
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
            wanted: Wanted::DISPLAY,
            seed: SEED,
            elsewhere: &[],
        };
        let choice = choose(&task, renderer, self.progress)?;
        let how = choice.setting.options().clone();
        let setting = Setting::new(ModeSettings::name_of_bound(bound), how)?;
        of_mode.add(setting, &self.subject)?;
        Ok(Some(choice))
    }

    /// Writes the reference's picture; returns it as the report shows it.
    fn write_reference(&self, of_mode: &ModeSettings, frame: &Frame) -> Result<report::Picture> {
        let name = Folder::picture_name(&of_mode.name(), 0, candidate::REFERENCE);
        let scene = of_mode.resolved.options.to_toml()?;
        let metadata: &Metadata = &[("scene", &scene), ("version", VERSION)];
        let written = pictures::write(&self.folder, &name, frame, metadata)?;
        Ok(report::Picture {
            label: candidate::REFERENCE.into(),
            caption: "in double precision, by definition".into(),
            png: pictures::bytes(&self.folder.file(&written.png))?,
            error_map: None,
        })
    }

    /// A candidate's row, evaluated but not timed yet, and its picture.
    fn evaluate(
        &self,
        of_mode: &ModeSettings,
        candidate: &mut Candidate,
        reference: &Frame,
        renderer: &mut Renderer,
        peers: &mut [Peer],
    ) -> (Row, Result<Frame>) {
        let scale = error_scale(self.volume);
        let seen = &of_mode.resolved.scene;
        match candidate {
            Candidate::Setting(at) => {
                let (setting, Resolved { scene, .. }) = &of_mode.settings[*at];
                let mut row = Row::new(of_mode.seen_as(), setting.name(), OURS);
                row.flags = setting.flags();
                row.family = method_label(scene);
                let evaluation = evaluate(renderer, scene, reference, scale);
                let frame = evaluation.map(|evaluation| row.evaluated(evaluation));
                (row, frame)
            }
            Candidate::Peer {
                peer,
                setting,
                scene,
            } => {
                let peer = &mut peers[*peer];
                let mut row = Row::new(of_mode.seen_as(), setting, &candidate::renderer_name(peer));
                let frame = self.ready(peer, seen, setting).and_then(|ready| {
                    row.times_ms.prepare = Some(ready.ready_ms);
                    row.note = ready.note.as_deref().map(report::without_folders);
                    let frame = peer.render(scene.insert(ready))?.frame;
                    row.error = Some(figures(reference, &frame, scale)?);
                    Ok(frame)
                });
                (row, frame)
            }
        }
    }

    /// Writes a candidate's picture and error map; returns them, the picture as the report shows it but
    /// for its map, whose colours depend on the other candidates'.
    fn write_pictures(
        &self,
        row: &mut Row,
        number: usize,
        seen: &Resolved,
        reference: &Frame,
        frame: &Frame,
    ) -> Result<(report::Picture, ErrorMap)> {
        let name = Folder::picture_name(&row.of_mode(), number, &row.title());
        let scale = error_scale(self.volume);
        let figures = match row.error {
            Some(figures) => figures,
            None => figures(reference, frame, scale)?,
        };
        let scene = seen.options.to_toml()?;
        let metadata: &Metadata = &[("scene", &scene), ("version", VERSION)];
        let written = pictures::write(&self.folder, &name, frame, metadata)?;
        let map = pictures::error_map(reference, frame, &figures, scale)?;
        let (error_png, error_exr) = pictures::write_map(&self.folder, &name, &map)?;
        let picture = report::Picture {
            label: row.title(),
            caption: String::new(),
            png: pictures::bytes(&self.folder.file(&written.png))?,
            error_map: None,
        };
        row.times_ms.encode = Some(written.encode_ms);
        row.files = Some(RowFiles {
            png: written.png,
            exr: written.exr,
            error_png,
            error_exr,
        });
        Ok((picture, map))
    }

    fn about_mode(&self, of_mode: &ModeSettings, reference: &ReferenceFrame) -> String {
        let pixels = reference.frame.size.pixels();
        let frames = match self.repeats {
            1 => "one frame".to_owned(),
            repeats => format!("{repeats} frames"),
        };
        let computed = match (reference.computed, &reference.not_cached) {
            (false, _) => "cached by an earlier comparison".to_owned(),
            (true, None) => "computed for this one".to_owned(),
            (true, Some(why)) => format!(
                "computed for this one and could not be cached ({})",
                report::without_folders(&why.to_string())
            ),
        };
        format!(
            "{pixels} rays; every setting drew {frames} in turn with the others after one to warm \
             up, and its error is over all pixels against the reference, which was {computed}. {}",
            of_mode.resolved.notes.join("; ")
        )
    }

    fn ready(&self, peer: &mut Peer, scene: &Scene, setting: &str) -> Result<PeerScene> {
        match peer.prepare(self.volume, scene, setting)? {
            Readiness::Ready(ready) => Ok(ready),
            Readiness::Unsupported { why } => Err(Error::failed(why)),
        }
    }
}
