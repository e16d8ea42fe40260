//! What a device renders, against the reference and against itself.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod agreement;
mod anti_aliasing;
mod blur;
mod clip_planes;
mod depth_cues;
mod edge_scenes;
mod exact;
mod gradients;
mod homogeneity;
mod invariance;
mod jitter;
mod lens;
mod lights;
mod metamorphic;
#[path = "../common/mutated.rs"]
mod mutated;
mod occlusion;
#[path = "../common/occlusion.rs"]
mod occlusion_cases;
mod quadrature;
mod ray_sources;
mod recon;
mod refinement;
mod sampling_alone;
mod screen_error;
mod screen_occlusion;
mod shadows;
#[path = "../common/slab.rs"]
mod slab;
mod sparse;
mod termination;
mod thickness;
mod voxel_images;
