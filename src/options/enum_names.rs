//! Choices that only options have, and their names.

use super::text_form::text_form;
use crate::scene::Mode;
use crate::scene::enum_names::enum_names;

/// The shading of a surface or a medium (`--shading`).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shading {
    /// No light: a surface or medium keeps its own colour.
    None,
    /// Phong's reflection (1975).
    Phong,
    /// Blinn's reflection (1977), by the half-way vector.
    BlinnPhong,
}

impl Shading {
    /// The shading of a mode where none is given: Phong's of a surface, none of a medium.
    pub fn of(mode: Mode) -> Self {
        match mode {
            Mode::Iso => Self::Phong,
            _ => Self::None,
        }
    }
}
enum_names!(Shading, "a shading": None = "none", Phong = "phong", BlinnPhong = "blinn-phong");

/// The method by which gradients are computed (`--gradient`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GradientMethod {
    /// Central differences, over two voxel spacings.
    #[default]
    Central,
    /// Forward differences, over one voxel spacing.
    Forward,
    /// Central differences of fourth order, over four voxel spacings.
    FourthOrder,
    /// Directions computed once for the volume and interpolated.
    Precomputed,
}
enum_names!(GradientMethod, "a gradient": Central = "central", Forward = "forward",
    FourthOrder = "fourth-order", Precomputed = "precomputed");

/// Something that is on or off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Switch {
    /// Written `on`; in a scene file `true` too.
    On,
    /// Written `off`; in a scene file `false` too.
    Off,
}
enum_names!(Switch, "a switch": On = "on", Off = "off");

impl Switch {
    /// Whether the switch is on.
    pub fn is_on(self) -> bool {
        self == Self::On
    }
}

impl From<bool> for Switch {
    fn from(on: bool) -> Self {
        if on { Self::On } else { Self::Off }
    }
}

/// The treatment of NaN and ±Inf voxels (`--non-finite`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NonFiniteRule {
    /// They are read as the smallest finite value of the volume.
    #[default]
    Replace,
    /// They are refused as an error.
    Refuse,
}
enum_names!(NonFiniteRule, "a rule for NaN and infinite voxels": Replace = "replace", Refuse = "refuse");

/// What fits the picture where no eye is given (`--fit`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Fit {
    /// The volume's bounding sphere.
    Volume,
    /// The bounding sphere of the cells that can show something.
    #[default]
    Content,
}
enum_names!(Fit, "what fits the picture": Volume = "volume", Content = "content");

text_form!(Shading, GradientMethod, Switch, NonFiniteRule, Fit);
