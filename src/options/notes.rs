//! What a user may want to know of what was chosen for them: one sentence each.

use glam::DVec3;

use super::SceneOptions;
use super::picture::PictureOptions;
use super::step_cost::cost_note;
use super::threshold::Threshold;
use crate::extent::Range;
use crate::number_text::{concise, concise_within};
use crate::scene::{
    ClipPlane, Light, LightPlace, Mode, Picture, SamplingMethod, Scene, TransferFile,
};
use crate::subject::{Sphere, Subject};

impl SceneOptions {
    /// Sentences on the defaults and computed values in a scene that these options made, `complete` being
    /// the options with them in their place.
    pub(super) fn notes(&self, scene: &Scene, complete: &Self, subject: &Subject) -> Vec<String> {
        let mut notes = Vec::new();
        notes.extend(self.idle_steps_note(scene));
        notes.extend(self.suggested_notes(complete, subject));
        notes.extend(replaced(&self.picture, &complete.picture, subject.range));
        notes.extend(no_surface_note(&scene.picture, subject.range));
        notes.extend(self.robust_range_note(subject));
        notes.extend(headlight_note(scene));
        notes.extend(clip_notes(&scene.clip_planes, subject));
        notes.extend(cost_note(scene, subject));
        if self.mode() == Mode::Dvr && self.picture.tf.is_none() {
            let preset = TransferFile::DEFAULT_PRESET;
            notes.push(format!("tf = {preset}: --tf chooses another"));
        }
        notes
    }

    /// The note that an option for fixed steps is given although there are none.
    fn idle_steps_note(&self, scene: &Scene) -> Option<String> {
        if scene.sampling.method != SamplingMethod::Exact || !self.steps_given() {
            return None;
        }
        let exact = match &scene.picture {
            Picture::Emission(medium) => format!("quad = {}", medium.quadrature),
            _ => "sampling = exact".to_owned(),
        };
        Some(format!(
            "{exact} takes no steps: step, jitter, refine, probe and recon have no effect"
        ))
    }

    /// The notes on values that the histogram suggested.
    fn suggested_notes(&self, complete: &Self, subject: &Subject) -> Vec<String> {
        let suggested = |key, given: Option<Threshold>, complete: Option<Threshold>| {
            let (None, Some(Threshold::Value(value))) = (given, complete) else {
                return None;
            };
            Some(format!(
                "{key} = {}, suggested by the histogram: --{key} chooses another",
                concise_within(value, subject.range)
            ))
        };
        let (given, complete) = (&self.picture, &complete.picture);
        let iso = suggested("iso", given.iso, complete.iso);
        let threshold = suggested(
            "lmip-threshold",
            given.lmip_threshold,
            complete.lmip_threshold,
        );
        iso.into_iter().chain(threshold).collect()
    }

    /// The note that defaults are made from a part of the values.
    fn robust_range_note(&self, subject: &Subject) -> Option<String> {
        let (robust, whole) = (subject.robust_range, subject.range);
        if robust == whole || !self.picture.takes_robust_range() {
            return None;
        }
        let within = |value| concise_within(value, whole);
        Some(format!(
            "the defaults cover the values {} to {}: outliers or padding reach from {} to {}",
            within(robust.min),
            within(robust.max),
            within(whole.min),
            within(whole.max)
        ))
    }
}

/// The note that shadows are asked for of a light that casts none.
fn headlight_note(scene: &Scene) -> Option<String> {
    let is_headlight = |light: &Light| light.place == LightPlace::Headlight;
    let idle = scene.shadows.is_some() && scene.lights.iter().any(is_headlight);
    idle.then(|| {
        "a headlight casts no shadow: --light puts a light elsewhere, such as camera:-1,1,1"
            .to_owned()
    })
}

/// Why a surface's iso value outside the volume's values shows no surface, and what it shows.
fn no_surface_note(picture: &Picture, range: Range) -> Option<String> {
    let Picture::Surface { iso, caps, .. } = *picture else {
        return None;
    };
    if range.contains(iso) {
        return None;
    }
    let (side, shown) = match (iso < range.min, caps) {
        (true, true) => (
            "below",
            "all of the volume is inside, and only its caps are shown, where it ends or is clipped",
        ),
        (true, false) => (
            "below",
            "all of the volume is inside, and without caps nothing is shown",
        ),
        (false, _) => ("above", "nothing is shown"),
    };
    Some(format!(
        "iso = {} lies {side} the volume's values, {} to {}: there is no surface, {shown}",
        concise_within(iso, range),
        concise_within(range.min, range),
        concise_within(range.max, range)
    ))
}

/// A sentence on each value that is written otherwise than as the number that `by` has for it.
pub(super) fn replaced(written: &PictureOptions, by: &PictureOptions, range: Range) -> Vec<String> {
    let shown = |threshold| match threshold {
        Threshold::Value(value) => concise_within(value, range),
        other => other.to_string(),
    };
    let of = |key: &str, written: Option<Threshold>, by: Option<Threshold>| {
        let (written, by) = (written?, by?);
        (written != by).then(|| format!("{key} = {written} is {}", shown(by)))
    };
    let window = written.window.zip(by.window);
    let window = window.filter(|(written, by)| written != by);
    [
        of("iso", written.iso, by.iso),
        of("lmip-threshold", written.lmip_threshold, by.lmip_threshold),
        window.map(|(written, by)| {
            format!(
                "window = {written} is {},{}",
                shown(by.black),
                shown(by.white)
            )
        }),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// A sentence on each plane that alone cuts all of the volume away.
fn clip_notes(planes: &[ClipPlane], subject: &Subject) -> Vec<String> {
    let cuts_all = |plane: &&ClipPlane| {
        let Sphere {
            center_world,
            radius_mm,
        } = subject.sphere;
        let inmost = center_world - plane.outward_world() * radius_mm;
        let space = glam::DAffine3::from_translation(inmost);
        plane.in_space(space).1 < 0.0
    };
    let planes = planes.iter().filter(cuts_all);
    let notes = planes.map(|plane| {
        let DVec3 { x, y, z } = plane.normal_world();
        let numbers = [x, y, z, plane.offset()].map(concise).join(",");
        format!("clip-plane = {numbers} keeps nothing of the volume")
    });
    notes.collect()
}
