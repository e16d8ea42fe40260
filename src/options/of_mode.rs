//! Options for several modes at once: what of them goes with each.

use super::SceneOptions;
use super::group::Keys;
use super::rules::{Group, Need, has_needs};
use crate::scene::{Mode, SamplingMethod, Storage};

impl SceneOptions {
    /// These options, which are for several modes at once, as far as they go with this one, which is
    /// theirs afterwards: light and gradients only where its shading makes use of them.
    #[must_use]
    pub fn of_mode(&self, mode: Mode) -> Self {
        let mut all = self.clone();
        all.picture.mode = Some(mode);
        let goes_with_mode = |option: &str| {
            has_needs(Group::Scene, option, |need| match need {
                Need::Modes(..) | Need::IdleBeside(_) | Need::Shading | Need::Normals => {
                    all.meets(need)
                }
                _ => true,
            })
        };
        let mut options = all.clone().retaining(goes_with_mode);
        if !mode.is_lit() {
            options.effects = options.effects.without_rims();
        }
        // Of both, the quadrature says more of how an integral is sampled.
        let quad = options.picture.quad.map(|quad| quad.sampling());
        if quad.is_some() {
            options.sampling.sampling = options.sampling.sampling.filter(|one| quad == Some(*one));
        }
        // What is solved is solved from the voxels themselves.
        if options.method() == SamplingMethod::Exact {
            let suits = |storage: &Storage| *storage != Storage::Filtered;
            options.sampling.voxels = options.sampling.voxels.filter(suits);
        }
        options
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Options for all modes, a mode, and what of them goes with it.
    #[rustfmt::skip]
    const CASES: &[(&str, Mode, &str)] = &[
        ("iso = 150\ntf = 'cta'\nazimuth = 3", Mode::Iso, "iso = 150\nazimuth = 3"),
        ("iso = 150\ntf = 'cta'\nazimuth = 3", Mode::Dvr, "tf = 'cta'\nazimuth = 3"),
        ("iso = 150\ntf = 'cta'\nazimuth = 3", Mode::Mip, "azimuth = 3"),
        ("window = [0, 450]\nlmip-threshold = 2", Mode::Mip, "window = [0, 450]"),
        ("window = [0, 450]\nlmip-threshold = 2", Mode::Iso, ""),
        // Light is for what is shaded, which dvr is not unless it says so.
        ("ambient = 0.3\ngradient = 'forward'", Mode::Iso, "ambient = 0.3\ngradient = 'forward'"),
        ("ambient = 0.3\ngradient = 'forward'", Mode::Dvr, ""),
        ("ambient = 0.3\nshading = 'phong'", Mode::Dvr, "ambient = 0.3\nshading = 'phong'"),
        ("ambient = 0.3\nshading = 'none'", Mode::Iso, "shading = 'none'"),
        ("ambient = 0.3\nshading = 'phong'", Mode::Mip, ""),
        ("cue = ['fog:1', 'chromadepth:1,rim=2']", Mode::Iso, "cue = ['fog:1', 'chromadepth:1,rim=2']"),
        ("cue = ['fog:1', 'chromadepth:1,rim=2']", Mode::Mip, "cue = ['fog:1', 'chromadepth:1']"),
        ("cue = 'fog:1'\ncue-range = [10, 20]", Mode::Mean, ""),
        ("step = 2\nprobe = 'off'", Mode::Mip, "step = 2\nprobe = 'off'"),
        ("step = 2\nprobe = 'off'", Mode::Dvr, "step = 2"),
        ("sampling = 'exact'\nquad = 'simpson'", Mode::Dvr, "quad = 'simpson'"),
        ("sampling = 'exact'\nquad = 'simpson'", Mode::Mip, "sampling = 'exact'"),
        ("sampling = 'exact'", Mode::Dvr, "sampling = 'exact'"),
        ("voxels = 'filtered'", Mode::Iso, ""),
        ("voxels = 'filtered'", Mode::Dvr, "voxels = 'filtered'"),
        ("voxels = 'filtered'\nstep = 1", Mode::Iso, "voxels = 'filtered'\nstep = 1"),
    ];

    #[test]
    fn each_option_goes_to_the_modes_that_have_it() {
        let parse = |text: &str| SceneOptions::parse(text, "scene").unwrap();
        for &(all, mode, expected) in CASES {
            let expected = parse(&format!("mode = '{mode}'\n{expected}"));
            let of_mode = parse(all).of_mode(mode);
            assert_eq!(of_mode, expected, "{all} {mode}");
            // What is left means something: no mode refuses it.
            assert!(of_mode.checked().is_ok(), "{all} {mode}");
        }
    }
}
