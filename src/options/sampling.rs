//! Sampling options: how rays are followed.

use super::enum_names::Switch;
use super::group::group;
use super::text_form::text_form;
use crate::scene::{Filter, Sampling, SamplingMethod, StepVoxels, Storage, Traverse};

text_form!(Filter, SamplingMethod, StepVoxels, Storage, Traverse);

group! {
    /// How rays are followed through the volume.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Sampling")]
    pub struct SamplingOptions {
        /// Where a surface or a projected value is searched for: exact, solving the field in every cell
        /// along the ray, so that nothing is missed; or fixed, at steps
        #[arg(long, value_name = "fixed|exact")]
        sampling: SamplingMethod,

        /// Distance of samples along a ray, in voxels of the smallest spacing
        #[arg(long, value_name = "VOXELS", allow_hyphen_values = true)]
        step: StepVoxels,

        /// The field between voxel centres: nearest or linear
        #[arg(long, value_name = "nearest|linear")]
        filter: Filter,

        /// How empty space is skipped: uniform, kd-restart, hierarchical, revelles or distance; never
        /// changes the picture
        #[arg(long, value_name = "NAME")]
        traverse: Traverse,

        /// Skip empty space; never changes the picture
        #[arg(long, value_name = "on|off")]
        skip: Switch,

        /// Search between two samples where the field's slopes along the ray point at a peak between
        /// them, for the surface in iso and the extremum in mip, minip and lmip; off: fixed steps and
        /// nothing else
        #[arg(long, value_name = "on|off")]
        probe: Switch,

        /// How a device holds the voxels: buffer; image, read voxel by voxel, which never changes the
        /// picture; or filtered, an image (a texture) whose own filter takes the samples of fixed steps,
        /// on most GPUs with weights of eight bits
        #[arg(long, value_name = "buffer|image|filtered")]
        voxels: Storage,
    }
}

impl SamplingOptions {
    /// Makes the sampling by this method, and the options that make the same: exact sampling takes no steps
    /// and has none.
    pub(super) fn resolve(self, method: SamplingMethod) -> (Sampling, Self) {
        let default = Sampling::default();
        let given = match method {
            SamplingMethod::Fixed => self,
            SamplingMethod::Exact => Self {
                step: None,
                probe: None,
                ..self
            },
        };
        let sampling = Sampling {
            method,
            step: given.step.unwrap_or(default.step),
            filter: given.filter.unwrap_or(default.filter),
            traverse: given.traverse.unwrap_or(default.traverse),
            skip: given.skip.map_or(default.skip, Switch::is_on),
            probe: given.probe.map_or(default.probe, Switch::is_on),
            voxels: given.voxels.unwrap_or(default.voxels),
        };
        let is_fixed = method == SamplingMethod::Fixed;
        let options = Self {
            sampling: Some(method),
            step: is_fixed.then_some(sampling.step),
            filter: Some(sampling.filter),
            traverse: Some(sampling.traverse),
            skip: Some(sampling.skip.into()),
            probe: is_fixed.then_some(sampling.probe.into()),
            voxels: Some(sampling.voxels),
        };
        (sampling, options)
    }
}
