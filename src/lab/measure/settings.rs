//! The settings that are measured where the user names none, and the grid of them all.

use crate::error::Result;
use crate::options::Setting;
use crate::scene::Mode;

/// The steps, in voxels, coarse to fine.
const STEPS: [&str; 4] = ["2", "1", "0.5", "0.25"];
const REFINERS: [&str; 5] = [
    "regula-falsi:5",
    "none",
    "bisection:6",
    "illinois:5",
    "newton:3",
];
/// Rules of fixed steps for light along a ray.
const RULES: [&str; 6] = [
    "riemann",
    "midpoint",
    "simpson",
    "rk4",
    "romberg",
    "preintegrated",
];
/// The error bounds of adaptive quadrature, in linear light.
const BOUNDS: [&str; 4] = [
    "adaptive:1e-2",
    "adaptive:1e-3",
    "adaptive:1e-4",
    "adaptive:1e-5",
];
/// The traversals beside the default one.
const TRAVERSALS: [&str; 4] = ["uniform", "kd-restart", "hierarchical", "revelles"];

const EXACT: (&str, &str) = ("sampling", "exact");
const PLAIN: (&str, &str) = ("probe", "off");

/// The settings that `compare` shows of a mode: the exact cast, fixed steps as they are by default, and
/// plain ones as in the papers; for emission and absorption, its rules.
///
/// # Errors
/// A text of this module does not parse, which tests rule out.
pub fn built_in(mode: Mode) -> Result<Vec<Setting>> {
    let steps = STEPS.map(|step| Keys::of(&[("step", step)]));
    let mut casts = Vec::new();
    match mode {
        Mode::Iso => {
            casts.push(Keys::of(&[EXACT]));
            casts.extend(steps);
            casts.extend(["1", "0.5"].map(|step| Keys::of(&[("step", step), PLAIN])));
            casts.push(Keys::of(&[("step", "1"), PLAIN, ("refine", "none")]));
        }
        Mode::Mip | Mode::Minip | Mode::Lmip => {
            casts.push(Keys::of(&[EXACT]));
            casts.extend(steps);
            casts.extend(["1", "0.5"].map(|step| Keys::of(&[("step", step), PLAIN])));
            casts.push(Keys::of(&[("step", "0.5"), PLAIN, ("filter", "nearest")]));
        }
        Mode::Mean => {
            casts.push(Keys::of(&[EXACT]));
            casts.extend(steps);
        }
        Mode::Dvr => {
            casts.extend(BOUNDS[..3].iter().map(|bound| Keys::of(&[("quad", bound)])));
            for (rule, steps) in [
                ("simpson", &STEPS[1..]),
                ("riemann", &STEPS[1..3]),
                ("preintegrated", &STEPS[1..3]),
            ] {
                let keys = |step: &&str| Keys::of(&[("quad", rule), ("step", step)]);
                casts.extend(steps.iter().map(keys));
            }
        }
    }
    casts.iter().map(Keys::setting).collect()
}

/// A setting whose error cannot be seen.
///
/// # Errors
/// As [`built_in`].
pub fn accurate(mode: Mode) -> Result<Setting> {
    let keys = match mode {
        Mode::Dvr => ("quad", BOUNDS[1]),
        Mode::Iso | Mode::Mip | Mode::Lmip | Mode::Minip | Mode::Mean => EXACT,
    };
    Keys::of(&[keys]).setting()
}

/// All that can be combined in a mode: steps, probing, refiners, rules and bounds; and with some of
/// them the filter and the traversals, which do not depend on the rest. With `whole`, with
/// all of them.
///
/// # Errors
/// A text of this module does not parse, which tests rule out.
pub fn grid(mode: Mode, whole: bool) -> Result<Vec<Setting>> {
    let casts = casts(mode);
    let crossed = if whole { casts.clone() } else { typical(mode) };
    let skipping = crossed.iter().flat_map(|cast| {
        let by = |traversal: &&str| cast.and("traverse", traversal);
        let mut traversals: Vec<Keys> = TRAVERSALS.iter().map(by).collect();
        traversals.push(cast.and("skip", "off"));
        traversals
    });
    let nearest = crossed.iter().map(|cast| cast.and("filter", "nearest"));
    let all = casts.iter().cloned().chain(skipping).chain(nearest);
    all.map(|keys| keys.setting()).collect()
}

/// How rays are sampled, in every method that the mode has.
fn casts(mode: Mode) -> Vec<Keys> {
    let steps = STEPS.map(|step| Keys::of(&[("step", step)]));
    let plain = STEPS.map(|step| Keys::of(&[("step", step), PLAIN]));
    let probed_and_plain = steps.iter().chain(&plain);
    let exact = Keys::of(&[EXACT]);
    match mode {
        Mode::Iso => {
            let refined =
                probed_and_plain.flat_map(|keys| REFINERS.map(|by| keys.and("refine", by)));
            [exact].into_iter().chain(refined).collect()
        }
        Mode::Mip | Mode::Minip | Mode::Lmip => [exact]
            .into_iter()
            .chain(probed_and_plain.cloned())
            .collect(),
        Mode::Mean => [exact].into_iter().chain(steps).collect(),
        Mode::Dvr => {
            let fixed = steps
                .iter()
                .flat_map(|keys| RULES.map(|rule| keys.and("quad", rule)));
            let adaptive = BOUNDS.map(|bound| Keys::of(&[("quad", bound)]));
            adaptive.into_iter().chain(fixed).collect()
        }
    }
}

/// The mode's exact cast and its usual steps.
fn typical(mode: Mode) -> Vec<Keys> {
    match mode {
        Mode::Dvr => vec![
            Keys::of(&[("quad", BOUNDS[1])]),
            Keys::of(&[("step", "0.5"), ("quad", "simpson")]),
        ],
        Mode::Iso => vec![
            Keys::of(&[EXACT]),
            Keys::of(&[("step", "0.5"), ("refine", REFINERS[0])]),
        ],
        _ => vec![Keys::of(&[EXACT]), Keys::of(&[("step", "0.5")])],
    }
}

/// A setting's keys and values.
#[derive(Clone)]
struct Keys(Vec<(&'static str, String)>);

impl Keys {
    fn of(pairs: &[(&'static str, &str)]) -> Self {
        Self(
            pairs
                .iter()
                .map(|(key, value)| (*key, (*value).to_owned()))
                .collect(),
        )
    }

    fn and(&self, key: &'static str, value: &str) -> Self {
        let mut keys = self.clone();
        keys.0.push((key, value.to_owned()));
        keys
    }

    /// The setting, named by what it says.
    fn setting(&self) -> Result<Setting> {
        let mut text = String::new();
        let mut name = Vec::new();
        for (key, value) in &self.0 {
            text += &match *key {
                "step" => format!("step = {value}\n"),
                key => format!("{key} = '{value}'\n"),
            };
            name.push(match (*key, value.as_str()) {
                ("step", value) => format!("step {value}"),
                PLAIN => "plain".to_owned(),
                ("refine", "none") => "no refinement".to_owned(),
                ("skip", "off") => "no skipping".to_owned(),
                (_, value) => value.to_owned(),
            });
        }
        Setting::parse(name.join(", "), &text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::SceneOptions;

    #[test]
    fn every_setting_suits_its_mode_and_has_a_name_of_its_own() {
        for mode in Mode::ALL {
            let base = SceneOptions::parse(&format!("mode = '{mode}'"), "base").unwrap();
            for settings in [built_in(mode), grid(mode, false), grid(mode, true)] {
                let settings = settings.unwrap();
                for (at, setting) in settings.iter().enumerate() {
                    setting.over(&base).checked().unwrap();
                    let same = |other: &&Setting| other.name() == setting.name();
                    let first = settings.iter().find(same).unwrap();
                    assert_eq!(
                        first,
                        setting,
                        "{mode}: {} is there twice, {at}",
                        setting.name()
                    );
                }
                let names: std::collections::HashSet<&str> =
                    settings.iter().map(Setting::name).collect();
                assert_eq!(names.len(), settings.len(), "{mode}");
            }
        }
    }

    #[test]
    fn the_whole_grid_holds_the_grid() {
        for mode in Mode::ALL {
            let names = |settings: Vec<Setting>| -> Vec<String> {
                settings
                    .iter()
                    .map(|setting| setting.name().to_owned())
                    .collect()
            };
            let whole = names(grid(mode, true).unwrap());
            let some = names(grid(mode, false).unwrap());
            assert!(some.len() < whole.len());
            assert!(some.iter().all(|name| whole.contains(name)), "{mode}");
        }
    }
}
