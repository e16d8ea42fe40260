//! `angioray render`.

use std::time::Instant;

use crate::VERSION;
use crate::batch::Provenance;
use crate::error::Result;
use crate::frame::{self, Frame, Layer, Wanted};
use crate::lab::measure::{BoundReached, Counts, SamplingCheck};
use crate::lab::tolerance::{Choice, Cost, ToleranceStats};
use crate::number_text::concise;
use crate::options::Resolved;
use crate::render::{GradientFigures, SampleCheck};
use crate::scene::SamplingMethod;

use super::backend::{Backend, Rendered};
use super::job::{Job, JobArguments};
use super::outputs::Files;
use super::progress::Bars;
use super::sampling_check::{self, CheckOptions};
use super::source::{Loaded, ms_since};
use super::stats::{self, Memory, Stats, Times, VolumeStats};
use super::terminal::{message, note};
use super::tolerance::choose;

/// Render a volume to a picture
#[derive(clap::Args)]
#[command(override_usage = "angioray render VOLUME -o FILE [OPTIONS]")]
#[command(after_help = "Example:
  angioray render head.nrrd -o head.png
  angioray render head.nrrd -o head.png --mode mip --view left --zoom 1.5
  angioray render cta.nii.gz -o cta.png --mode dvr --tf cta --shading phong --carm 'LAO 30 CRA 20'
  angioray render head.nrrd -o lit.png --light camera:-1,1,1@ivory --light point:40,-90,60@0.5
  angioray render head.nrrd -o fog.png --mode dvr --shading phong --shade-from 5%
  angioray render head.nrrd -o soft.png --ao rays=16,distance=5
  angioray render head.nrrd -o soft.exr --ao bound=0.1,distance=5 --size 128 --aov all
  angioray render head.nrrd -o shadow.png --shadows on --light-size 5 --light camera:-1,1,1
  angioray render head.nrrd -o near.png --dof focus=percentile:20,aperture=2
  angioray render head.nrrd -o near.png --dof focus=auto,aperture=2,darken=0.5 --dof-method lens:16
  angioray render head.nrrd -o soft.png --ssao radius=5
  angioray render head.nrrd -o far.png --cue fog:0.7 --cue halo:0.8 --background white
  angioray render head.nrrd -o depth.png --cue chromadepth:1,ramp=red-white-blue,steps=8 --mode mip
  angioray render head.nrrd -o film.png --mode mip --window p99.9,p1 --background white
  angioray render head.nrrd -o head.png --aa 4:adaptive
  angioray render head.nrrd -o head.png --mode dvr --step 2 --jitter interleaved:4 --check-sampling
  angioray render head.nrrd -o head.png --mode mip --sparse 4 --refill flood
  angioray render head.nrrd -o head.png --mode mip --screen-error 0.01
  angioray render head.nrrd -o head.png --mode mip --max-error rmse:0.002
  angioray render head.nrrd -o head.exr --iso 50% --aov all --stats head.json --device reference
  angioray render --scene head.png -o left.png --view left --size 1024x1024")]
pub struct RenderArguments {
    #[command(flatten)]
    job: JobArguments,

    #[command(flatten)]
    check: CheckOptions,
}

impl RenderArguments {
    pub fn run(self) -> Result<()> {
        let file = self.job.scene_file()?;
        let check = self.check.over(file.group()?);
        let mut job = self.job.over(&file)?;
        let files = job.output.clone().files(job.options.mode())?;
        files.check(&job.inputs)?;
        let backend = Backend::open(&job.device)?;
        let check_sampling = check.wanted(&backend, job.bound)?;
        let bars = Bars::new();
        let mut loaded = job.source.load(backend.device_info(), &bars)?;
        job.options = loaded.measured(job.options);
        loaded.frame(std::slice::from_ref(&job.options))?;
        draw(Drawing {
            command: "render",
            job: &job,
            files: &files,
            backend: &backend,
            loaded: &loaded,
            check_sampling,
            bars: &bars,
        })
    }
}

/// A picture that is to be made.
pub struct Drawing<'a> {
    /// The command, as the statistics name it.
    pub command: &'static str,
    pub job: &'a Job,
    pub files: &'a Files,
    pub backend: &'a Backend,
    pub loaded: &'a Loaded,
    /// Whether it is checked that its step will do.
    pub check_sampling: bool,
    pub bars: &'a Bars,
}

/// Renders the picture, writes it and its statistics, and says what was written.
pub fn draw(drawing: Drawing<'_>) -> Result<()> {
    let Drawing {
        job,
        files,
        backend,
        loaded,
        bars,
        ..
    } = drawing;
    let mut resolved = job.options.resolve(&loaded.subject)?;
    resolved.notes.iter().for_each(note);
    files.encoding.check_size(resolved.scene.size)?;

    let wanted = Wanted::for_encoding(&files.encoding, files.stats.is_some());
    let wanted = match resolved.scene.occlusion_error() {
        Some(_) => wanted.with([Layer::Kind, Layer::OcclusionBound]),
        None => wanted,
    };
    let prepared = backend.prepare(&loaded.volume, &job.source, bars)?;
    let mut caster = backend.caster(&loaded.volume, &prepared)?;
    let choice = match job.bound {
        Some(bound) => choose(bound, &job.options, loaded, wanted, &[], &mut caster, bars)?,
        None => None,
    };
    if let Some(choice) = &choice {
        resolved = choice.resolved.clone();
    }
    let check = match drawing.check_sampling {
        true => Some(sampling_check::check(&mut caster, &resolved.scene, bars)?),
        false => None,
    };
    let mut rendered = caster.render(&resolved.scene, wanted, bars)?;

    if let Some(figures) = &rendered.gradients {
        note(gradient_note(figures));
    }
    let began = Instant::now();
    write_picture(&drawing, &rendered.frame, &resolved)?;
    let chosen = choice
        .as_ref()
        .map_or(Cost::default(), |choice| choice.cost);
    let times_ms = std::mem::take(&mut rendered.times_ms);
    let times_ms = Times {
        read: loaded.read_ms,
        smooth: loaded.smooth_ms,
        encode: ms_since(began),
        build: times_ms.build + chosen.build_ms,
        upload: times_ms.upload + chosen.upload_ms,
        ..times_ms
    };
    message(format_args!(
        "wrote {}: {} {}, {:.1} ms on {}",
        files.picture.display(),
        resolved.scene.picture.mode(),
        resolved.scene.size,
        times_ms.render,
        rendered.device.name
    ));
    print_findings(&drawing, &rendered, &resolved);
    if let Some(check) = &check {
        message(sampling_check::line(check, resolved.scene.picture.mode()));
    }
    let found = Found { choice, check };
    write_stats(&drawing, rendered, times_ms, &resolved, &found)
}

/// What was found about how the picture's rays are followed.
struct Found {
    choice: Option<Choice>,
    check: Option<SamplingCheck>,
}

/// Writes the picture, with what it was made of where its format carries that.
fn write_picture(drawing: &Drawing<'_>, frame: &Frame, resolved: &Resolved) -> Result<()> {
    let files = drawing.files;
    if !files.encoding.format.carries_metadata() {
        return frame::write(&files.picture, frame, &files.encoding, &[]);
    }
    let scene = resolved.options.to_toml()?;
    let from = provenance(drawing.loaded, drawing.backend);
    frame::write(
        &files.picture,
        frame,
        &files.encoding,
        &from.metadata(&scene),
    )
}

/// Everything but their scene that pictures of this volume by this backend depend on.
pub fn provenance(loaded: &Loaded, backend: &Backend) -> Provenance {
    Provenance {
        version: VERSION,
        content: loaded.content(),
        device: backend.device().name,
    }
}

/// Says how much is proven of a picture of which something can be: a surface that is solved.
fn print_certificate(frame: &Frame, resolved: &Resolved) {
    if let Some(undecided) = frame.undecided()
        && resolved.scene.sampling_method() == SamplingMethod::Exact
    {
        let pixels = frame.size.pixels();
        message(format_args!(
            "certificate: {undecided} of {pixels} pixels undecided, a share of {:.1e}",
            undecided as f64 / pixels as f64
        ));
    }
}

/// Says what is known of the picture: how much of it is proven, how near to the truth its occlusion and its means of rays are, and
/// where it is in focus.
fn print_findings(drawing: &Drawing<'_>, rendered: &Rendered, resolved: &Resolved) {
    print_certificate(&rendered.frame, resolved);
    if let Some(reached) = reached(drawing, &rendered.frame, resolved) {
        message(bound_line(&reached));
    }
    if let Some(check) = &rendered.sample_check {
        message(check_line(check));
    }
    if let Some(focus_mm) = rendered.focus_mm {
        message(format!(
            "focus: {} mm from the eye along the view axis",
            concise(focus_mm)
        ));
    }
}

/// How near to the truth the occlusion is, where a device bounds it.
fn reached(drawing: &Drawing<'_>, frame: &Frame, resolved: &Resolved) -> Option<BoundReached> {
    match drawing.backend {
        Backend::Reference => None,
        _ => BoundReached::of(frame, resolved.scene.occlusion_error()?),
    }
}

/// How near to the truth bounded occlusion is.
fn bound_line(reached: &BoundReached) -> String {
    let BoundReached {
        asked,
        hits,
        beyond,
        ..
    } = *reached;
    let all = format!("occlusion: within {asked} of the truth");
    if beyond == 0 {
        return format!("{all} at every hit");
    }
    format!(
        "{all} at all but {beyond} of {hits} hits; within {:.3} there",
        reached.max
    )
}

/// How much adaptive anti-aliasing may differ from the whole of it, as far as is known.
fn check_line(check: &SampleCheck) -> String {
    if check.pixels == 0 {
        return "anti-aliasing: too few pixels have one ray alone to check any".to_owned();
    }
    format!(
        "anti-aliasing: about {:.2}/255 (rmse) from all rays in every pixel; {:.1}/255 at most in {} pixels checked",
        255.0 * check.rmse,
        255.0 * check.max,
        check.pixels
    )
}

/// Writes the statistics where they are wanted.
fn write_stats(
    drawing: &Drawing<'_>,
    rendered: Rendered,
    times_ms: Times,
    resolved: &Resolved,
    found: &Found,
) -> Result<()> {
    let (files, job, loaded) = (drawing.files, drawing.job, drawing.loaded);
    let Some(path) = &files.stats else {
        return Ok(());
    };
    let choice = found.choice.as_ref();
    let chosen = choice.map_or(Cost::default(), |choice| choice.cost);
    let rays = rendered.rays();
    let stats = Stats {
        version: VERSION,
        command: drawing.command,
        scene: &resolved.options,
        volume: VolumeStats::of(&job.source.path, &loaded.volume, loaded.non_finite),
        device: rendered.device,
        channels: frame::channels(&files.encoding),
        times_ms,
        passes: rendered.passes,
        counts: Counts::of(&rendered.frame, &resolved.scene.picture, rays),
        rays_per_round: rendered.rays_per_round,
        sample_check: rendered.sample_check,
        occlusion_bound: reached(drawing, &rendered.frame, resolved),
        focus_mm: rendered.focus_mm,
        sampling_check: found.check,
        memory: Memory::now(
            rendered.device_bytes,
            rendered.gradients.map_or(0, |figures| figures.bytes),
            rendered.uploaded_bytes + chosen.uploaded_bytes,
        ),
        max_error: choice.map(ToleranceStats::of),
    };
    stats::write(&stats, path)
}

/// The note on the cost and the use of precomputed gradients.
pub fn gradient_note(figures: &GradientFigures) -> String {
    let megabytes = figures.bytes as f64 / 1e6;
    let angle = match figures.angle {
        Some(angle) => format!(
            "angle against central differences: mean {:.1}°, p99 {:.1}° (at {} places of strong gradient)",
            angle.mean_deg, angle.p99_deg, angle.places
        ),
        None => "the volume is flat".to_owned(),
    };
    format!("precomputed gradients: {megabytes:.1} MB; {angle}")
}
