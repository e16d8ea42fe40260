//! What a report says, before it is a page: plain data.

use super::Table;

/// A page about one volume or one run of an experiment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// The page's title, a few words such as `aneurism: speed against error`.
    pub title: String,
    /// A sentence or two for somebody who knows nothing of this: what is seen here, how to read it.
    pub summary: String,
    /// Facts about the run, as name and value: volume, size, device, driver, versions, protocol.
    pub facts: Vec<(String, String)>,
    /// The command line that makes this page again.
    pub command: String,
    /// The findings, a sentence each.
    pub findings: Vec<String>,
    /// The parts of the page: one per mode, or per table.
    pub sections: Vec<Section>,
}

/// A part of a report; what is empty in it is not shown.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// The section's heading.
    pub title: String,
    /// A sentence or two under the title.
    pub about: String,
    /// Pictures to overlay.
    pub gallery: Option<Gallery>,
    /// Pictures of other sections, side by side.
    pub pairs: Option<Pairs>,
    /// Plots of time against error, one per metric.
    pub scatters: Vec<Scatter>,
    /// A chart of stacked bars.
    pub bars: Option<Bars>,
    /// The figures behind the pictures and plots.
    pub table: Option<Table>,
}

/// Pictures of one view, of one size, any two of which can be overlaid.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gallery {
    /// The pictures; the first is the reference that the others are held against.
    pub pictures: Vec<Picture>,
    /// The number of the picture that the page opens on, beside the first: the most instructive one;
    /// without it the second.
    pub opens_on: Option<usize>,
}

/// Pictures of two sections side by side, of one setting: such as a mode against another.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pairs {
    /// The settings; the page opens on the first, and those with fewer than two pictures are not shown.
    pub settings: Vec<PairSetting>,
}

/// A setting and the pictures in it, any two of which can stand side by side.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PairSetting {
    /// The setting's name.
    pub label: String,
    /// The pictures that can be chosen, in the order in which they are listed.
    pub pictures: Vec<PairedPicture>,
}

/// A picture that a gallery of the same report shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PairedPicture {
    /// A label that distinguishes the picture from the others of its setting: `Isosurface`.
    pub mode: String,
    /// The number of the section in the report.
    pub section: usize,
    /// The picture's label in that section's gallery.
    pub label: String,
}

/// A rendered picture, with where it is wrong.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Picture {
    /// A short name, unique in the gallery: `exact`, `step 0.5`. A [`Point`] of the
    /// same label in the same section leads to this picture.
    pub label: String,
    /// A line with the figures that matter: `12.3 ms, 4 of 2,311 hits missed`.
    pub caption: String,
    /// The bytes of a PNG file.
    pub png: Vec<u8>,
    /// Where the picture differs from the reference; the reference itself has none.
    pub error_map: Option<ErrorMap>,
}

/// The difference of a picture from the reference in false colours, with the scale to read it by.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ErrorMap {
    /// The bytes of a PNG file of the picture's size.
    pub png: Vec<u8>,
    /// The quantity that is shown: `depth error`.
    pub label: String,
    /// The quantity's unit, such as `voxels`; empty where it has none.
    pub unit: String,
    /// The colours between the smallest and the greatest error.
    pub scale: Scale,
    /// Colours outside the scale, such as missed and extra hits.
    pub marks: Vec<Mark>,
}

/// A bar of colours with figures under it. Places along it go from 0 to 1.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scale {
    /// Places and their sRGB colours, ascending; linear in sRGB between two.
    pub stops: Vec<(f64, [u8; 3])>,
    /// Places and the errors they stand for, at least at both ends.
    pub ticks: Vec<(f64, f64)>,
}

impl Scale {
    /// Colours at equal distances from `low` to `high`, with figures at both ends and the middle.
    pub fn linear(low: f64, high: f64, colors: &[[u8; 3]]) -> Self {
        let last = colors.len().saturating_sub(1).max(1) as f64;
        let stops = colors.iter().enumerate();
        Self {
            stops: stops.map(|(n, &color)| (n as f64 / last, color)).collect(),
            ticks: vec![(0.0, low), (0.5, f64::midpoint(low, high)), (1.0, high)],
        }
    }
}

/// A colour that stands for one thing, sRGB.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mark {
    /// The colour, sRGB.
    pub color: [u8; 3],
    /// What the colour stands for, such as `missed hit`.
    pub meaning: String,
}

/// Points over two logarithmic axes, less being better on both.
///
/// A y of zero (no error to the last bit) is shown on a shelf of its own under the axis. Points with
/// an x that is not positive, or a y that is negative or not finite, cannot be shown and are counted
/// under the plot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scatter {
    /// The plot's heading.
    pub title: String,
    /// The horizontal axis, such as time.
    pub x: Axis,
    /// The vertical axis, such as error.
    pub y: Axis,
    /// The settings, one point each.
    pub points: Vec<Point>,
}

/// The quantity along an axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// The name of what the axis shows, such as `time`.
    pub label: String,
    /// The quantity's unit, such as `ms`; empty where it has none.
    pub unit: String,
}

/// One setting in a [`Scatter`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Point {
    /// The setting's name, unique among the points.
    pub label: String,
    /// The family that the setting belongs to, which has one colour and shape.
    pub group: String,
    /// The place along the horizontal axis, in its unit.
    pub x: f64,
    /// The place along the vertical axis, in its unit.
    pub y: f64,
    /// Whether the setting is on the Pareto front: nothing more accurate is as fast, times within 10 %
    /// counting as equal.
    pub on_front: bool,
    /// More figures, as name and value, shown when the point is pointed at.
    pub details: Vec<(String, String)>,
}

/// Stacked horizontal bars.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bars {
    /// The chart's heading.
    pub title: String,
    /// The unit, such as `ms`.
    pub unit: String,
    /// The bars, from the top.
    pub rows: Vec<Bar>,
}

/// One bar: its parts, such as the passes of a frame, as name and length, from the left.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bar {
    /// The text beside the bar.
    pub label: String,
    /// The parts, as name and length in the chart's unit.
    pub parts: Vec<(String, f64)>,
}
