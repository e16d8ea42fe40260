//! The passes of `iso`: straight-line code, the order of lines is the schedule.

use crate::error::Result;
use crate::frame::Layer;
use crate::gpu::Buffer;
use crate::render::abi::{
    Filling, KernelEnum, Material, Shading, StoredIso, SurfaceCast, covector_scale, shading,
};
use crate::render::passes::{
    Blocks, Bounding, Hiding, Leaving, Lit, Run, Seen, SurfaceBlocks, Thickness, TowardLights,
    ambient_occlusion, behind_surface, bound_occlusion, cast_shadows, cast_surface, exact_surface,
    interpolate_hits, mark_uncertain, occlusion_between, shade_surface, surface_normal,
};
use crate::render::resources::{RaySets, RaySource};
use crate::scene::{
    AmbientOcclusion, Filter, Occlusion, OcclusionBy, OcclusionError, Phong, Refill, Refine, Rgb,
    SamplingMethod, ScreenError, ShadedFrom,
};

use super::planes::{Centers, Planes};
use super::schedule::Schedule;
use super::screen::{ScreenPasses, find_thickness};
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
    occlusion: Option<FoundBy>,
    /// The directions about the middle of each light, where shadows are cast.
    shadows: Option<RaySets>,
}

/// How ambient occlusion is found, with what the passes read.
enum FoundBy {
    Rays {
        asked: AmbientOcclusion,
        directions: RaySets,
    },
    Bounds {
        asked: AmbientOcclusion,
        error: OcclusionError,
    },
    Screen(ScreenPasses),
}

impl FoundBy {
    fn new(run: &Run, asked: Occlusion) -> Result<Self> {
        Ok(match asked {
            Occlusion::Volume(asked) => match asked.by {
                OcclusionBy::Rays(rays) => Self::Rays {
                    asked,
                    directions: RaySets::over_hemisphere(run.device, rays.get())?,
                },
                OcclusionBy::Bound(error) => Self::Bounds { asked, error },
            },
            Occlusion::Screen(asked) => Self::Screen(ScreenPasses::new(run, asked)?),
        })
    }

    fn bytes(&self) -> u64 {
        match self {
            Self::Rays { directions, .. } => directions.bytes(),
            Self::Bounds { .. } => 0,
            Self::Screen(passes) => passes.bytes(),
        }
    }
}

/// The rays toward each light from a hit, where the light has a size.
const SOFT_RAYS: u32 = 32;

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
        let scene = view.scene;
        let is_shaded = surface.phong.is_some();
        let shadows = scene.shadows.filter(|_| is_shaded).map(|shadows| {
            let radius = 0.5 * shadows.light_size.get().to_radians();
            RaySets::over_light(run.device, SOFT_RAYS, radius)
        });
        let occlusion = |asked| FoundBy::new(run, asked);
        Ok(Self {
            view,
            cast: surface_cast(view, iso, surface),
            light: shading(&material, scene, view.volume),
            is_shaded,
            occlusion: scene.ambient_occlusion.map(occlusion).transpose()?,
            shadows: shadows.transpose()?,
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
        if wanted.has(Layer::Normal) || self.is_shaded || is_compared || self.screen().is_some() {
            layers.push(Layer::Normal);
        }
        if self.occlusion.is_some() {
            layers.push(Layer::Occlusion);
        }
        let is_bounded = matches!(self.occlusion, Some(FoundBy::Bounds { .. }));
        if is_bounded && wanted.has(Layer::OcclusionBound) {
            layers.push(Layer::OcclusionBound);
        }
        if self.shadows.is_some() && wanted.has(Layer::Visibility) {
            layers.push(Layer::Visibility);
        }
        if wanted.has(Layer::Thick) {
            layers.push(Layer::Thick);
        }
        layers
    }
}

impl Schedule for SurfacePasses<'_> {
    fn planes(&self, run: &Run) -> Result<Planes> {
        let mut planes = self.planes_of(run, &self.layers())?;
        if let Some(screen) = self.screen()
            && run.rays.picture().is_some()
        {
            planes.screen = Some(screen.planes(run, self.view)?);
        }
        planes.other_bytes += self.occlusion.as_ref().map_or(0, FoundBy::bytes);
        planes.other_bytes += self.shadows.as_ref().map_or(0, RaySets::bytes);
        Ok(planes)
    }

    fn cast(&self, run: &mut Run, planes: &mut Planes) -> Result<()> {
        self.find_hits(run, planes)?;
        self.find_thickness(run, planes)?;
        self.show(run, planes)
    }

    fn finish(&self, run: &mut Run, planes: &mut Planes) -> Result<bool> {
        let Some(screen) = self.screen() else {
            return Ok(false);
        };
        screen.find(run, self.view, &self.cast, planes)?;
        self.shade(run, true, planes)?;
        Ok(true)
    }

    fn needs_centers(&self) -> bool {
        self.screen().is_some()
    }

    fn cast_between(&self, run: &mut Run, centers: Centers, planes: &mut Planes) -> Result<()> {
        let Some(of_centers) = centers.screen else {
            return self.cast(run, planes);
        };
        self.find_hits(run, planes)?;
        self.find_normals(run, planes)?;
        if let Planes {
            hit_mm: Some(hit_mm),
            layers,
            ..
        } = planes
        {
            let known = (&of_centers.spans, centers.layers);
            occlusion_between(run, known, hit_mm, layers)?;
        }
        self.shade(run, true, planes)
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
        self.find_thickness(run, planes)?;
        self.show(run, planes)
    }

    fn hidden_planes(&self, run: &Run) -> Result<Option<Planes>> {
        let mut layers = vec![Layer::Kind, Layer::Depth];
        if self.is_shaded || self.view.wanted.has(Layer::Normal) {
            layers.push(Layer::Normal);
        }
        if self.occlusion.is_some() && self.screen().is_none() {
            layers.push(Layer::Occlusion);
        }
        self.planes_of(run, &layers).map(Some)
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
        self.find_normals(run, hidden)?;
        self.light_hits(run, hidden)
    }
}

impl SurfacePasses<'_> {
    /// Room for these layers and for what the passes hand on from a hit to its colour.
    fn planes_of(&self, run: &Run, layers: &[Layer]) -> Result<Planes> {
        let mut planes = Planes::new(run, layers)?;
        planes.hit_mm = Some(run.plane("hit plane", f32::INFINITY)?);
        if self.shadows.is_some() {
            planes.lights_reached = Some(run.plane("plane of lights", [0.0; 4])?);
        }
        Ok(planes)
    }

    /// The passes that estimate occlusion from the picture, where it is found so.
    fn screen(&self) -> Option<&ScreenPasses> {
        match &self.occlusion {
            Some(FoundBy::Screen(passes)) => Some(passes),
            _ => None,
        }
    }

    /// Finds how far rays go on behind their hits, where that is needed.
    fn find_thickness(&self, run: &mut Run, planes: &mut Planes) -> Result<()> {
        let spacing_mm = self.view.volume.geometry().smallest_spacing_mm();
        let exact = Thickness::Exact {
            inputs: self.view.inputs,
            cast: &self.cast,
            start_mm: (START_VOXELS * spacing_mm) as f32,
        };
        let taken = self.screen().and_then(ScreenPasses::thickness);
        find_thickness(run, exact, taken, planes)
    }

    fn find_hits(&self, run: &mut Run, planes: &mut Planes) -> Result<()> {
        let Self { view, cast, .. } = self;
        let sampling = &view.scene.sampling;
        let Planes {
            hit_mm: Some(hit_mm),
            layers,
            ..
        } = planes
        else {
            return Ok(());
        };
        match sampling.method {
            SamplingMethod::Fixed => {
                cast_surface(run, view.inputs, cast, sampling.recon, hit_mm, layers)
            }
            SamplingMethod::Exact => exact_surface(run, view.inputs, cast, hit_mm, layers),
        }
    }

    fn find_normals(&self, run: &mut Run, planes: &mut Planes) -> Result<()> {
        let Planes {
            hit_mm: Some(hit_mm),
            layers,
            ..
        } = planes
        else {
            return Ok(());
        };
        if !layers.has(Layer::Normal) {
            return Ok(());
        }
        surface_normal(run, self.view.inputs, self.view.gradient, hit_mm, layers)
    }

    /// Finds the normals of the rays' hits and what is occluded of them, where those are needed and can be known, and shades
    /// them; a whole picture whose occlusion is estimated from itself is shaded when that is known.
    fn show(&self, run: &mut Run, planes: &mut Planes) -> Result<()> {
        self.find_normals(run, planes)?;
        let waits = self.screen().is_some() && matches!(run.rays, RaySource::Camera { .. });
        if waits {
            return Ok(());
        }
        self.light_hits(run, planes)
    }

    /// Shades the hits by what the volume around them tells of their occlusion, where it does.
    fn light_hits(&self, run: &mut Run, planes: &mut Planes) -> Result<()> {
        let is_known = self.occlude(run, planes)?;
        self.shade(run, is_known, planes)
    }

    /// Finds what is occluded of the hits in the volume, and whether it is found there.
    fn occlude(&self, run: &mut Run, planes: &mut Planes) -> Result<bool> {
        let Planes {
            hit_mm: Some(hit_mm),
            layers,
            ..
        } = planes
        else {
            return Ok(false);
        };
        let volume = self.view.volume;
        let start_mm = START_VOXELS * volume.geometry().smallest_spacing_mm();
        let in_t = |mm: f64| (mm * covector_scale(volume)) as f32;
        let (inputs, cast) = (self.view.inputs, &self.cast);
        match &self.occlusion {
            Some(FoundBy::Rays { asked, directions }) => {
                let leaving = Leaving {
                    directions,
                    t: [start_mm, asked.distance.get()].map(in_t),
                };
                ambient_occlusion(run, inputs, cast, leaving, hit_mm, layers)?;
            }
            Some(FoundBy::Bounds { asked, error }) => {
                let bounding = Bounding {
                    t_max: in_t(asked.distance.get()),
                    unknown: (2.0 * error.get()) as f32,
                };
                bound_occlusion(run, inputs, cast, bounding, hit_mm, layers)?;
            }
            Some(FoundBy::Screen(_)) | None => return Ok(false),
        }
        Ok(true)
    }

    /// Finds what reaches the hits of each light, where shadows are cast.
    fn cast_shadows(&self, run: &mut Run, planes: &mut Planes) -> Result<()> {
        let (
            Some(directions),
            Planes {
                hit_mm: Some(hit_mm),
                layers,
                lights_reached: Some(lights_reached),
                ..
            },
        ) = (&self.shadows, planes)
        else {
            return Ok(());
        };
        let volume = self.view.volume;
        let start_mm = START_VOXELS * volume.geometry().smallest_spacing_mm();
        let toward = TowardLights {
            shading: &self.light,
            directions,
            t_min: (start_mm * covector_scale(volume)) as f32,
        };
        let inputs = self.view.inputs;
        cast_shadows(
            run,
            inputs,
            &self.cast,
            toward,
            hit_mm,
            layers,
            lights_reached,
        )
    }

    /// Shades the hits, by what reaches them of each light and, as far as their occlusion `is_known`, by that too.
    fn shade(&self, run: &mut Run, is_known: bool, planes: &mut Planes) -> Result<()> {
        self.cast_shadows(run, planes)?;
        let Planes {
            hit_mm,
            layers,
            lights_reached,
            color,
            ..
        } = planes;
        let asked = self.view.scene.ambient_occlusion.filter(|_| is_known);
        let lit = Lit {
            shading: &self.light,
            hit_mm: hit_mm.as_ref().filter(|_| self.is_shaded),
            lights_reached: lights_reached.as_ref(),
            occlusion: asked.map(|asked| asked.strength().get() as f32),
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
