//! The passes of `iso`: straight-line code, the order of lines is the schedule.

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::{
    Filling, KernelEnum, Material, Shading, StoredIso, SurfaceCast, covector_scale, shading,
};
use crate::render::passes::{
    Blocks, Hiding, Leaving, Lit, Run, Seen, SurfaceBlocks, ambient_occlusion, behind_surface,
    cast_surface, exact_surface, interpolate_hits, mark_uncertain, shade_surface, surface_normal,
};
use crate::render::resources::Hemispheres;
use crate::scene::{
    AmbientOcclusion, Filter, Phong, Refill, Refine, Rgb, SamplingMethod, ScreenError, ShadedFrom,
};

use super::planes::Planes;
use super::schedule::Schedule;
use super::view::View;

/// How a scene's surface is found and seen, but for its iso value.
pub struct Surface {
    /// Whether the volume's faces are closed with caps where they are above the iso value.
    pub caps: bool,
    /// How a crossing between two samples is refined.
    pub refine: Refine,
    /// The surface's own colour.
    pub color: Rgb,
    /// How it reflects light; `None`: it shows its colour.
    pub phong: Option<Phong>,
}

/// Casts, finds normals and what is occluded where those are needed, shades.
pub struct SurfacePasses<'a> {
    view: &'a View<'a>,
    cast: SurfaceCast,
    light: Shading,
    is_shaded: bool,
    occlusion: Option<Occlusion>,
}

/// Ambient occlusion with what its pass reads.
struct Occlusion {
    asked: AmbientOcclusion,
    hemispheres: Hemispheres,
}

/// How far from a surface the rays that leave it begin, in voxels of the smallest spacing: so far that single
/// precision knows the side on which they are, unless they leave it within a few thousandths of its tangents.
const START_VOXELS: f64 = 1e-3;

impl<'a> SurfacePasses<'a> {
    /// The passes of a surface.
    ///
    /// # Errors
    /// The device has no room.
    pub fn new(run: &Run, view: &'a View<'a>, iso: StoredIso, surface: &Surface) -> Result<Self> {
        let material = Material {
            color: surface.color,
            phong: surface.phong,
            shaded_from: ShadedFrom::default(),
        };
        let occlusion = |asked: AmbientOcclusion| {
            Ok(Occlusion {
                asked,
                hemispheres: Hemispheres::upload(run.device, asked.rays.get())?,
            })
        };
        Ok(Self {
            view,
            cast: surface_cast(view, iso, surface),
            light: shading(&material, view.scene, view.volume),
            is_shaded: surface.phong.is_some(),
            occlusion: view.scene.ambient_occlusion.map(occlusion).transpose()?,
        })
    }

    /// The layers that the passes write: what is wanted, and what later passes read.
    fn layers(&self) -> Vec<Layer> {
        let wanted = self.view.wanted;
        let mut layers = vec![Layer::Kind];
        if wanted.has_any([Layer::Depth, Layer::Value]) {
            layers.extend([Layer::Depth, Layer::Value]);
        }
        if wanted.has_any(Layer::COUNTERS) {
            layers.extend(Layer::COUNTERS);
        }
        let method = self.view.scene.sampling.method;
        if wanted.has(Layer::Certificate) && method == SamplingMethod::Exact {
            layers.push(Layer::Certificate);
        }
        // Pixels are compared by their normals, whether or not those are wanted.
        let scene = self.view.scene;
        let is_compared = scene
            .sparse
            .is_some_and(|sparse| sparse.refill == Refill::Flood);
        if wanted.has(Layer::Normal) || self.is_shaded || is_compared {
            layers.push(Layer::Normal);
        }
        if self.occlusion.is_some() {
            layers.push(Layer::Occlusion);
        }
        layers
    }
}

impl Schedule for SurfacePasses<'_> {
    fn planes(&self, run: &Run) -> Result<Planes> {
        let mut planes = Planes::new(run, &self.layers())?;
        planes.hit_mm = Some(run.plane("hit plane", f32::INFINITY)?);
        let hemispheres = self.occlusion.as_ref();
        planes.other_bytes += hemispheres.map_or(0, |occlusion| occlusion.hemispheres.bytes());
        Ok(planes)
    }

    fn cast(&self, run: &mut Run, planes: &mut Planes) -> Result<()> {
        let Self { view, .. } = *self;
        let sampling = &view.scene.sampling;
        let Planes {
            hit_mm: Some(hit_mm),
            layers,
            ..
        } = planes
        else {
            return Ok(());
        };
        let (inputs, cast) = (view.inputs, &self.cast);
        match sampling.method {
            SamplingMethod::Fixed => {
                cast_surface(run, inputs, cast, sampling.recon, hit_mm, layers)?
            }
            SamplingMethod::Exact => exact_surface(run, inputs, cast, hit_mm, layers)?,
        }
        self.show(run, planes)
    }

    /// Fixed steps are not held against the surface itself: of them only emptiness is proven.
    fn mark_unproven(
        &self,
        run: &mut Run,
        blocks: Blocks,
        error: ScreenError,
        marks: &mut Buffer<u32>,
    ) -> Result<()> {
        let sampling = &self.view.scene.sampling;
        let is_solved =
            sampling.method == SamplingMethod::Exact && sampling.filter == Filter::Linear;
        let spacing_mm = self.view.volume.geometry().smallest_spacing_mm();
        let asked = SurfaceBlocks {
            blocks,
            iso: self.cast.iso,
            margin: 0.0,
            max_error_mm: (is_solved && blocks.have_insides())
                .then_some((error.get() * spacing_mm) as f32),
            seen: None,
        };
        mark_uncertain(run, self.view.inputs, &asked, marks)
    }

    fn mark_hidden(&self, run: &mut Run, planes: &Planes, marks: &mut Buffer<u32>) -> Result<()> {
        let kinds = planes.layers.layer_counts(Layer::Kind);
        let asked = SurfaceBlocks {
            blocks: Blocks::PIXELS,
            iso: self.cast.iso,
            margin: 0.5,
            max_error_mm: None,
            seen: kinds.map(Seen::Kinds),
        };
        mark_uncertain(run, self.view.inputs, &asked, marks)
    }

    /// Proven pieces of the surface are interpolated by their hits.
    fn proven_filling(&self) -> Filling {
        Filling::Empty
    }

    fn interpolate(&self, run: &mut Run, marks: &Buffer<u32>, planes: &mut Planes) -> Result<()> {
        if let Planes {
            hit_mm: Some(hit_mm),
            layers,
            ..
        } = planes
        {
            interpolate_hits(run, self.cast.iso, marks, hit_mm, layers)?;
        }
        self.show(run, planes)
    }

    fn hidden_planes(&self, run: &Run) -> Result<Option<Planes>> {
        let mut layers = vec![Layer::Kind, Layer::Depth];
        if self.is_shaded {
            layers.push(Layer::Normal);
        }
        if self.occlusion.is_some() {
            layers.push(Layer::Occlusion);
        }
        let mut planes = Planes::new(run, &layers)?;
        planes.hit_mm = Some(run.plane("hit plane", f32::INFINITY)?);
        Ok(Some(planes))
    }

    fn cast_hidden(
        &self,
        run: &mut Run,
        reaches: &Buffer<[f32; 4]>,
        planes: &Planes,
        hidden: &mut Planes,
    ) -> Result<()> {
        let (Some(hit_mm), Some(hidden_mm)) = (&planes.hit_mm, &mut hidden.hit_mm) else {
            return Ok(());
        };
        let spacing_mm = self.view.volume.geometry().smallest_spacing_mm();
        let hiding = Hiding {
            reaches,
            after_mm: (START_VOXELS * spacing_mm) as f32,
            hit_mm,
        };
        let layers = &mut hidden.layers;
        behind_surface(run, self.view.inputs, &self.cast, hiding, hidden_mm, layers)?;
        self.show(run, hidden)
    }
}

impl SurfacePasses<'_> {
    /// Finds the normals of the rays' hits and what is occluded of them, where those are needed, and shades them.
    fn show(&self, run: &mut Run, planes: &mut Planes) -> Result<()> {
        let Planes {
            hit_mm: Some(hit_mm),
            layers,
            color,
            ..
        } = planes
        else {
            return Ok(());
        };
        if layers.has(Layer::Normal) {
            surface_normal(run, self.view.inputs, self.view.gradient, hit_mm, layers)?;
        }
        if let Some(Occlusion { asked, hemispheres }) = &self.occlusion {
            let volume = self.view.volume;
            let start_mm = START_VOXELS * volume.geometry().smallest_spacing_mm();
            let scale = covector_scale(volume);
            let leaving = Leaving {
                hemispheres,
                t: [start_mm, asked.distance.get()].map(|mm| (mm * scale) as f32),
            };
            ambient_occlusion(run, self.view.inputs, &self.cast, leaving, hit_mm, layers)?;
        }
        let lit = Lit {
            shading: &self.light,
            hit_mm: self.is_shaded.then_some(&*hit_mm),
            occlusion: (self.occlusion.as_ref())
                .map(|occlusion| occlusion.asked.strength.get() as f32),
        };
        shade_surface(run, lit, layers, color)
    }
}

fn surface_cast(view: &View, iso: StoredIso, surface: &Surface) -> SurfaceCast {
    SurfaceCast {
        iso: iso.value,
        step_mm: view.step_mm(),
        caps: u32::from(surface.caps),
        refine: surface.refine.method().number(),
        iterations: surface.refine.iterations(),
        traverse: view.traverse(),
        probe: u32::from(view.scene.sampling.probe),
        iso_error: iso.error,
    }
}
