//! What is known of one candidate in one mode.

use serde::Serialize;

use crate::error::Error;
use crate::frame::error::Figures;
use crate::frame::{Frame, median};
use crate::lab::measure::{Counts, Evaluation, FrameTime, Times, host_peak_bytes};
use crate::lab::report::without_folders;
use crate::scene::Mode;

/// A row of the results; what is not known yet, or cannot be, is `None`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    pub mode: Mode,
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
    pub error: Option<Figures>,
    pub times_ms: RowTimes,
    /// The passes of the frame that is nearest to the median, in launch order.
    pub passes: Vec<PassMs>,
    pub counts: Option<Counts>,
    pub memory: Option<RowMemory>,
    /// The keys of the errors by which the setting is on the Pareto front of its mode.
    pub on_front: Vec<&'static str>,
    /// The row's files beside the results.
    pub files: Option<RowFiles>,
}

/// Frames for display, all candidates in turn; what is done once is apart.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct RowTimes {
    pub repeats: usize,
    /// The time from the camera set to pixels that the host can read, ms.
    pub frame: Option<Spread>,
    /// The processor time of all threads of the program that drew it, the median; unknown on some
    /// systems.
    pub processor: Option<f64>,
    /// The time from the first launch to the last one's end, ms on the device's clock.
    pub render: Option<Spread>,
    /// Uploading the volume: with the first picture of all, then 0.
    pub upload: Option<f64>,
    /// Compiling the kernels that no row before this one needed.
    pub build: Option<f64>,
    /// Classifying the nodes of the octree.
    pub classify: Option<f64>,
    /// Computing and uploading precomputed gradients.
    pub gradient: Option<f64>,
    /// Time of what a peer does once for the scene, ms.
    pub prepare: Option<f64>,
    /// Time to write the PNG, ms.
    pub encode: Option<f64>,
}

/// The spread of the repeats' times.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    pub median: f64,
    /// The median of the absolute deviations from the median.
    pub mad: f64,
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
    pub name: String,
    pub ms: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct RowMemory {
    /// The most that the process held, the rows before this one included; unknown on some systems.
    pub host_peak_bytes: Option<u64>,
    pub device_bytes: u64,
    /// The bytes uploaded from host to device for this picture; with the first one of all (which may be
    /// one that an error bound was chosen by), the volume too.
    pub uploaded_bytes: u64,
}

/// File names in the comparison's folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RowFiles {
    pub png: String,
    pub exr: String,
    pub error_png: String,
    pub error_exr: String,
}

impl Row {
    /// A row of a candidate of which nothing is known yet.
    pub fn new(mode: Mode, setting: &str, renderer: &str) -> Self {
        Self {
            mode,
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
