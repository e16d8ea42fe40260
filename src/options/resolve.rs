//! From options, as given, to the scene: where every default is applied, once.

use super::SceneOptions;
use super::group::Keys;
use super::rules::{Need, needs};
use super::to_picture::ResolvedPicture;
use super::triple::Triple;
use crate::error::{Error, Result};
use crate::scene::{Camera, DepthRange, Mode, Quadrature, QuadratureMethod, SamplingMethod, Scene};
use crate::subject::{Content, Subject};

/// A scene, the options that make it, and what was chosen for the user.
#[derive(Debug, Clone, PartialEq)]
pub struct Resolved {
    /// The scene, with every default applied.
    pub scene: Scene,
    /// The options that make the same scene with nothing left to a default: what pictures and statistics
    /// store.
    pub options: SceneOptions,
    /// One sentence each about a default or computed value which the user may want to know.
    pub notes: Vec<String>,
    /// What depth cues range over, where they were given no range: as much of this as each camera has before it.
    cued: Option<Content>,
}

impl Resolved {
    /// Returns the scene as another camera sees it that has the same lens and target.
    #[must_use]
    pub fn seen_by(&self, camera: Camera) -> Self {
        let mut seen = self.clone();
        if let (Some(content), Some(cues)) = (self.cued, &mut seen.scene.depth_cues)
            && let Ok(range) = DepthRange::of_content(content, &camera)
        {
            cues.range = range;
            seen.options.effects.cue_range = Some(range);
        }
        seen.scene.camera = camera;
        seen.options.camera.eye = Some(Triple(camera.eye_world()));
        seen.options.camera.up = Some(Triple(camera.up_given()));
        seen
    }

    /// Returns the scene as a film has it so many frames later: its samples shifted otherwise.
    #[must_use]
    pub fn frames_later(&self, frames: u32) -> Self {
        let mut later = self.clone();
        let jitter = &mut later.scene.sampling.jitter;
        *jitter = jitter.at_frame(frames);
        let jitter = &mut later.options.sampling.jitter;
        *jitter = jitter.map(|jitter| jitter.at_frame(frames));
        later
    }
}

impl SceneOptions {
    /// Makes the scene for a volume.
    ///
    /// # Errors
    /// As [`SceneOptions::checked`]; an order statistic, which [`SceneOptions::measured`] replaces; an
    /// empty window; an impossible camera.
    pub fn resolve(&self, subject: &Subject) -> Result<Resolved> {
        let Some((quad, note)) = self.without_costly_steps(subject) else {
            return self.resolve_as_given(subject);
        };
        let mut suited = self.clone();
        suited.picture.quad = Some(quad);
        let mut resolved = suited.resolve_as_given(subject)?;
        resolved.notes.push(note);
        Ok(resolved)
    }

    /// Resolves the options as [`SceneOptions::resolve`] does, with the quadrature's default whatever it
    /// costs.
    fn resolve_as_given(&self, subject: &Subject) -> Result<Resolved> {
        self.check_rules()?;
        let method = self.method();
        let given = match method {
            SamplingMethod::Fixed => self.clone(),
            SamplingMethod::Exact => self.clone().without_steps(),
        };
        let ResolvedPicture {
            picture,
            lights,
            gradient,
            options: of_picture,
        } = (given.picture).resolve(self.quadrature(), given.effects.phong(), subject)?;
        let (size, camera, of_camera) = given.camera.resolve(subject)?;
        let (clip_planes, of_clip) = given.clip.resolve()?;
        let (mut sampling, mut of_sampling) = given.sampling.resolve(method, picture.mode());
        let sparse = of_sampling.resolve_sparse(picture.mode())?;
        let (tone, of_tone) = given.tone.resolve();
        let mut effects = given.effects.resolve();
        let depth_cues = effects.resolve_cues(picture.mode(), &camera, size, subject.content)?;
        if let Some(dof) = effects.dof {
            dof.check(camera.lens(), size)?;
        }
        sampling.dof = effects.dof_method.unwrap_or_default();
        let scene = Scene {
            size,
            camera,
            picture,
            clip_planes,
            sampling,
            anti_aliasing: of_sampling.aa.unwrap_or_default(),
            sparse,
            lights,
            shadows: effects.cast_shadows(),
            ambient_occlusion: effects.occlusion(),
            depth_of_field: effects.dof,
            depth_cues,
            gradient,
            tone,
        };
        let mut options = Self {
            volume: given.volume.resolve(),
            picture: of_picture,
            camera: of_camera,
            clip: of_clip,
            sampling: of_sampling,
            effects,
            tone: of_tone,
        };
        if method == SamplingMethod::Exact {
            options = options.without_steps();
        }
        let notes = self.notes(&scene, &options, subject);
        Ok(Resolved {
            scene,
            options,
            notes,
            cued: (self.effects.cue_range.is_none()).then_some(subject.content),
        })
    }

    /// How surfaces and projections are sampled: exactly, unless steps are wanted by their name
    /// or by what needs them. Emission and absorption is sampled as its quadrature is.
    pub(super) fn method(&self) -> SamplingMethod {
        if self.mode() == Mode::Dvr {
            return self.quadrature().sampling();
        }
        let implied = if self.steps_given() {
            SamplingMethod::Fixed
        } else {
            SamplingMethod::default()
        };
        self.sampling.sampling.unwrap_or(implied)
    }

    /// How emission and absorption is integrated: within a bound where exact sampling is wanted.
    pub(super) fn quadrature(&self) -> Quadrature {
        let implied = match self.sampling.sampling {
            Some(SamplingMethod::Exact) => Quadrature::of(QuadratureMethod::Adaptive),
            _ => Quadrature::default(),
        };
        self.picture.quad.unwrap_or(implied)
    }

    /// Whether an option is given that only fixed steps have.
    pub(super) fn steps_given(&self) -> bool {
        let given = self.given();
        given.iter().any(|option| needs(option, Need::Steps))
    }

    fn without_steps(self) -> Self {
        self.retaining(|option| !needs(option, Need::Steps))
    }

    /// Returns the options as the text of a scene file.
    ///
    /// # Errors
    /// A value that TOML cannot hold (a whole number of 64 bits).
    pub fn to_toml(&self) -> Result<String> {
        let refused = |error: toml::ser::Error| {
            Error::failed(format!("the scene cannot be written as TOML: {error}"))
        };
        let table = toml::Table::try_from(self).map_err(refused)?;
        toml::to_string(&table).map_err(refused)
    }
}

#[cfg(test)]
mod tests {
    use clap::Args;
    use glam::DVec3;

    use super::*;
    use crate::extent::Range;
    use crate::options::flag_names;
    use crate::options::rules::{Group, rule};
    use crate::subject::Sphere;

    const SUBJECT: Subject = Subject {
        sphere: Sphere {
            center_world: DVec3::new(1.0, 2.0, 3.0),
            radius_mm: 10.0,
        },
        content: Content::around(Sphere {
            center_world: DVec3::new(-2.0, 2.5, 4.0),
            radius_mm: 3.0,
        }),
        spacing_mm: DVec3::ONE,
        range: Range {
            min: -100.0,
            max: 300.0,
        },
        robust_range: Range {
            min: -100.0,
            max: 300.0,
        },
        otsu: 42.5,
        suggested_iso: 120.0,
    };

    fn scene(text: &str) -> Scene {
        let options = SceneOptions::parse(text, "scene").unwrap();
        options.checked().unwrap().resolve(&SUBJECT).unwrap().scene
    }

    #[test]
    fn a_scene_of_a_mode_is_what_its_options_make() {
        for mode in Mode::ALL {
            let made = Scene::of_mode(mode, &SUBJECT).unwrap();
            assert_eq!(made, scene(&format!("mode = '{mode}'")));
        }
    }

    /// The text that a scene file needs so that an option means something.
    fn needed(option: &str) -> String {
        let mut text = String::new();
        let needs = rule(Group::Scene, option).map_or(&[][..], |rule| rule.needs);
        for need in needs {
            match need {
                Need::Modes(modes, _) => text.push_str(&format!("mode = '{}'\n", modes[0])),
                Need::Steps => text.push_str("sampling = 'fixed'\n"),
                Need::Shading => text.push_str("shading = 'phong'\n"),
                Need::Precomputed(_) => text.push_str("gradient = 'precomputed'\n"),
                Need::Eye => text.push_str("eye = [9, -40, 3]\n"),
                Need::Homogeneity => text.push_str("homogeneity = 0.1\n"),
                Need::Shadows => text.push_str("shadows = 'on'\n"),
                Need::Lens => text.push_str("dof = 'focus=auto,aperture=1'\n"),
                Need::Cues => text.push_str("cue = 'fog:1'\n"),
                _ => {}
            }
        }
        text
    }

    #[test]
    fn the_defaults_that_helps_name_are_those_that_are_applied() {
        let command = SceneOptions::augment_args(clap::Command::new("scene"));
        let mut compared = Vec::new();
        for argument in command.get_arguments() {
            let option = &flag_names(&clap::Command::new("one").arg(argument.clone()))[0];
            let help = argument.get_help().map(ToString::to_string);
            let help = help.unwrap_or_default();
            let Some((_, default)) = help.rsplit_once("[default: ") else {
                continue;
            };
            let default = default.trim_end_matches(']');
            // A value, or one before or behind what is said of it.
            let before = default.split([';', ',']).next().unwrap_or_default();
            let behind = default.split_once(", ").map_or("", |(_, value)| value);
            let until = default.split(';').next().unwrap_or_default();
            let values = [default, until, before, behind];
            let needed = needed(option);
            let with = |value: &&str| format!("{needed}{option} = '{value}'");
            let parses = |value: &&&str| SceneOptions::parse(&with(value), "scene").is_ok();
            // Any text names a type or a file.
            let is_text = ["tf", "raw-type", "volume", "raw-size"].contains(&option.as_str());
            let Some(value) = values.iter().find(parses).filter(|_| !is_text) else {
                continue;
            };
            assert_eq!(scene(&with(value)), scene(&needed), "{option} {value}");
            compared.push(option.clone());
        }
        assert!(compared.len() > 30, "{compared:?}");
    }
}
