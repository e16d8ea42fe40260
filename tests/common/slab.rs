//! A slab and what cuts it, whose thickness along a ray has a closed form.

use angioray::scene::{ClipPlane, Scene};
use angioray::volume::Volume;
use glam::DVec3;
use std::sync::Arc;

use crate::occlusion_cases::{scene, volume};

/// A ray through one pixel, and how far it goes on behind its hit.
pub struct ThickCase {
    pub name: &'static str,
    pub volume: Arc<Volume>,
    pub scene: Scene,
    pub thick_mm: f64,
}

/// Planes 6.5 voxels apart, across z from 7.25 on; the field is linear on both sides of the middle voxels.
fn slab() -> Arc<Volume> {
    volume([24, 24, 24], |p| (p.z - 7.25).min(13.75 - p.z).min(2.0))
}

pub fn thick_cases() -> Vec<ThickCase> {
    let center = DVec3::new(11.6, 12.3, 11.1);
    let seen = |name, volume: &Arc<Volume>, toward_eye: DVec3, thick_mm| ThickCase {
        name,
        volume: Arc::clone(volume),
        scene: scene(center + 40.0 * toward_eye.normalize(), center, 30.0),
        thick_mm,
    };
    let slab = slab();
    let oblique = DVec3::new(0.3, -0.4, 1.0);
    let through = 6.5 / oblique.normalize().z;
    let mut cut = seen("a slab cut behind the hit", &slab, DVec3::Z, 13.75 - 9.5);
    cut.scene.clip_planes = vec![ClipPlane::new(DVec3::Z, -9.5).unwrap()];
    let mut capped = seen("a slab cut open", &slab, DVec3::Z, 10.5 - 7.25);
    capped.scene.clip_planes = vec![ClipPlane::new(DVec3::NEG_Z, 10.5).unwrap()];
    let solid = volume([24, 24, 24], |_| 1.0);
    let hollow = volume([24, 24, 24], |p| (p.z - 9.25).max(5.5 - p.z));
    let inside = ThickCase {
        name: "seen from inside",
        scene: scene(DVec3::new(11.6, 12.3, 22.0), center, 30.0),
        volume: hollow,
        thick_mm: 9.25 - 5.5,
    };
    vec![
        seen("a slab", &slab, DVec3::Z, 6.5),
        seen("a slab seen obliquely", &slab, oblique, through),
        cut,
        capped,
        seen("a solid block", &solid, DVec3::NEG_X, 23.0),
        inside,
    ]
}
