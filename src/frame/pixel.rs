//! The kind of a pixel and its certificate, as the numbers that pictures hold.

/// The kind of thing that a pixel's ray met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Kind {
    /// The ray met nothing.
    Nothing = 0,
    /// The ray met the surface, or what is shown in its place.
    Surface = 1,
    /// The ray met the volume's face, where it is above the iso value.
    Cap = 2,
    /// The ray met opaque geometry in the scene.
    Geometry = 3,
}

/// The proof of a pixel of an isosurface: whether its ray meets the surface.
///
/// Proven means that no rounding error of the cast can change the answer, the voxels being taken
/// as exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Certificate {
    /// The ray meets no surface.
    Miss = 0,
    /// The ray meets the surface, and first where the picture says.
    Hit = 1,
    /// The ray touches the surface, or comes so near to it that rounding decides; or nothing was proven
    /// (fixed steps, other pictures).
    Undecided = 2,
}
