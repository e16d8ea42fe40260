//! Depth of field from one picture: what is out of focus in it is blurred.

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::passes::{
    BlurredLayer, Discs, Run, blur_along, blur_circles, blur_reach, blur_squares, blurred_squares,
    gather_blur, mix_blurred, put_blurred,
};
use crate::render::resources::BlurTaps;
use crate::scene::{DepthOfField, Share};

use super::cues::tint;
use super::focus::{circles, focus_mm};
use super::picture::schedule;
use super::planes::Planes;
use super::schedule::Schedule;
use super::view::View;

/// Replaces the planes' colour, the pinhole's, by what each pixel gathers of the discs around it, the nearer before the
/// farther; the depths must be there. Of surfaces a second cast finds what first ones hide, with one ray a pixel, where it
/// may be seen past them. A medium is one layer: what lies behind its depth is part of its light.
///
/// Every pass is built before the first of them, but the device is waited for where the depths decide the focus.
///
/// # Errors
/// As [`Run::cast`]; nothing is seen in the pixel that is to be in focus; the device failed or has no room.
pub fn gather(run: &mut Run, view: &View, planes: &mut Planes, dof: DepthOfField) -> Result<()> {
    let of_hidden = view.of_other_rays();
    let schedule = schedule(run, &of_hidden)?;
    let mut blur = Gather {
        view,
        dof,
        schedule: schedule.as_ref(),
        taps: BlurTaps::upload(run.device)?,
        discs: Discs::new(run)?,
        hidden: Hidden::of(run, schedule.as_ref())?,
        squares: blurred_squares(run)?,
        reaches: blurred_squares(run)?,
        blurred: run.plane("blurred colour plane", [0.0; 4])?,
    };
    planes
        .layers
        .allocate(run.device, &run.rays, &[Layer::Coc])?;
    run.announcing = true;
    blur.launch(run, planes, 1.0)?;
    run.announcing = false;

    let focus_mm = focus_mm(run, view.scene, dof, planes)?;
    blur.launch(run, planes, focus_mm)?;
    planes.focus_mm = Some(focus_mm);
    planes.other_bytes += blur.bytes();
    Ok(())
}

/// What first surfaces hide.
struct Hidden {
    planes: Planes,
    discs: Discs,
    reaches: Buffer<[f32; 4]>,
}

impl Hidden {
    /// Room for it; `None`: the picture has no surfaces.
    fn of(run: &Run, schedule: &dyn Schedule) -> Result<Option<Self>> {
        let Some(mut planes) = schedule.hidden_planes(run)? else {
            return Ok(None);
        };
        planes
            .layers
            .allocate(run.device, &run.rays, &[Layer::Coc])?;
        Ok(Some(Self {
            planes,
            discs: Discs::new(run)?,
            reaches: blurred_squares(run)?,
        }))
    }

    /// Device memory held, in bytes.
    fn bytes(&self) -> u64 {
        self.planes.bytes() + self.discs.bytes() + self.reaches.bytes()
    }
}

/// What gathers the discs of a picture.
struct Gather<'a> {
    view: &'a View<'a>,
    dof: DepthOfField,
    schedule: &'a dyn Schedule,
    taps: BlurTaps,
    discs: Discs,
    hidden: Option<Hidden>,
    /// Of each square of pixels how far its discs reach, and what reaches it.
    squares: Buffer<[f32; 4]>,
    reaches: Buffer<[f32; 4]>,
    blurred: Buffer<[f32; 4]>,
}

impl Gather<'_> {
    /// Puts the launches that gather at the end of the frame's.
    fn launch(&mut self, run: &mut Run, planes: &mut Planes, focus_mm: f64) -> Result<()> {
        let (scene, darken) = (self.view.scene, self.dof.darken);
        let reach_px = reach_px(self.view, self.dof, focus_mm);
        let lit = DepthOfField {
            darken: Share::NONE,
            ..self.dof
        };
        let by_alpha = self.hidden.is_some() && scene.anti_aliasing.rays() > 1;
        let Planes { layers, color, .. } = &mut *planes;
        circles(run, scene, lit, focus_mm, layers, color)?;
        blur_circles(run, by_alpha, layers, color, &mut self.discs)?;
        blur_squares(run, &self.discs, &mut self.squares)?;
        blur_reach(run, reach_px, &self.squares, &mut self.reaches)?;
        if let Some(hidden) = &mut self.hidden {
            let of_hidden = &mut hidden.planes;
            self.schedule
                .cast_hidden(run, &self.reaches, planes, of_hidden)?;
            tint(run, self.view, of_hidden)?;
            let Planes { layers, color, .. } = of_hidden;
            circles(run, scene, lit, focus_mm, layers, color)?;
            blur_circles(run, false, layers, color, &mut hidden.discs)?;
            blur_squares(run, &hidden.discs, &mut self.squares)?;
            blur_reach(run, reach_px, &self.squares, &mut hidden.reaches)?;
        }
        let seen = BlurredLayer {
            reaches: &self.reaches,
            discs: &self.discs,
            color: &planes.color,
        };
        let hidden = self.hidden.as_ref().map(|hidden| BlurredLayer {
            reaches: &hidden.reaches,
            discs: &hidden.discs,
            color: &hidden.planes.color,
        });
        gather_blur(run, &self.taps, seen, hidden, &mut self.blurred)?;
        let behind = hidden.map(|layer| layer.reaches);
        put_blurred(run, &self.reaches, behind, &self.blurred, &mut planes.color)?;
        let Planes { layers, color, .. } = &mut *planes;
        if darken.get() > 0.0 {
            circles(run, scene, self.dof, focus_mm, layers, color)?;
        }
        Ok(())
    }

    /// Device memory held, in bytes.
    fn bytes(&self) -> u64 {
        let hidden = self.hidden.as_ref();
        self.taps.bytes()
            + self.discs.bytes()
            + hidden.map_or(0, |hidden| hidden.bytes())
            + self.squares.bytes()
            + self.reaches.bytes()
            + self.blurred.bytes()
    }
}

/// The radius of the widest disc that anything in the volume can have, pixels.
fn reach_px(view: &View, dof: DepthOfField, focus_mm: f64) -> f32 {
    let camera = &view.scene.camera;
    let (center_world, radius_mm) = view.volume.bounding_sphere();
    let middle_mm = (center_world - camera.eye_world()).dot(camera.forward());
    let ends_mm = [-radius_mm, radius_mm].map(|mm| (middle_mm + mm).max(f64::MIN_POSITIVE));
    (dof.widest_px(camera, view.scene.size, focus_mm, ends_mm) / 2.0) as f32
}

/// Replaces the planes' colour, the pinhole's, by a mixture with a blurred one (Lesar et al. 2015, §III-G): the more of that,
/// the wider a pixel's circle of confusion, and all of it where that is the picture's widest, W pixels. The blurred picture
/// is the pinhole's under a Gaussian with a standard deviation of W/4, that of a disc W wide along one axis.
///
/// The device is waited for, as what is seen decides W.
///
/// # Errors
/// As [`gather`].
pub fn mix(run: &mut Run, view: &View, planes: &mut Planes, dof: DepthOfField) -> Result<()> {
    let mut mixing = Mix {
        discs: Discs::new(run)?,
        squares: blurred_squares(run)?,
        across: run.plane("blurred colour plane", [0.0; 4])?,
        blurred: run.plane("blurred colour plane", [0.0; 4])?,
    };
    let lit = DepthOfField {
        darken: Share::NONE,
        ..dof
    };
    let scene = view.scene;
    planes
        .layers
        .allocate(run.device, &run.rays, &[Layer::Coc])?;
    run.announcing = true;
    circles(run, scene, lit, 1.0, &mut planes.layers, &mut planes.color)?;
    mixing.measure(run, planes)?;
    mixing.launch(run, planes, 1.0)?;
    run.announcing = false;

    let focus_mm = focus_mm(run, scene, dof, planes)?;
    let Planes { layers, color, .. } = &mut *planes;
    circles(run, scene, lit, focus_mm, layers, color)?;
    mixing.measure(run, planes)?;
    run.timings.start(run.device)?;
    let squares = mixing.squares.download(run.device)?;
    let widest_px = squares
        .iter()
        .fold(0.0, |most: f32, &[reach, ..]| most.max(2.0 * reach));
    if widest_px > 0.0 {
        mixing.launch(run, planes, widest_px)?;
    }
    if dof.darken.get() > 0.0 {
        let Planes { layers, color, .. } = &mut *planes;
        circles(run, scene, dof, focus_mm, layers, color)?;
    }
    planes.focus_mm = Some(focus_mm);
    planes.other_bytes += mixing.bytes();
    Ok(())
}

/// What a picture is mixed with.
struct Mix {
    discs: Discs,
    squares: Buffer<[f32; 4]>,
    /// The picture blurred along its rows.
    across: Buffer<[f32; 4]>,
    blurred: Buffer<[f32; 4]>,
}

impl Mix {
    /// Puts the launches at the end that find the widest circle of each square of pixels.
    fn measure(&mut self, run: &mut Run, planes: &Planes) -> Result<()> {
        let Planes { layers, color, .. } = planes;
        blur_circles(run, false, layers, color, &mut self.discs)?;
        blur_squares(run, &self.discs, &mut self.squares)
    }

    /// Puts the launches at the end that blur and mix.
    fn launch(&mut self, run: &mut Run, planes: &mut Planes, widest_px: f32) -> Result<()> {
        let deviation_px = widest_px / 4.0;
        let Planes { layers, color, .. } = planes;
        blur_along(run, false, deviation_px, color, &mut self.across)?;
        blur_along(run, true, deviation_px, &self.across, &mut self.blurred)?;
        mix_blurred(run, widest_px, layers, &self.blurred, color)
    }

    /// Device memory held, in bytes.
    fn bytes(&self) -> u64 {
        self.discs.bytes() + self.squares.bytes() + self.across.bytes() + self.blurred.bytes()
    }
}
