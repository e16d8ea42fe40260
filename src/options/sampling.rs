//! Sampling options: how rays are followed.

use super::enum_names::Switch;
use super::group::group;
use super::text_form::text_form;
use crate::error::Result;
use crate::scene::{
    AntiAliasing, Filter, Jitter, Mode, Reconstruction, Refill, Sampling, SamplingMethod,
    ScreenError, Sparse, SparseGrid, StepVoxels, Storage, Traverse,
};

text_form!(
    AntiAliasing,
    Filter,
    Jitter,
    Reconstruction,
    Refill,
    SamplingMethod,
    ScreenError,
    SparseGrid,
    StepVoxels,
    Storage,
    Traverse
);

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

        /// Shift each ray's samples by a share of a step that is its own, against the bands that coarse steps
        /// leave: interleaved:N, one of N x N shares that repeat every N x N pixels, N from 2 to 16; hash:SEED,
        /// noise of a whole number; shift:XI, the same share XI for all, from 0 to below 1; or none. In a film every
        /// frame has other shares: :FRAME behind N or SEED is the number of the first
        #[arg(long, value_name = "KIND[:N]", allow_hyphen_values = true)]
        jitter: Jitter,

        /// The field between voxel centres: nearest or linear
        #[arg(long, value_name = "nearest|linear")]
        filter: Filter,

        /// Where the filter is applied: full, at every sample; or adaptive, at hits, the march comparing the
        /// nearest voxels with the iso value
        #[arg(long, value_name = "adaptive|full")]
        recon: Reconstruction,

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

        /// Rays in every pixel, N x N, whose mean is its colour, N from 1 to 8; or N:adaptive, one ray where
        /// more are estimated to show the same and nothing may hide in the pixel; how much that differs from all
        /// rays everywhere is found from a few pixels, and printed
        #[arg(long, value_name = "N[:adaptive]", allow_hyphen_values = true)]
        aa: AntiAliasing,

        /// Cast every K-th pixel along each axis, 2, 3, 4 or 8, and fill the others where --refill allows it.
        /// THRESHOLD: the greatest difference of neighbouring cast pixels' channels, sRGB-encoded from 0
        /// to 1, that is not refilled, 0.05 by default
        #[arg(long, value_name = "K[:THRESHOLD]", allow_hyphen_values = true)]
        sparse: SparseGrid,

        /// The blocks of pixels that are cast and not interpolated: none; gradient, those whose corners
        /// differ; flood, also those whose edges do, until there is no further one; or certified, those that
        /// are not proven to be within --screen-error, so that no pixel is lost
        #[arg(long, value_name = "NAME")]
        refill: Refill,

        /// Cast the pixels alone that cannot be filled within an error, proven before any ray is cast: in
        /// iso voxels of depth, and no hit is lost; in projections a share of the volume's range of values;
        /// in dvr linear light of a channel, beside the quadrature's own error. --sparse K: of blocks K pixels
        /// wide, else 8
        #[arg(long, value_name = "E", allow_hyphen_values = true)]
        screen_error: ScreenError,
    }
}

impl SamplingOptions {
    /// Makes a mode's sampling by this method, and the options that make the same: exact sampling takes no
    /// steps and has none.
    pub(super) fn resolve(self, method: SamplingMethod, mode: Mode) -> (Sampling, Self) {
        let default = Sampling::default();
        let anti_aliasing = self.aa.unwrap_or_default();
        let (sparse, refill, screen_error) = (self.sparse, self.refill, self.screen_error);
        let given = match method {
            SamplingMethod::Fixed => self,
            SamplingMethod::Exact => Self {
                step: None,
                jitter: None,
                probe: None,
                recon: None,
                ..self
            },
        };
        let recon = given.recon.unwrap_or(default.recon);
        // Without the field's slopes there is nothing to search by.
        let probe = default.probe && recon == Reconstruction::Full;
        let sampling = Sampling {
            method,
            step: given.step.unwrap_or(default.step),
            jitter: given.jitter.unwrap_or(default.jitter),
            filter: given.filter.unwrap_or(default.filter),
            recon,
            traverse: given.traverse.unwrap_or(default.traverse),
            skip: given.skip.map_or(default.skip, Switch::is_on),
            probe: given.probe.map_or(probe, Switch::is_on),
            voxels: given.voxels.unwrap_or(default.voxels),
            dof: default.dof, // an effect's option decides it
        };
        let is_fixed = method == SamplingMethod::Fixed;
        let options = Self {
            sampling: Some(method),
            step: is_fixed.then_some(sampling.step),
            jitter: is_fixed.then_some(sampling.jitter),
            filter: Some(sampling.filter),
            recon: (is_fixed && mode == Mode::Iso).then_some(recon),
            traverse: Some(sampling.traverse),
            skip: Some(sampling.skip.into()),
            probe: is_fixed.then_some(sampling.probe.into()),
            voxels: Some(sampling.voxels),
            aa: Some(anti_aliasing),
            sparse,
            refill,
            screen_error,
        };
        (sampling, options)
    }

    /// Makes sparse casting in a mode, where it is wanted, and puts down the options that make the same.
    ///
    /// # Errors
    /// As [`Sparse::new`].
    pub(super) fn resolve_sparse(&mut self, mode: Mode) -> Result<Option<Sparse>> {
        let sparse = self.sparse_in(mode)?;
        self.sparse = sparse.map(Sparse::grid);
        self.refill = sparse.map(|sparse| sparse.refill);
        self.screen_error = sparse.and_then(Sparse::kept_error);
        Ok(sparse)
    }

    /// Sparse casting in a mode, where it is wanted.
    ///
    /// # Errors
    /// As [`Sparse::new`].
    pub(super) fn sparse_in(&self, mode: Mode) -> Result<Option<Sparse>> {
        if !self.is_sparse() {
            return Ok(None);
        }
        Sparse::new(self.sparse, self.refill, self.screen_error, mode).map(Some)
    }

    /// Whether samples are shifted.
    pub(super) fn is_jittered(&self) -> bool {
        self.jitter.is_some_and(Jitter::is_on)
    }

    /// Whether pixels may be filled instead of being cast.
    pub(super) fn is_sparse(&self) -> bool {
        self.sparse.is_some() || self.screen_error.is_some()
    }
}
