//! The settings that an error bound chooses among.

use crate::error::Result;
use crate::options::Setting;
use crate::scene::Mode;

/// The steps, in voxels, coarse to fine.
const STEPS: [&str; 6] = ["4", "2", "1", "0.5", "0.25", "0.125"];
/// How a hit is refined: not at all, or as it is by default. What lies between costs as much.
const REFINERS: [&str; 2] = ["none", "regula-falsi:5"];
/// The cheapest rule of each order, and the one that misses no value between two samples.
const RULES: [&str; 4] = ["riemann", "midpoint", "simpson", "preintegrated"];
/// The error bounds of adaptive quadrature, in linear light.
const BOUNDS: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];
/// The spacings of grids between which pixels are filled until nothing differs.
const FLOODED: [u32; 3] = [8, 4, 2];

/// The greatest slope of the sRGB curve (IEC 61966-2-1), which is at black: what a difference in linear
/// light is at most multiplied by on its way to the display.
const MAX_SLOPE: f64 = 12.92;

/// Settings of one kind, coarse to fine: each takes longer than the one before and errs less.
pub type Chain = Vec<Setting>;

/// Every candidate of a mode, the last one of the last chain the surest: the exact cast; of emission
/// and absorption, whose exact cast has an adaptive bound, the loosest of the adaptive
/// bounds that by itself keeps `limit`, a difference of displayed colours 0..1. Pixels may be left out where each has
/// `one_ray`.
///
/// # Errors
/// A text of this module does not parse, which tests rule out.
pub fn candidates(mode: Mode, limit: f64, one_ray: bool) -> Result<Vec<Chain>> {
    let mut chains: Vec<Vec<String>> = Vec::new();
    let mut by_step = |how: &str| {
        let at = |step| format!("step = {step}\n{how}");
        chains.push(STEPS.into_iter().map(at).collect());
    };
    match mode {
        Mode::Iso => {
            for probe in ["off", "on"] {
                for refine in REFINERS {
                    by_step(&format!("probe = '{probe}'\nrefine = '{refine}'\n"));
                }
            }
        }
        Mode::Mip | Mode::Lmip | Mode::Minip => {
            for probe in ["off", "on"] {
                by_step(&format!("probe = '{probe}'\n"));
            }
        }
        Mode::Mean => by_step(""),
        Mode::Dvr => {
            for rule in RULES {
                by_step(&format!("quad = '{rule}'\n"));
            }
        }
    }
    let exact: Vec<String> = match mode {
        Mode::Dvr => {
            let keeps = |bound: &f64| MAX_SLOPE * bound <= limit;
            let loosest = BOUNDS.iter().position(keeps).unwrap_or(BOUNDS.len() - 1);
            let bounds = BOUNDS[..=loosest].iter();
            bounds
                .map(|bound| format!("quad = 'adaptive:{bound}'\n"))
                .collect()
        }
        _ => vec!["sampling = 'exact'\n".into()],
    };
    if let Some(surest) = exact.last().filter(|_| one_ray) {
        let flooded = |spacing| format!("{surest}sparse = {spacing}\nrefill = 'flood'\n");
        let within = |error| format!("{surest}screen-error = {error}\n");
        chains.push(FLOODED.into_iter().map(flooded).collect());
        chains.push(screen_errors(mode).into_iter().map(within).collect());
    }
    chains.push(exact);
    let chain = |texts: Vec<String>| texts.iter().map(|text| named(text)).collect();
    chains.into_iter().map(chain).collect()
}

/// The errors within which pixels are filled: of a surface voxels of depth, of others shares of the range of values or
/// of linear light.
fn screen_errors(mode: Mode) -> [f64; 3] {
    match mode {
        Mode::Iso => [1.0, 0.2, 0.05],
        _ => [0.05, 0.01, 0.002],
    }
}

/// A setting called by its flags.
fn named(text: &str) -> Result<Setting> {
    let flags = Setting::parse("", text)?.flags();
    Setting::parse(flags, text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::SceneOptions;
    use crate::scene::SamplingMethod;

    #[test]
    fn all_suit_their_mode_and_the_last_one_takes_no_steps() {
        for (mode, lengths) in [
            (Mode::Iso, vec![6, 6, 6, 6, 3, 3, 1]),
            (Mode::Mip, vec![6, 6, 3, 3, 1]),
            (Mode::Lmip, vec![6, 6, 3, 3, 1]),
            (Mode::Minip, vec![6, 6, 3, 3, 1]),
            (Mode::Mean, vec![6, 3, 3, 1]),
            (Mode::Dvr, vec![6, 6, 6, 6, 3, 3, 4]),
        ] {
            let base = SceneOptions::parse(&format!("mode = '{mode}'"), "base").unwrap();
            let chains = candidates(mode, 1e-6, true).unwrap();
            let found: Vec<usize> = chains.iter().map(Vec::len).collect();
            assert_eq!(found, lengths, "{mode}");
            let mut names = Vec::new();
            for (at, chain) in chains.iter().enumerate() {
                for setting in chain {
                    let options = setting.over(&base).checked().unwrap();
                    let quad = options.picture.quad.map(|quad| quad.sampling());
                    let exact = options.sampling.sampling.or(quad) == Some(SamplingMethod::Exact);
                    assert_eq!(exact, at >= lengths.len() - 3, "{}", setting.name());
                    let is_last = at == lengths.len() - 1;
                    assert_eq!(exact && !is_sparse(&options), is_last, "{}", setting.name());
                    names.push(setting.name());
                }
            }
            let all = names.len();
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), all, "{mode}");
        }
    }

    fn is_sparse(options: &SceneOptions) -> bool {
        options.sampling.sparse.is_some() || options.sampling.screen_error.is_some()
    }

    #[test]
    fn no_pixel_is_left_out_where_each_has_many_rays() {
        for mode in [Mode::Iso, Mode::Mip, Mode::Dvr] {
            let few = candidates(mode, 1e-6, false).unwrap();
            let all = candidates(mode, 1e-6, true).unwrap();
            assert_eq!(few.len() + 2, all.len());
            assert_eq!(few.last(), all.last());
        }
    }

    #[test]
    fn an_adaptive_bound_is_as_tight_as_the_limit_needs() {
        let surest = |limit| {
            let chains = candidates(Mode::Dvr, limit, true).unwrap();
            chains.last().unwrap().last().unwrap().flags()
        };
        assert_eq!(surest(0.5), "--quad adaptive:0.01");
        assert_eq!(surest(0.13), "--quad adaptive:0.01");
        assert_eq!(surest(0.12), "--quad adaptive:0.001");
        assert_eq!(surest(1e-9), "--quad adaptive:0.00001");
    }
}
