//! Flags over a scene file: which of the file's options stay.

use super::SceneOptions;
use super::conflicts::{REPLACED, is_other_mode};
use super::group::Keys;
use super::rules::{Group, Need, has_needs};

impl SceneOptions {
    /// Lays these flags over a scene file's options. What a flag rules out in the file, such as the eye
    /// when the flag is a view, or the iso value when it is another mode, goes with it.
    #[must_use]
    pub fn over(self, file: Self) -> Self {
        let remaining = self.compatible_with(&file);
        self.or(remaining)
    }

    /// The options of a scene file that still apply when these are the flags.
    fn compatible_with(&self, file: &Self) -> Self {
        let replaced = REPLACED.iter().filter(|row| (row.by)(self, file));
        let replaced: Vec<&str> = replaced.flat_map(|row| row.options).copied().collect();
        let remaining = file.clone().retaining(|option| !replaced.contains(&option));
        let together = self.clone().or(remaining.clone());
        remaining.retaining(|option| {
            has_needs(Group::Scene, option, |need| {
                !self.rules_out(need, file, &together)
            })
        })
    }

    /// Whether these flags take away from a file what one of its options needs. What the file never had
    /// is refused, unless a flag has to do with it.
    fn rules_out(&self, need: Need, file: &Self, together: &Self) -> bool {
        let is_other_mode = is_other_mode(self, file);
        let is_decided = match need {
            Need::Modes(..) => is_other_mode,
            Need::Shading => is_other_mode || self.picture.shading.is_some(),
            Need::Precomputed(_) => self.picture.gradient.is_some(),
            _ => false,
        };
        !together.allows(need) && (is_decided || file.meets(need))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::conflicts::CONTRADICTIONS;

    fn parse(text: &str) -> SceneOptions {
        SceneOptions::parse(text, "scene").unwrap()
    }

    /// If two options contradict each other the flag wins, whichever it is.
    #[test]
    fn a_flag_wins_over_what_contradicts_it_in_a_file() {
        let eye = "eye = [9, -40, 3]";
        let carm = "carm = 'LAO 30'";
        let averaged = "mode = 'dvr'\nhomogeneity = 0.1";
        let pairs = [
            ("fov = 40", "ortho = 20"),
            (eye, "view = 'left'"),
            (eye, carm),
            (eye, "fit = 'volume'"),
            (carm, "view = 'left'"),
            (carm, "azimuth = 10"),
            (carm, "elevation = 10"),
            ("aa = 4", "sparse = 4"),
            ("aa = 4", "screen-error = 0.1"),
            ("sampling = 'fixed'", "screen-error = 0.1"),
            ("jitter = 'hash:1'", "sampling = 'exact'"),
            (
                "mode = 'dvr'\njitter = 'hash:1'",
                "mode = 'dvr'\nquad = 'adaptive'",
            ),
            ("recon = 'adaptive'", "sampling = 'exact'"),
            ("recon = 'adaptive'", "filter = 'nearest'"),
            ("recon = 'adaptive'", "probe = 'on'"),
            ("ao = 'distance=5'", "filter = 'nearest'"),
            ("ssao = 'radius=5'", "filter = 'nearest'"),
            ("ssao = 'radius=5'", "ao = 'distance=5'"),
            ("shadows = 'on'", "filter = 'nearest'"),
            ("cue = 'halo:1'", "dof = 'focus=auto,aperture=1'"),
            (
                "mode = 'mip'\ncue = 'fog:1'",
                "mode = 'mip'\nscreen-error = 0.1",
            ),
            (averaged, "mode = 'dvr'\nshading = 'phong'"),
            (averaged, "mode = 'dvr'\nquad = 'adaptive'"),
            (
                "mode = 'dvr'\nshading = 'phong'\nshade-from = 3",
                "mode = 'dvr'\nshading = 'phong'\ngradient = 'precomputed'",
            ),
        ];
        let mut met = vec![0; CONTRADICTIONS.len()];
        for (one, other) in pairs {
            let (one, other) = (parse(one), parse(other));
            for (flags, file) in [(&one, &other), (&other, &one)] {
                let merged = flags.clone().over(file.clone());
                assert_eq!(merged.check_rules(), Ok(()), "{flags:?} {file:?}");
                // The flags themselves are all there.
                assert_eq!(flags.clone().or(merged.clone()), merged);
                // The control: in one source they are refused.
                let together = flags.clone().or(file.clone());
                assert!(together.check_rules().is_err(), "{flags:?} {file:?}");
                for (row, count) in CONTRADICTIONS.iter().zip(&mut met) {
                    *count += u32::from((row.is_in)(&together));
                }
            }
        }
        assert!(met.iter().all(|count| *count > 0), "{met:?}");
    }

    #[test]
    fn an_error_on_the_screen_and_other_refills_replace_each_other() {
        for [one, other] in [
            ["screen-error = 0.1", "sparse = 4\nrefill = 'flood'"],
            ["screen-error = 0.1", "sparse = '4:0.1'"],
        ] {
            for [flags, file] in [[one, other], [other, one]] {
                let merged = parse(flags).over(parse(file));
                assert!(merged.clone().checked().is_ok(), "{flags} {file}");
                assert_eq!(parse(flags).or(merged.clone()), merged);
                // The control: in one source they are refused.
                assert!(parse(flags).or(parse(file)).checked().is_err());
            }
        }
    }

    #[test]
    fn what_no_flag_has_to_do_with_is_left_to_be_refused() {
        let stray = parse("zoom = 2").over(parse("mode = 'mip'\niso = 10"));
        assert!(stray.check_rules().is_err());
        // The control: a flag that names a mode takes it away.
        let mean = parse("mode = 'mean'").over(parse("mode = 'mip'\niso = 10"));
        assert_eq!(mean.check_rules(), Ok(()));
    }
}
