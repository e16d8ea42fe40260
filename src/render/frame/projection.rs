//! The passes of `mip`, `minip`, `mean` and `lmip`: straight-line code, the order of lines is the schedule.

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::{MARK_CAST, ProjectionCast, ProjectionLoop, stored, stored_window};
use crate::render::occupancy::Floor;
use crate::render::passes::{
    Blocks, Fill, FirstValues, Run, cast_maximum, exact_projection, fill_uncast, mark_exceeding,
    mark_grid, mark_varying_values, window_value,
};
use crate::scene::{Projection, SamplingMethod, ScreenError, Window};

use super::planes::Planes;
use super::schedule::Schedule;
use super::view::View;

/// The share of the window by which what lies in a pixel may exceed what its first ray found, without asking for more.
const HIDDEN: f32 = 0.05;

/// Casts, then shows the values through the window.
pub struct ProjectionPasses<'a> {
    view: &'a View<'a>,
    which: ProjectionLoop,
    cast: ProjectionCast,
    /// Its black and white ends, stored units.
    window: [f32; 2],
}

impl<'a> ProjectionPasses<'a> {
    /// The passes of a projection.
    pub fn new(view: &'a View<'a>, of: Projection, window: Window, floor: Floor) -> Self {
        let rescale = view.volume.rescale();
        let (which, threshold) = match of {
            Projection::Maximum | Projection::Minimum => (ProjectionLoop::Extremum, 0.0),
            Projection::Mean => (ProjectionLoop::Mean, 0.0),
            Projection::LocalMaximum { threshold } => {
                (ProjectionLoop::Local, stored(rescale, threshold))
            }
        };
        let cast = ProjectionCast {
            step_mm: view.step_mm(),
            sign: floor.sign,
            threshold,
            traverse: view.traverse(),
            probe: u32::from(view.scene.sampling.probe),
            floor: floor.floor,
            pad_0: 0,
            pad_1: 0,
        };
        Self {
            view,
            which,
            cast,
            window: stored_window(rescale, window),
        }
    }

    /// The layers that the cast writes: what is wanted, and what the window reads.
    fn layers(&self) -> Vec<Layer> {
        let wanted = self.view.wanted;
        let mut layers = vec![Layer::Kind, Layer::Value];
        if wanted.has(Layer::Depth) {
            layers.push(Layer::Depth);
        }
        if wanted.has_any(Layer::COUNTERS) {
            layers.extend(Layer::COUNTERS);
        }
        layers
    }
}

impl Schedule for ProjectionPasses<'_> {
    fn planes(&self, run: &Run) -> Result<Planes> {
        Planes::new(run, &self.layers())
    }

    fn cast(&self, run: &mut Run, planes: &mut Planes) -> Result<()> {
        let project = match self.view.scene.sampling.method {
            SamplingMethod::Fixed => cast_maximum,
            SamplingMethod::Exact => exact_projection,
        };
        let inputs = self.view.inputs;
        project(run, self.which, inputs, &self.cast, &mut planes.layers)?;
        window_value(run, self.window, &planes.layers, &mut planes.color)
    }

    /// The error is a share of the volume's range of values.
    fn mark_unproven(
        &self,
        run: &mut Run,
        blocks: Blocks,
        error: ScreenError,
        marks: &mut Buffer<u32>,
    ) -> Result<()> {
        let max_error = error.get() * self.view.volume.stored_range().width();
        mark_varying_values(
            run,
            self.which,
            self.view.inputs,
            &self.cast,
            blocks,
            max_error as f32,
            marks,
        )
    }

    /// Nothing hides in a mean, to which what is thinner than a pixel adds next to nothing.
    fn mark_hidden(&self, run: &mut Run, planes: &Planes, marks: &mut Buffer<u32>) -> Result<()> {
        if self.which == ProjectionLoop::Mean {
            return mark_grid(run, 1, MARK_CAST, marks);
        }
        let seen = FirstValues {
            which: self.which,
            cast: &self.cast,
            layers: &planes.layers,
        };
        let [black, white] = self.window;
        let tolerance = HIDDEN * (white - black).abs();
        mark_exceeding(run, self.view.inputs, &seen, tolerance, marks)
    }

    /// Values are what is interpolated: their greys follow.
    fn fill(
        &self,
        run: &mut Run,
        fill: Fill,
        marks: &Buffer<u32>,
        planes: &mut Planes,
    ) -> Result<()> {
        fill_uncast(run, fill, marks, None, None, &mut planes.layers)?;
        window_value(run, self.window, &planes.layers, &mut planes.color)
    }
}
