//! Sampling options: how rays are followed.

use super::group::group;
use super::numbers::StepVoxels;
use super::words::Switch;
use crate::error::Result;
use crate::scene::{Filter, Sampling, SamplingMethod, Storage, Traverse};

group! {
    /// How rays are followed through the volume.
    #[derive(serde::Serialize)]
    #[command(next_help_heading = "Sampling")]
    pub struct SamplingOptions {
        /// Where a surface or a projected value is looked for: exact, solving the field in every
        /// cell on the way, so that nothing is missed; or fixed, at steps [default: exact; fixed
        /// where --step, --refine or --probe is given; in dvr exact is --quad adaptive, fixed all
        /// others]
        #[arg(long, value_name = "fixed|exact")]
        sampling: SamplingMethod,

        /// Distance of samples along a ray, in voxels of the smallest spacing, where they are fixed
        /// [default: 0.5]
        #[arg(long, value_name = "VOXELS", allow_hyphen_values = true)]
        step: StepVoxels,

        /// The field between voxel centres: nearest or linear [default: linear]
        #[arg(long, value_name = "nearest|linear")]
        filter: Filter,

        /// How empty space is skipped: uniform, kd-restart, hierarchical, revelles or distance; never
        /// changes the picture [default: distance]
        #[arg(long, value_name = "NAME")]
        traverse: Traverse,

        /// Skip empty space; never changes the picture [default: on]
        #[arg(long, value_name = "on|off")]
        skip: Switch,

        /// Fixed steps: look between two samples where the field's slopes along the ray point at a peak between
        /// them, for the surface in iso and the extremum in mip, minip and lmip; off: fixed steps
        /// and nothing else [default: on]
        #[arg(long, value_name = "on|off")]
        probe: Switch,

        /// How a device holds the voxels: buffer; image, read voxel by voxel, which never changes the
        /// picture; or filtered, an image (a texture) whose own filter takes the samples of fixed
        /// steps, on most GPUs with weights of eight bits [default: buffer]
        #[arg(long, value_name = "buffer|image|filtered")]
        voxels: Storage,
    }
}

impl SamplingOptions {
    /// With every default in its place.
    pub(super) fn filled(self, method: SamplingMethod) -> Result<Self> {
        let default = Sampling::default();
        Ok(Self {
            sampling: Some(method),
            step: match self.step {
                Some(step) => Some(step),
                None => Some(StepVoxels::new(default.step_voxels)?),
            },
            filter: self.filter.or(Some(default.filter)),
            traverse: self.traverse.or(Some(default.traverse)),
            skip: self.skip.or(Some(default.skip.into())),
            probe: self.probe.or(Some(default.probe.into())),
            voxels: self.voxels.or(Some(default.voxels)),
        })
    }

    pub(super) fn sampling(&self) -> Sampling {
        let default = Sampling::default();
        Sampling {
            method: self.sampling.unwrap_or(default.method),
            step_voxels: self.step.map_or(default.step_voxels, StepVoxels::get),
            filter: self.filter.unwrap_or(default.filter),
            traverse: self.traverse.unwrap_or(default.traverse),
            skip: self.skip.map_or(default.skip, Switch::is_on),
            probe: self.probe.map_or(default.probe, Switch::is_on),
            voxels: self.voxels.unwrap_or(default.voxels),
        }
    }
}
