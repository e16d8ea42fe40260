//! A mode's part of the report.

use crate::frame::error::ErrorMap;
use crate::lab::measure::RankingMetric;
use crate::lab::report::{
    Axis, Bar, Bars, Gallery, PairSetting, PairedPicture, Pairs, Point, Scatter, Section, figure,
};
use crate::scene::Mode;

use super::columns::short_table;
use super::look::Look;
use super::mode::name_of;
use super::row::Row;

/// A mode's pictures, the reference first, its plots and its table.
pub fn section(
    (mode, look): (Mode, Option<Look>),
    about: String,
    rows: &[Row],
    gallery: Gallery,
) -> Section {
    Section {
        title: match look {
            Some(look) => format!("{}, {look}", title(mode)),
            None => title(mode).into(),
        },
        about,
        gallery: Some(gallery),
        pairs: None,
        scatters: RankingMetric::of_mode(mode)
            .iter()
            .map(|metric| scatter(metric, rows))
            .filter(|scatter| !scatter.points.is_empty())
            .collect(),
        bars: bars(rows),
        table: Some(short_table(rows)),
    }
}

/// The number of the row to open on beside the reference, from the pictured rows and their error maps:
/// the fastest whose map shows something, else the fastest.
pub fn opening_row<'a>(pictured: impl Iterator<Item = (&'a Row, &'a ErrorMap)>) -> Option<usize> {
    let rank = |(at, (row, map)): (usize, (&Row, &ErrorMap))| {
        let ms = row.frame_ms().unwrap_or(f64::INFINITY);
        (at, !map.shows_something(), ms)
    };
    let ranked = pictured.enumerate().map(rank);
    let first = ranked.min_by(|a, b| a.1.cmp(&b.1).then(a.2.total_cmp(&b.2)));
    first.map(|(at, ..)| at)
}

/// The modes against each other: what pictures of at least two sections are of one setting.
pub fn side_by_side(sections: &[Section]) -> Option<Section> {
    let mut settings: Vec<PairSetting> = Vec::new();
    for (at, section) in sections.iter().enumerate() {
        for picture in section.gallery.iter().flat_map(|gallery| &gallery.pictures) {
            let shown = PairedPicture {
                mode: section.title.clone(),
                section: at,
                label: picture.label.clone(),
            };
            match settings.iter_mut().find(|one| one.label == picture.label) {
                Some(setting) => setting.pictures.push(shown),
                None => settings.push(PairSetting {
                    label: picture.label.clone(),
                    pictures: vec![shown],
                }),
            }
        }
    }
    settings.retain(|setting| setting.pictures.len() > 1);
    // The sort is stable: of as many modes, in the order in which they are met.
    settings.sort_by_key(|setting| std::cmp::Reverse(setting.pictures.len()));
    (!settings.is_empty()).then(|| Section {
        title: "Modes side by side".into(),
        about: "One setting in two modes, from the same place.".into(),
        pairs: Some(Pairs { settings }),
        ..Section::default()
    })
}

fn title(mode: Mode) -> &'static str {
    match mode {
        Mode::Iso => "Isosurface",
        Mode::Mip => "Maximum intensity projection",
        Mode::Lmip => "Local maximum intensity projection",
        Mode::Minip => "Minimum intensity projection",
        Mode::Mean => "Mean intensity projection",
        Mode::Dvr => "Emission and absorption",
    }
}

fn scatter(metric: &RankingMetric, rows: &[Row]) -> Scatter {
    let point = |row: &Row| {
        Some(Point {
            label: row.title(),
            group: row.family.clone(),
            x: row.frame_ms()?,
            y: metric.of(row.error.as_ref()?)?,
            on_front: row.on_front.contains(&metric.key),
            details: details(row),
        })
    };
    Scatter {
        title: format!("Time against {}", metric.title),
        x: Axis {
            label: "time of a frame".into(),
            unit: "ms".into(),
        },
        y: Axis {
            label: metric.title.into(),
            unit: metric.unit.into(),
        },
        points: rows.iter().filter_map(point).collect(),
    }
}

/// The details of a point: the row's figures as its table shows them.
fn details(row: &Row) -> Vec<(String, String)> {
    let table = short_table(std::slice::from_ref(row));
    let mut details = table.named(0);
    if let Some(frame) = row.times_ms.frame {
        details.push((
            "spread".into(),
            format!("± {:.2} ms over {} frames", frame.mad, row.times_ms.repeats),
        ));
    }
    if !row.flags.is_empty() {
        details.push(("flags".into(), row.flags.clone()));
    }
    details
}

/// The passes of the rows whose passes are known.
fn bars(rows: &[Row]) -> Option<Bars> {
    let bar = |row: &Row| Bar {
        label: row.title(),
        parts: row
            .passes
            .iter()
            .map(|pass| (pass.name.clone(), pass.ms))
            .collect(),
    };
    let rows: Vec<Bar> = rows
        .iter()
        .filter(|row| !row.passes.is_empty())
        .map(bar)
        .collect();
    (!rows.is_empty()).then(|| Bars {
        title: "Passes of a frame, on the device's clock".into(),
        unit: "ms".into(),
        rows,
    })
}

/// A picture's caption: its time, and its error by the first metric.
pub fn caption(mode: Mode, row: &Row) -> String {
    let mut parts = Vec::new();
    if let Some(ms) = row.frame_ms() {
        parts.push(format!("{ms:.1} ms"));
    }
    if let Some(error) = &row.error {
        if let Some(depth) = error.depth {
            parts.push(format!(
                "{} of {} hits missed, {} added",
                depth.missed, depth.reference_hits, depth.extra
            ));
        }
        let first = RankingMetric::of_mode(mode).iter();
        let first = first.filter(|metric| metric.key != "wrong_hits").take(1);
        for metric in first {
            if let Some(wrong) = metric.of(error) {
                parts.push(format!(
                    "{} {} {}",
                    metric.title,
                    figure(wrong),
                    metric.unit
                ));
            }
        }
    }
    parts.extend(row.remark().map(str::to_owned));
    parts.join(" · ")
}

/// The settings on the front of the first metric, fastest first.
pub fn finding((mode, look): (Mode, Option<Look>), rows: &[Row]) -> Option<String> {
    let metric = RankingMetric::of_mode(mode).first()?;
    let mut front: Vec<(f64, f64, String)> = rows
        .iter()
        .filter(|row| row.on_front.contains(&metric.key))
        .filter_map(|row| {
            let wrong = metric.of(row.error.as_ref()?)?;
            Some((row.frame_ms()?, wrong, row.title()))
        })
        .collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let settings = front
        .iter()
        .map(|(ms, wrong, name)| format!("{name} ({} ms, {})", figure(*ms), figure(*wrong)));
    let settings = settings.collect::<Vec<_>>().join(", ");
    (!front.is_empty()).then(|| {
        format!(
            "{}: on the Pareto front, nothing more accurate being as fast, with ms and {} ({}): \
             {settings}",
            name_of(mode, look),
            metric.title,
            metric.unit
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::ImageSize;
    use crate::frame::error::{Entry, Quantity};

    #[test]
    fn a_report_opens_on_the_fastest_whose_error_can_be_seen() {
        let map = |entry: Entry| ErrorMap {
            quantity: Quantity::Depth,
            size: ImageSize::new(1, 1).unwrap(),
            entries: vec![entry],
            scale: 1.0,
        };
        let row = |ms: f64| {
            let mut row = Row::new((Mode::Iso, None), "a", "angioray");
            row.timed(&[crate::lab::measure::FrameTime {
                frame_ms: ms,
                processor_ms: None,
                render_ms: ms,
                passes: Vec::new(),
            }]);
            row
        };
        let opened = |all: &[(f64, Entry)]| {
            let all = all.iter().map(|&(ms, entry)| (row(ms), map(entry)));
            let all: Vec<(Row, ErrorMap)> = all.collect();
            opening_row(all.iter().map(|(row, map)| (row, map)))
        };
        let (seen, unseen) = (Entry::Difference(-0.5), Entry::Difference(0.01));
        assert_eq!(opened(&[(3.0, seen), (1.0, unseen), (2.0, seen)]), Some(2));
        assert_eq!(
            opened(&[(3.0, Entry::Missed), (1.0, Entry::Nothing)]),
            Some(0)
        );
        assert_eq!(opened(&[(3.0, Entry::Extra), (1.0, unseen)]), Some(0));
        // The control: where no map shows anything the fastest is as good as any.
        assert_eq!(opened(&[(3.0, unseen), (1.0, unseen)]), Some(1));
        assert_eq!(opened(&[]), None);
    }
}
