//! The settings that an error bound chooses among.

use crate::error::Result;
use crate::scene::{Mode, Setting};

/// Voxels, coarse to fine.
const STEPS: [&str; 6] = ["4", "2", "1", "0.5", "0.25", "0.125"];
/// How a hit is refined: not at all, or as it is by default. What lies between costs as much.
const REFINERS: [&str; 2] = ["none", "regula-falsi:5"];
/// Of each order the cheapest rule, and the one that misses no value between two samples.
const RULES: [&str; 4] = ["riemann", "midpoint", "simpson", "preintegrated"];
/// Of adaptive quadrature, in linear light.
const BOUNDS: [&str; 4] = ["1e-2", "1e-3", "1e-4", "1e-5"];

/// Every candidate of a mode, the last one the surest: the exact cast, or the tightest bound.
///
/// # Errors
/// None in practice: the texts are sound.
pub fn candidates(mode: Mode) -> Result<Vec<Setting>> {
    let mut texts = Vec::new();
    let mut say = |text: String| texts.push(text);
    match mode {
        Mode::Iso => {
            for step in STEPS {
                for probe in ["off", "on"] {
                    for refine in REFINERS {
                        say(format!(
                            "step = {step}\nprobe = '{probe}'\nrefine = '{refine}'\n"
                        ));
                    }
                }
            }
            say("sampling = 'exact'\n".into());
        }
        Mode::Mip | Mode::Lmip | Mode::Minip => {
            for step in STEPS {
                for probe in ["off", "on"] {
                    say(format!("step = {step}\nprobe = '{probe}'\n"));
                }
            }
            say("sampling = 'exact'\n".into());
        }
        Mode::Mean => {
            for step in STEPS {
                say(format!("step = {step}\n"));
            }
            say("sampling = 'exact'\n".into());
        }
        Mode::Dvr => {
            for rule in RULES {
                for step in STEPS {
                    say(format!("quad = '{rule}'\nstep = {step}\n"));
                }
            }
            for bound in BOUNDS {
                say(format!("quad = 'adaptive:{bound}'\n"));
            }
        }
    }
    texts.iter().map(|text| named(text)).collect()
}

/// A setting called by its flags.
fn named(text: &str) -> Result<Setting> {
    let flags = Setting::parse("", text)?.flags();
    Setting::parse(flags, text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{SamplingMethod, SceneOptions};

    #[test]
    fn all_suit_their_mode_and_the_last_one_takes_no_steps() {
        for (mode, number) in [
            (Mode::Iso, 25),
            (Mode::Mip, 13),
            (Mode::Lmip, 13),
            (Mode::Minip, 13),
            (Mode::Mean, 7),
            (Mode::Dvr, 28),
        ] {
            let base = SceneOptions::parse(&format!("mode = '{mode}'"), "base").unwrap();
            let all = candidates(mode).unwrap();
            assert_eq!(all.len(), number, "{mode}");
            for setting in &all {
                let options = setting.over(&base).checked().unwrap();
                let quad = options.picture.quad.map(|quad| quad.sampling());
                let exact = options.sampling.sampling.or(quad) == Some(SamplingMethod::Exact);
                let adaptive = setting.name().contains("adaptive");
                let is_last = setting.name() == all[number - 1].name();
                assert_eq!(exact, is_last || adaptive, "{}", setting.name());
            }
        }
    }
}
