//! The experiments, a file each; those that repeat a paper's are named after its first author, year and
//! table.

mod check_sampling;
mod convergence;
mod effects;
mod gradients;
mod lesar_2015_figure_5;
mod lesar_2015_figure_9;
mod lesar_2015_octree;
mod lesar_2015_table_1;
mod pareto;
mod rays;
mod ruijters_2006_classification;
mod ruijters_2006_figure_6;
mod ruijters_2006_termination;
mod scharsach_2005_figure_4;
mod scharsach_2005_figure_6;
mod scharsach_2005_table_1;
mod scharsach_2005_table_2;
mod sparse;
mod sparse_rays;
mod speed;
mod tolerance;
mod traversals;
mod vessels;
mod yuan_2009_clip_planes;

use super::Experiment;

/// All experiments, in the order in which they are listed.
pub const EXPERIMENTS: &[Experiment] = &[
    vessels::EXPERIMENT,
    pareto::EXPERIMENT,
    speed::EXPERIMENT,
    sparse::EXPERIMENT,
    effects::EXPERIMENT,
    traversals::EXPERIMENT,
    convergence::EXPERIMENT,
    rays::EXPERIMENT,
    sparse_rays::EXPERIMENT,
    gradients::EXPERIMENT,
    tolerance::EXPERIMENT,
    check_sampling::EXPERIMENT,
    scharsach_2005_table_1::EXPERIMENT,
    scharsach_2005_table_2::EXPERIMENT,
    scharsach_2005_figure_4::EXPERIMENT,
    scharsach_2005_figure_6::EXPERIMENT,
    ruijters_2006_figure_6::EXPERIMENT,
    ruijters_2006_termination::EXPERIMENT,
    ruijters_2006_classification::EXPERIMENT,
    yuan_2009_clip_planes::EXPERIMENT,
    lesar_2015_table_1::EXPERIMENT,
    lesar_2015_octree::EXPERIMENT,
    lesar_2015_figure_9::EXPERIMENT,
    lesar_2015_figure_5::EXPERIMENT,
];
