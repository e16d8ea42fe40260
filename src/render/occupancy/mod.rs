//! The skip structure: what is known of the octree's nodes and of the cells before a ray meets them.

mod cache;
mod cells;
mod classes;
mod content;
mod criterion;
mod distance;
mod floor;
mod homogeneity;
mod occupancy_map;
mod opacity_ranges;
mod rows;

pub use cache::OccupancyCache;
pub use content::content;
pub use criterion::{Criterion, Opacity};
pub use floor::Floor;
pub use homogeneity::stand_ins;
pub use occupancy_map::{Occupancy, OccupancyTables};
