//! How much work an experiment does: larger pictures and more repeats make steadier figures.

/// The amount of work, chosen by `--quick` and `--full`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Preset {
    /// Small pictures, few repeats (`--quick`).
    Quick,
    /// The amount without either flag.
    #[default]
    Usual,
    /// Large pictures, many repeats (`--full`).
    Full,
}

impl Preset {
    /// The name in files and pages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Usual => "usual",
            Self::Full => "full",
        }
    }

    /// Width and height of the pictures.
    pub fn side_px(self) -> u32 {
        match self {
            Self::Quick => 128,
            Self::Usual => 256,
            Self::Full => 512,
        }
    }

    /// How often each setting is timed.
    pub fn repeats(self) -> usize {
        match self {
            Self::Quick => 3,
            Self::Usual => 5,
            Self::Full => 7,
        }
    }
}
