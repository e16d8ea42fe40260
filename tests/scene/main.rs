//! Scenes and their options.

mod scene_camera;
mod scene_options;
mod scene_sampling;
mod scene_transfer_files;
