//! Test volumes with known answers. Their world origin is the volume's centre, their axes are the
//! world's, and their fields run from 0 to 1, which [`PhantomSpec::values`] maps to voxel values.

mod analytic;
mod fill;
mod kind;
mod noise;
mod spec;
mod stored;
mod vessels;

pub use kind::PhantomKind;
pub use spec::PhantomSpec;
pub use vessels::{MURRAY_EXPONENT, VesselSegment, VesselTree};

use glam::DMat3;

use crate::error::Result;
use crate::volume::{Geometry, NonFinite, Rescale, Volume};

/// A phantom and what is known about it.
#[derive(Debug)]
pub struct Phantom {
    /// The volume itself.
    pub volume: Volume,
    /// Centrelines and radii, of [`PhantomKind::Vessels`] only.
    pub tree: Option<VesselTree>,
    /// One statement of the field, from 0 to 1, or of the values, before noise and rounding;
    /// p = (x, y, z) is mm from the volume's centre.
    pub definition: String,
}

/// Makes a phantom.
///
/// # Errors
/// Usage: a length, spacing or noise out of its domain, or one that the kind does not have; more than
/// 16 GiB of voxels. Resource: more than there is memory.
pub fn phantom(spec: &PhantomSpec) -> Result<Phantom> {
    spec.check()?;
    let centre = spec.centre_index();
    let geometry = Geometry::new(-centre * spec.spacing_mm, DMat3::IDENTITY, spec.spacing_mm)?;
    let mut tree = None;
    let (voxels, mut definition) = match spec.kind {
        PhantomKind::Sphere => analytic::sphere(spec)?,
        PhantomKind::Slab => analytic::slab(spec)?,
        PhantomKind::Ramp => analytic::ramp(spec)?,
        PhantomKind::Blob => analytic::blob(spec)?,
        PhantomKind::MarschnerLobb => analytic::marschner_lobb(spec)?,
        PhantomKind::Voxel => analytic::voxel(spec)?,
        PhantomKind::Noise => noise::white(spec)?,
        PhantomKind::Vessels => {
            let grown = vessels::grow(spec)?;
            let drawn = vessels::draw(spec, &grown)?;
            tree = Some(grown);
            drawn
        }
    };
    if spec.noise > 0.0 {
        definition.push_str(&format!(
            "; Gaussian noise with a standard deviation of {} of the value range is added",
            spec.noise
        ));
    }
    let volume = Volume::new(
        spec.dims,
        voxels,
        geometry,
        Rescale::IDENTITY,
        NonFinite::Refuse,
    )?;
    Ok(Phantom {
        volume,
        tree,
        definition,
    })
}
