//! Depth of field: the mean of the pictures that points of a lens see.

use crate::error::Result;
use crate::frame::Layer;
use crate::render::passes::{Run, add_picture};
use crate::render::resources::RaySource;
use crate::scene::{AntiAliasing, DepthOfField, LensPoint, RayCount, Scene};

use super::cues::tint;
use super::focus::{circles, focus_mm};
use super::picture::schedule;
use super::planes::Planes;
use super::schedule::Schedule;
use super::view::View;

/// Replaces the planes' colour, the pinhole's, by what the lens sees; the depths must be there. Each point of the lens sees a
/// picture whose rays are linear over the picture as the pinhole's are, so that they keep together. With anti-aliasing they
/// pass the pixels at its places, in turn.
///
/// Every pass is built before the first of them, but the device is waited for where the depths decide the focus.
///
/// # Errors
/// As [`Run::cast`]; nothing is seen in the pixel that is to be in focus; the device failed or has no room.
pub fn see_through_lens(
    run: &mut Run,
    view: &View,
    planes: &mut Planes,
    dof: DepthOfField,
    rays: RayCount,
) -> Result<()> {
    let of_points = view.of_other_rays();
    let schedule = schedule(run, &of_points)?;
    let lens = LensPictures {
        view,
        schedule: schedule.as_ref(),
        rays,
    };
    let mut seen = schedule.planes(run)?;
    planes
        .layers
        .allocate(run.device, &run.rays, &[Layer::Coc])?;
    run.announcing = true;
    lens.add(run, 0, None, &mut seen, planes)?;
    circles(
        run,
        view.scene,
        dof,
        1.0,
        &mut planes.layers,
        &mut planes.color,
    )?;
    run.announcing = false;

    let focus_mm = focus_mm(run, view.scene, dof, planes)?;
    for (n, point) in dof.lens_points(rays, focus_mm, 0.0).enumerate() {
        lens.add(run, n, Some(point), &mut seen, planes)?;
    }
    let Planes { layers, color, .. } = &mut *planes;
    circles(run, view.scene, dof, focus_mm, layers, color)?;
    planes.focus_mm = Some(focus_mm);
    planes
        .rays_per_round
        .push(u64::from(rays.get()) * run.rays.places() as u64);
    planes.other_bytes += seen.bytes();
    Ok(())
}

/// The pictures that points of the lens see.
struct LensPictures<'a> {
    view: &'a View<'a>,
    schedule: &'a dyn Schedule,
    rays: RayCount,
}

impl LensPictures<'_> {
    /// Casts the n-th picture and adds its share to the planes' colour.
    fn add(
        &self,
        run: &mut Run,
        n: usize,
        point: Option<LensPoint>,
        seen: &mut Planes,
        planes: &mut Planes,
    ) -> Result<()> {
        let Scene {
            camera,
            size,
            anti_aliasing,
            ..
        } = self.view.scene;
        let place = nth_place(*anti_aliasing, n);
        let source = RaySource::through_lens(camera, *size, self.view.volume, point, place);
        let pinhole = std::mem::replace(&mut run.rays, source);
        self.schedule.cast(run, seen)?;
        self.schedule.finish(run, seen)?;
        tint(run, self.view, seen)?;
        run.rays = pinhole;
        let share = 1.0 / self.rays.get() as f32;
        add_picture(run, share, n == 0, &seen.color, &mut planes.color)
    }
}

/// Where the rays of the n-th picture pass their pixels: from the upper left corner, in pixels.
fn nth_place(aa: AntiAliasing, n: usize) -> [f64; 2] {
    let mut places = aa.places_px().skip(n % aa.rays() as usize);
    places.next().unwrap_or([0.5; 2])
}
