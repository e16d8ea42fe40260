//! A volume that is measured, and the scenes in which it is measured.

use glam::DVec3;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use crate::error::{Error, Result};
use crate::extent::Dims;
use crate::options::{SceneOptions, Setting};
use crate::scene::{
    Aperture, DepthOfField, DistanceMm, Emission, Knot, Picture, Rgb, Scene, TransferFunction,
};
use crate::subject::{Content, Sphere, Subject};
use crate::volume::{
    Geometry, NonFinite, PhantomKind, PhantomSpec, Rescale, Volume, Voxels, phantom,
};

/// A volume, its name, and the iso value of its surface.
#[derive(Debug)]
pub struct Dataset {
    /// The name in tables and pages: a phantom's, or the file's.
    pub name: String,
    /// The volume that is measured.
    pub volume: Volume,
    /// The iso value, physical.
    pub iso: f64,
}

impl Dataset {
    /// The view that the pictures of all experiments share, in which no voxel axis lies along or across
    /// the picture.
    const VIEW: &str = "azimuth = 30\nelevation = 20\n";

    /// A scene of so many pixels along each side; `options` is text of a scene file.
    ///
    /// # Errors
    /// What the text says is wrong, or cannot be of this volume.
    pub(super) fn scene(&self, side_px: u32, options: &str) -> Result<Scene> {
        self.resolved(&Self::viewed(side_px, options))
    }

    /// The dataset's scene, its rays followed by a setting.
    pub(super) fn scene_by(&self, side_px: u32, options: &str, setting: &Setting) -> Result<Scene> {
        let seen = Self::parsed(&Self::viewed(side_px, options))?;
        self.resolved_options(setting.over(&seen))
    }

    fn viewed(side_px: u32, options: &str) -> String {
        format!("{}size = [{side_px}, {side_px}]\n{options}", Self::VIEW)
    }

    fn parsed(text: &str) -> Result<SceneOptions> {
        SceneOptions::parse(text, "the experiment's scene")
    }

    /// The scene that the whole text of a scene file makes of this volume.
    pub(super) fn resolved(&self, text: &str) -> Result<Scene> {
        self.resolved_options(Self::parsed(text)?)
    }

    fn resolved_options(&self, options: SceneOptions) -> Result<Scene> {
        let sphere = Sphere::from(self.volume.bounding_sphere());
        let subject = Subject {
            sphere,
            content: Content::around(sphere),
            spacing_mm: self.volume.geometry().spacing_mm(),
            range: self.volume.range(),
            robust_range: self.volume.range(),
            otsu: self.iso,
            suggested_iso: self.iso,
        };
        Ok(options.checked()?.resolve(&subject)?.scene)
    }

    /// The surface at [`Dataset::iso`], unshaded, so that casts are what is timed and not normals.
    pub(super) fn surface(&self, side_px: u32) -> Result<Scene> {
        let iso = self.iso;
        self.scene(
            side_px,
            &format!("mode = 'iso'\niso = {iso:?}\nshading = 'none'\n"),
        )
    }

    /// The maximum along each ray, over the whole value range.
    pub(super) fn maximum(&self, side_px: u32) -> Result<Scene> {
        let range = self.volume.range();
        let window = format!("window = [{:?}, {:?}]\n", range.min, range.max);
        self.scene(side_px, &format!("mode = 'mip'\n{window}"))
    }

    /// Emission and absorption: transparent up to the iso value, opacity rising to a half of a voxel's
    /// path at the largest value.
    pub(super) fn emission(&self, side_px: u32) -> Result<Scene> {
        let max = self.volume.range().max.max(self.iso);
        self.medium(side_px, &[(self.iso, 0.0), (max, 0.5)])
    }

    /// Emission and absorption of one colour: `knots` are values (physical) and the opacities of a
    /// voxel's path there, ascending.
    pub(super) fn medium(&self, side_px: u32, knots: &[(f64, f64)]) -> Result<Scene> {
        let colored = |&(value, opacity)| (value, [0.9, 0.6, 0.4], opacity);
        let knots: Vec<_> = knots.iter().map(colored).collect();
        self.colored_medium(side_px, &knots)
    }

    /// A medium like [`Dataset::medium`] in which each knot has a colour of its own, in linear light.
    pub(super) fn colored_medium(
        &self,
        side_px: u32,
        knots: &[(f64, [f64; 3], f64)],
    ) -> Result<Scene> {
        let unit_length_mm = self.volume.geometry().smallest_spacing_mm();
        let knots = knots.iter().map(|&(value, color, opacity)| Knot {
            value,
            color: Rgb(color),
            opacity,
        });
        let transfer = TransferFunction::new(knots.collect(), unit_length_mm)?;
        let mut scene = self.scene(side_px, "mode = 'dvr'\n")?;
        scene.picture = Picture::Emission(Emission::of(transfer));
        Ok(scene)
    }

    /// A lens before this scene's camera, focused on the median depth of what is seen: so wide that the circle of confusion of
    /// the nearest point of the volume's sphere has this diameter in pixels where its centre is in focus.
    pub(super) fn lens(&self, scene: &Scene, widest_px: f64) -> Result<DepthOfField> {
        let (center, radius_mm) = self.volume.bounding_sphere();
        let mut dof: DepthOfField = "focus=auto,aperture=1".parse()?;
        let [grows, _] = dof.growth_px(&scene.camera, scene.size);
        let focus_mm = (center - scene.camera.eye_world()).dot(scene.camera.forward());
        let nearest_mm = focus_mm - radius_mm;
        let of_one_mm = grows * (1.0 / nearest_mm - 1.0 / focus_mm);
        dof.aperture = Aperture::Diameter(DistanceMm::new(widest_px / of_one_mm)?);
        Ok(dof)
    }

    /// `n` straight vessels of one radius, in voxels, in a u8 volume of 64³ voxels of 1 mm.
    ///
    /// A voxel is 255 · clamp(½ + radius − d, 0, 1) with d its centre's distance from the nearest
    /// centreline, in voxels: the edge is one voxel wide, as the partial volume of a scanner's voxel
    /// makes it, and the surface lies where the field is half way, 127.5, the dataset's iso value. The
    /// centrelines run through the whole volume, through random points of its middle half in random
    /// directions.
    ///
    /// # Errors
    /// The volume is refused, as it is if there is no memory for it.
    pub(super) fn straight_vessels(radius: f64, n: usize) -> Result<Self> {
        const SIDE: u64 = 64;
        const SEED: u64 = 7;
        let mut rng = Pcg64::seed_from_u64(SEED);
        let mut unit = || (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let lines: Vec<(DVec3, DVec3)> = (0..n)
            .map(|_| {
                let point = DVec3::new(unit(), unit(), unit()) * 0.5 + 0.25;
                // Uniform on the sphere (Archimedes): height and turn are independent.
                let (height, turn) = (2.0 * unit() - 1.0, std::f64::consts::TAU * unit());
                let flat = (1.0 - height * height).sqrt();
                let along = DVec3::new(flat * turn.cos(), flat * turn.sin(), height);
                (point * (SIDE - 1) as f64, along)
            })
            .collect();
        let value = |p: DVec3| {
            let distance = |(on, along): &(DVec3, DVec3)| (p - *on).cross(*along).length();
            let nearest = lines.iter().map(distance).fold(f64::INFINITY, f64::min);
            (255.0 * (0.5 + radius - nearest).clamp(0.0, 1.0)).round() as u8
        };
        let at = |i: u64| {
            DVec3::new(
                (i % SIDE) as f64,
                (i / SIDE % SIDE) as f64,
                (i / SIDE / SIDE) as f64,
            )
        };
        let voxels: Vec<u8> = (0..SIDE * SIDE * SIDE).map(|i| value(at(i))).collect();
        Ok(Self {
            name: format!("vessel of radius {radius}"),
            volume: Volume::new(
                Dims::new([SIDE; 3])?,
                Voxels::from(voxels),
                Geometry::default(),
                Rescale::IDENTITY,
                NonFinite::Refuse,
            )?,
            iso: 127.5,
        })
    }

    /// A phantom at its default size, its surface half way.
    ///
    /// # Errors
    /// Not enough memory.
    pub(super) fn phantom(kind: PhantomKind) -> Result<Self> {
        let phantom = Self::sized(kind, kind.default_size())?;
        Ok(Self {
            name: format!("{kind} phantom"),
            ..phantom
        })
    }

    /// A phantom of so many voxels along each side, its surface half way.
    ///
    /// # Errors
    /// Not enough memory.
    pub(super) fn sized(kind: PhantomKind, side: u32) -> Result<Self> {
        let dims = Dims::new([u64::from(side); 3])?;
        let spec = PhantomSpec::new(kind, dims);
        Ok(Self {
            name: format!("{kind} phantom {side}"),
            volume: phantom(&spec)?.volume,
            iso: spec.values().at(0.5),
        })
    }

    /// The name of [`Dataset::scan`].
    pub(super) fn scan_name(side: u32) -> String {
        format!("vessel scan {side}")
    }

    /// Vessels as in a scan, of so many voxels along each side: a tree that fills 3 % of the volume,
    /// its finest tips one voxel in radius, under Gaussian noise of 2 % of the value range. So full and
    /// so noisy are the volumes by which other renderers are known.
    ///
    /// # Errors
    /// Not enough memory.
    pub(super) fn scan(side: u32) -> Result<Self> {
        let spec = PhantomSpec {
            radius_mm: Some(f64::from(side) / 16.0),
            tip_radius_mm: Some(1.0),
            noise: 0.02,
            ..PhantomSpec::new(PhantomKind::Vessels, Dims::new([u64::from(side); 3])?)
        };
        Ok(Self {
            name: Self::scan_name(side),
            volume: phantom(&spec)?.volume,
            iso: spec.values().at(0.5),
        })
    }

    /// The identity of the dataset: the content of its volume and its iso value.
    pub(super) fn identity(&self) -> String {
        let volume = &self.volume;
        let (dims, kind) = (volume.dims(), volume.voxels().voxel_type().name());
        let content = volume.content_hash().to_hex();
        format!(
            "{} ({dims} {kind}, iso {}, content {})",
            self.name,
            self.iso,
            &content[..16]
        )
    }

    /// Checks that the dataset can be measured.
    ///
    /// # Errors
    /// Usage: all voxels are equal, so that there is nothing to measure.
    pub fn check(&self) -> Result<()> {
        if self.volume.range().width() > 0.0 {
            return Ok(());
        }
        Err(Error::usage(format!(
            "{}: all voxels are equal, there is nothing to measure",
            self.name
        )))
    }
}
