//! What is known of one candidate in one mode.

use serde::Serialize;

use crate::error::Error;
use crate::frame::error::Figures;
use crate::frame::{Frame, median};
use crate::lab::measure::{Counts, Evaluation, FrameTime, Times, host_peak_bytes};
use crate::lab::report::without_folders;
use crate::scene::Mode;

use super::look::Look;
use super::mode::name_of;

/// A row of the results; what is not known yet, or cannot be, is `None`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The mode in which the candidate was measured.
    pub mode: Mode,
    /// What of the light is shown, where looks are compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look: Option<Look>,
    /// The candidate's name, with the renderer one of its own in the mode.
    pub setting: String,
    /// `angioray`, or a peer's name and version.
    pub renderer: String,
    /// The flags of the setting; empty of a peer.
    pub flags: String,
    /// The family of the setting: points of one family have one colour in plots.
    pub family: String,
    /// Why there is no picture.
    pub failure: Option<String>,
    /// How a peer's picture differs from what the scene says.
    pub note: Option<String>,
    /// The errors against the reference.
    pub error: Option<Figures>,
    /// The times of the frame, and of what is done once.
    pub times_ms: RowTimes,
    /// The passes of the frame that is nearest to the median, in launch order.
    pub passes: Vec<PassMs>,
    /// The picture's counters of rays, samples, nodes and hits; a peer has none.
    pub counts: Option<Counts>,
    /// The memory in use; unknown of a peer.
    pub memory: Option<RowMemory>,
    /// The keys of the errors by which the setting is on the Pareto front of its mode.
    pub on_front: Vec<&'static str>,
    /// The row's files beside the results.
    pub files: Option<RowFiles>,
}

/// The times of a row: of frames for display, all candidates in turn, and apart of what is done once.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct RowTimes {
    /// The number of timed frames.
    pub repeats: usize,
    /// The time from the camera set to pixels that the host can read, ms.
    pub frame: Option<Spread>,
    /// The processor time of all threads of the program that drew it, the median, ms; unknown on some
    /// systems.
    pub processor: Option<f64>,
    /// The time from the first launch to the last one's end, ms on the device's clock.
    pub render: Option<Spread>,
    /// The time to upload the volume, ms: with the first picture of all, then 0.
    pub upload: Option<f64>,
    /// The time to build the kernels that no row before this one needed, ms.
    pub build: Option<f64>,
    /// The time to classify the nodes of the octree, ms.
    pub classify: Option<f64>,
    /// The time to compute and upload precomputed gradients, ms.
    pub gradient: Option<f64>,
    /// The time of what a peer does once for the scene, ms.
    pub prepare: Option<f64>,
    /// The time to write the PNG, ms.
    pub encode: Option<f64>,
}

/// The spread of the repeats' times.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// The median, ms.
    pub median: f64,
    /// The median of the absolute deviations from the median, ms.
    pub mad: f64,
    /// The smallest time, ms.
    pub min: f64,
}

impl From<&Times> for Spread {
    fn from(times: &Times) -> Self {
        Self {
            median: times.median_ms(),
            mad: times.mad_ms(),
            min: times.min_ms(),
        }
    }
}

/// A pass, and what it took on the device's clock.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PassMs {
    /// The pass's name.
    pub name: String,
    /// The time that the pass took, ms.
    pub ms: f64,
}

/// The memory that a candidate takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct RowMemory {
    /// The most that the process held, the rows before this one included; unknown on some systems.
    pub host_peak_bytes: Option<u64>,
    /// The device memory in use after the picture, in bytes.
    pub device_bytes: u64,
    /// The bytes uploaded from host to device for this picture; with the first one of all (which may be
    /// one that an error bound was chosen by), the volume too.
    pub uploaded_bytes: u64,
}

/// File names in the comparison's folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RowFiles {
    /// The picture as PNG.
    pub png: String,
    /// The picture as EXR, with all its planes.
    pub exr: String,
    /// The error map in colours, as PNG.
    pub error_png: String,
    /// The error map's numbers, as EXR.
    pub error_exr: String,
}

impl Row {
    /// A row of a candidate of which nothing is known yet.
    pub fn new((mode, look): (Mode, Option<Look>), setting: &str, renderer: &str) -> Self {
        Self {
            mode,
            look,
            setting: setting.to_owned(),
            renderer: renderer.to_owned(),
            flags: String::new(),
            family: renderer.to_owned(),
            failure: None,
            note: None,
            error: None,
            times_ms: RowTimes::default(),
            passes: Vec::new(),
            counts: None,
            memory: None,
            on_front: Vec::new(),
            files: None,
        }
    }

    /// Records why there is no picture, or no time; without folders, as results are passed on.
    pub fn fail(&mut self, error: &Error) {
        let hint = error.hint_text().map(|hint| format!(" ({hint})"));
        let why = format!("{error}{}", hint.unwrap_or_default());
        self.failure = Some(without_folders(&why));
    }

    /// Records the cost of a rendering and its error; returns its frame.
    pub fn evaluated(&mut self, evaluation: Evaluation) -> Frame {
        let rendering = evaluation.rendering;
        self.error = Some(evaluation.figures);
        self.counts = Some(evaluation.counts);
        self.memory = Some(RowMemory {
            host_peak_bytes: host_peak_bytes(),
            device_bytes: rendering.device_bytes,
            uploaded_bytes: rendering.uploaded_bytes,
        });
        self.times_ms.upload = Some(rendering.upload_ms);
        self.times_ms.build = Some(rendering.build_ms);
        self.times_ms.classify = Some(rendering.classify_ms);
        self.times_ms.gradient = rendering.gradients.map(|figures| figures.ms);
        rendering.frame
    }

    /// Records the times of the repeats; of the passes, those of the frame nearest to the median.
    pub fn timed(&mut self, frames: &[FrameTime]) {
        let frame: Times = frames.iter().map(|time| time.frame_ms).collect();
        let render: Times = frames.iter().map(|time| time.render_ms).collect();
        self.times_ms.repeats = frames.len();
        self.times_ms.frame = (!frames.is_empty()).then(|| Spread::from(&frame));
        let used = frames.iter().map(|time| time.processor_ms);
        self.times_ms.processor = used
            .collect::<Option<Vec<f64>>>()
            .and_then(|mut used| median(&mut used));
        // A peer has no device's clock.
        let clocked = frames.iter().any(|time| !time.passes.is_empty());
        self.times_ms.render = clocked.then(|| Spread::from(&render));
        let off = |time: &FrameTime| (time.frame_ms - frame.median_ms()).abs();
        let nearest = frames.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        if let Some(median) = nearest {
            let passes = median.passes.iter();
            self.passes = passes
                .map(|pass| PassMs {
                    name: pass.name.to_owned(),
                    ms: pass.ms,
                })
                .collect();
        }
    }

    /// The name of the mode, and of the look, in names of files.
    pub fn of_mode(&self) -> String {
        name_of(self.mode, self.look)
    }

    /// The title for people: the setting, after a peer's name.
    pub fn title(&self) -> String {
        match self.renderer.as_str() {
            super::OURS => self.setting.clone(),
            other => Self::title_of_peer(other, &self.setting),
        }
    }

    /// The title of a peer's row.
    pub fn title_of_peer(renderer: &str, setting: &str) -> String {
        format!("{renderer}: {setting}")
    }

    /// The remark beside the figures: why some are missing, or what a peer shows instead.
    pub fn remark(&self) -> Option<&str> {
        self.failure.as_deref().or(self.note.as_deref())
    }

    /// The median frame, ms.
    pub fn frame_ms(&self) -> Option<f64> {
        self.times_ms.frame.map(|frame| frame.median)
    }
}
