//! A volume's [`Subject`].

use glam::DVec3;

use super::{Histogram, Volume, suggested_iso};
use crate::subject::{Content, Corners, Sphere, Subject};

/// Bins of the histogram from which iso values are suggested.
const BINS: usize = 1024;

impl Subject {
    /// Measures a volume: its bounds, its range, and the values that its histogram suggests. Its content is
    /// all of it, until a picture is known.
    pub fn of(volume: &Volume) -> Self {
        Self::with_histogram(volume, &Self::histogram(volume))
    }

    /// Counts a volume's values, of its robust range: the histogram from which iso values are suggested.
    pub fn histogram(volume: &Volume) -> Histogram {
        Histogram::robust(volume, BINS)
    }

    /// Measures a volume of which [`Subject::histogram`] is known.
    pub fn with_histogram(volume: &Volume, histogram: &Histogram) -> Self {
        let sphere = Sphere::from(volume.bounding_sphere());
        Self {
            sphere,
            content: Content::of(volume),
            spacing_mm: volume.geometry().spacing_mm(),
            range: volume.range(),
            robust_range: histogram.range,
            otsu: histogram.otsu(),
            suggested_iso: suggested_iso(histogram),
        }
    }
}

impl Content {
    /// The bounds of all of a volume.
    pub fn of(volume: &Volume) -> Self {
        let [x, y, z] = volume.dims().domain();
        let world_from_index = volume.geometry().world_from_index();
        Self {
            sphere: volume.bounding_sphere().into(),
            corners: Corners::between(
                DVec3::new(x.0, y.0, z.0),
                DVec3::new(x.1, y.1, z.1),
                |corner| world_from_index.transform_point3(corner),
            ),
        }
    }
}
