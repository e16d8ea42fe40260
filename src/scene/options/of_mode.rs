//! Options for several modes at once: what of them goes with each.

use super::group::Keys;
use super::picture::belongs_to;
use super::{Mode, PictureOptions, SamplingOptions, SceneOptions, Shading};
use crate::scene::{SamplingMethod, Storage};

impl SceneOptions {
    /// These options, which are for several modes at once, as far as they go with this one, which is
    /// theirs afterwards.
    #[must_use]
    pub fn of_mode(&self, mode: Mode) -> Self {
        let mut options = Self {
            picture: self.picture.of_mode(mode),
            sampling: self.sampling.of_mode(mode),
            ..self.clone()
        };
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

impl PictureOptions {
    /// What belongs to the mode; light and gradients only where its shading makes use of them.
    fn of_mode(&self, mode: Mode) -> Self {
        let mut options = Self {
            mode: Some(mode),
            ..self.clone().keeping(|key| belongs_to(key, mode))
        };
        if options.shading() == Shading::None {
            options = options.unlit();
        }
        if !options.has_normals() {
            options = options.without_gradient();
        }
        options
    }
}

impl SamplingOptions {
    /// What the mode's rays make use of: only a surface or an extremum lies at a peak between samples.
    fn of_mode(&self, mode: Mode) -> Self {
        let mut options = self.clone();
        if matches!(mode, Mode::Mean | Mode::Dvr) {
            options.probe = None;
        }
        options
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_option_goes_to_the_modes_that_have_it() {
        let parse = |text: &str| SceneOptions::parse(text, "scene").unwrap();
        for (all, mode, expected) in [
            (
                "iso = 150\ntf = 'cta'\nazimuth = 3",
                Mode::Iso,
                "iso = 150\nazimuth = 3",
            ),
            (
                "iso = 150\ntf = 'cta'\nazimuth = 3",
                Mode::Dvr,
                "tf = 'cta'\nazimuth = 3",
            ),
            (
                "iso = 150\ntf = 'cta'\nazimuth = 3",
                Mode::Mip,
                "azimuth = 3",
            ),
            (
                "window = [0, 450]\nlmip-threshold = 2",
                Mode::Mip,
                "window = [0, 450]",
            ),
            ("window = [0, 450]\nlmip-threshold = 2", Mode::Iso, ""),
            // Light is for what is shaded, which dvr is not unless it says so.
            (
                "ambient = 0.3\ngradient = 'forward'",
                Mode::Iso,
                "ambient = 0.3\ngradient = 'forward'",
            ),
            ("ambient = 0.3\ngradient = 'forward'", Mode::Dvr, ""),
            (
                "ambient = 0.3\nshading = 'phong'",
                Mode::Dvr,
                "ambient = 0.3\nshading = 'phong'",
            ),
            (
                "ambient = 0.3\nshading = 'none'",
                Mode::Iso,
                "shading = 'none'",
            ),
            ("ambient = 0.3\nshading = 'phong'", Mode::Mip, ""),
            (
                "step = 2\nprobe = 'off'",
                Mode::Mip,
                "step = 2\nprobe = 'off'",
            ),
            ("step = 2\nprobe = 'off'", Mode::Dvr, "step = 2"),
            (
                "sampling = 'exact'\nquad = 'simpson'",
                Mode::Dvr,
                "quad = 'simpson'",
            ),
            (
                "sampling = 'exact'\nquad = 'simpson'",
                Mode::Mip,
                "sampling = 'exact'",
            ),
            ("sampling = 'exact'", Mode::Dvr, "sampling = 'exact'"),
            ("voxels = 'filtered'", Mode::Iso, ""),
            ("voxels = 'filtered'", Mode::Dvr, "voxels = 'filtered'"),
            (
                "voxels = 'filtered'\nstep = 1",
                Mode::Iso,
                "voxels = 'filtered'\nstep = 1",
            ),
        ] {
            let expected = parse(&format!("mode = '{mode}'\n{expected}"));
            let of_mode = parse(all).of_mode(mode);
            assert_eq!(of_mode, expected, "{all} {mode}");
            // What is left means something: no mode refuses it.
            assert!(of_mode.checked().is_ok(), "{all} {mode}");
        }
    }
}
