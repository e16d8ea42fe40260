//! One case of an experiment: a picture and how it is made.

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::octree::Leaf;
use crate::scene::{
    Emission, Picture, Refill, Refine, Sampling, SamplingMethod, Scene, Sparse, SparseGrid,
    StepVoxels,
};

/// A picture, and how it is made.
pub struct Case {
    pub name: String,
    pub scene: Scene,
    pub leaf: Leaf,
    pub paper: Paper,
    /// The case, by its index in the list, whose picture this one's must equal to the last bit.
    pub same_as: Option<usize>,
}

/// The measurements of the paper on its machine; its ratios are to the first case's figure.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Paper {
    pub fps: Option<f64>,
    /// Where the paper gives no frames per second: how many times as fast as the first case.
    pub speedup: Option<f64>,
}

impl Case {
    pub fn new(name: impl Into<String>, scene: Scene) -> Self {
        Self {
            name: name.into(),
            scene,
            leaf: Leaf::default(),
            paper: Paper::default(),
            same_as: None,
        }
    }

    #[must_use]
    pub fn paper_fps(mut self, fps: Option<f64>) -> Self {
        self.paper.fps = fps;
        self
    }

    #[must_use]
    pub fn same_as(mut self, index: usize) -> Self {
        self.same_as = Some(index);
        self
    }

    /// The scene as the reference renders it: what is seen, without how rays are followed and through which
    /// pixels; and without what dims and blurs a surface, of which hits alone are compared.
    pub(super) fn reference_scene(&self) -> Scene {
        let mut scene = self.scene.clone();
        scene.sparse = None;
        scene.ambient_occlusion = None;
        scene.depth_of_field = None;
        scene.sampling = Sampling {
            filter: scene.sampling.filter,
            ..Sampling::default()
        };
        match &mut scene.picture {
            Picture::Surface { refine, .. } => *refine = Refine::default(),
            Picture::Emission(medium) => {
                *medium = Emission {
                    phong: medium.phong,
                    ..Emission::of(medium.transfer.clone())
                }
            }
            Picture::Projection { .. } => {}
        }
        scene
    }
}

/// A surface at fixed steps as in the papers: nothing is searched between two samples.
///
/// # Errors
/// A step outside its domain.
pub fn plain_steps(scene: &Scene, step_voxels: f64, refine: Refine) -> Result<Scene> {
    let mut scene = scene.clone();
    scene.sampling.method = SamplingMethod::Fixed;
    scene.sampling.step = StepVoxels::new(step_voxels)?;
    scene.sampling.probe = false;
    if let Picture::Surface { refine: of, .. } = &mut scene.picture {
        *of = refine;
    }
    Ok(scene)
}

/// The scene cast sparsely as in Lesar et al. 2015, §III-D: every fourth pixel along each axis, and the blocks whose
/// corners differ.
///
/// # Errors
/// A grid that there is not, which tests rule out.
pub fn sparsely(mut scene: Scene) -> Result<Scene> {
    let grid = SparseGrid::new(4, None)?;
    scene.sparse = Some(Sparse::new(
        Some(grid),
        Some(Refill::Gradient),
        None,
        scene.picture.mode(),
    )?);
    Ok(scene)
}

/// Returns the scene without skipping.
pub fn unskipped(mut scene: Scene) -> Scene {
    scene.sampling.skip = false;
    scene
}
