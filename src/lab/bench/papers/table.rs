//! The table of cases beside their papers.

use crate::lab::bench::{Bench, Conditions, Outcome};
use crate::lab::report::{Cell, Shown, Table};

use super::Measurement;

/// The errors that a table shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Errors {
    Surface,
    Light,
}

/// The outcome of cases beside their papers, its table still empty.
pub fn outcome(bench: &Bench, series: &'static str, errors: Errors) -> Outcome {
    Outcome {
        conditions: Conditions::usual(bench),
        ..Outcome::of(table(series, errors))
    }
}

/// The columns of cases beside their papers.
fn table(series: &'static str, errors: Errors) -> Table {
    let mut columns = vec![
        ("volume", "volume", Shown::Short),
        ("case", series, Shown::Short),
        ("way", "method", Shown::Short),
        ("min_ms", "ms, min", Shown::Fixed(2)),
        ("median_ms", "median", Shown::Fixed(2)),
        ("p95_ms", "p95", Shown::Fixed(2)),
        ("fps", "fps", Shown::Fixed(1)),
        ("speedup", "ours ×", Shown::Fixed(2)),
        ("paper_fps", "paper fps", Shown::Fixed(2)),
        ("paper_speedup", "paper ×", Shown::Fixed(2)),
    ];
    columns.extend(match errors {
        Errors::Surface => [
            ("missed_share", "missed hits, %", Shown::Percent(3)),
            ("extra_share", "extra hits, %", Shown::Percent(3)),
            ("depth_mean_voxels", "depth mean, voxels", Shown::Short),
            ("depth_p99_voxels", "depth p99", Shown::Short),
            ("depth_max_voxels", "depth max", Shown::Short),
        ]
        .as_slice(),
        Errors::Light => [
            ("rmse", "colour rmse, %", Shown::Percent(4)),
            ("max", "colour max, %", Shown::Percent(3)),
            ("ssim", "ssim", Shown::Fixed(4)),
            ("flip", "flip", Shown::Fixed(4)),
        ]
        .as_slice(),
    });
    columns.extend([
        ("samples_per_ray", "samples a ray", Shown::Fixed(1)),
        ("nodes_per_ray", "nodes a ray", Shown::Fixed(1)),
        ("same_bytes", "same bytes", Shown::Short),
    ]);
    Table::new(&columns)
}

/// How many times as fast as the first of a group each is here, and in the paper.
pub fn speedups(group: &[Measurement]) -> impl Iterator<Item = (f64, Option<f64>)> {
    group.iter().map(|one| {
        let in_fps = one.paper.fps.zip(group[0].paper.fps);
        let paper = in_fps.map(|(own, first)| own / first);
        (group[0].times.over(&one.times), paper.or(one.paper.speedup))
    })
}

/// The share of the hits that a case misses, for a sentence.
pub fn percent_missed(measured: &Measurement) -> String {
    match measured.surface.and_then(|surface| surface.missed_share) {
        Some(share) => format!("{:.2} %", 100.0 * share),
        None => "none (there are no hits)".into(),
    }
}

/// Appends a group's rows; a picture that should equal another and does not is the outcome's failure.
pub fn tabulate(outcome: &mut Outcome, volume: &str, series: &str, group: &[Measurement]) {
    for (one, (ours, paper)) in group.iter().zip(speedups(group)) {
        let times = &one.times;
        let mut row: Vec<Cell> = vec![
            volume.into(),
            series.into(),
            one.name.as_str().into(),
            times.min_ms().into(),
            times.median_ms().into(),
            times.p95_ms().into(),
            (1e3 / times.median_ms()).into(),
            ours.into(),
            one.paper.fps.into(),
            paper.into(),
        ];
        if let Some(surface) = &one.surface {
            row.extend([
                surface.missed_share.into(),
                surface.extra_share.into(),
                surface.depth_mean.into(),
                surface.depth_p99.into(),
                surface.depth_max.into(),
            ]);
        }
        if let Some(light) = &one.light {
            row.extend([
                light.rmse.into(),
                light.max.into(),
                light.ssim.into(),
                light.flip.into(),
            ]);
        }
        row.extend([
            one.samples.into(),
            one.nodes.into(),
            Cell::from(one.same.map(|same| if same { "yes" } else { "no" })),
        ]);
        outcome.table.push(row);
        if one.same == Some(false) {
            outcome.failure = Some(format!(
                "{volume}, {series}: '{}' gives another picture",
                one.name
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::measurement::LightError;
    use super::super::{Paper, SurfaceError};
    use super::*;

    /// A case of so many ms a frame.
    fn measured(name: &str, ms: f64, paper: Paper, same: Option<bool>) -> Measurement {
        Measurement {
            name: name.into(),
            paper,
            times: [ms, ms, ms].into_iter().collect(),
            samples: 3.0,
            nodes: 2.0,
            same,
            surface: None,
            light: Some(LightError {
                rmse: 0.01,
                max: 0.02,
                ssim: None,
                flip: None,
            }),
        }
    }

    fn fps(fps: f64) -> Paper {
        Paper {
            fps: Some(fps),
            speedup: None,
        }
    }

    fn tabulated(group: &[Measurement]) -> Outcome {
        let mut outcome = Outcome::of(table("case", Errors::Light));
        tabulate(&mut outcome, "tree", "dvr", group);
        outcome
    }

    #[test]
    fn cases_are_compared_with_the_first_and_with_their_papers() {
        let faster = Paper {
            fps: None,
            speedup: Some(1.2),
        };
        let group = [
            measured("first", 6.0, fps(10.0), None),
            measured("second", 2.0, fps(25.0), Some(true)),
            measured("third", 3.0, faster, Some(true)),
            measured("own", 12.0, Paper::default(), None),
        ];
        let expected = [
            (1.0, Some(1.0)),
            (3.0, Some(2.5)),
            (2.0, Some(1.2)),
            (0.5, None),
        ];
        assert_eq!(speedups(&group).collect::<Vec<_>>(), expected);
        let outcome = tabulated(&group);
        assert_eq!(outcome.failure, None);
        let rows = outcome.table.json();
        assert_eq!(rows[1]["median_ms"], 2.0);
        assert_eq!(rows[1]["fps"], 500.0);
        assert_eq!(rows[1]["rmse"], 0.01);
        assert_eq!(rows[1]["same_bytes"], "yes");
        assert_eq!(rows[3]["same_bytes"], serde_json::Value::Null);
    }

    #[test]
    fn a_picture_that_is_another_is_the_failure() {
        let group = [
            measured("first", 6.0, Paper::default(), None),
            measured("second", 2.0, Paper::default(), Some(false)),
            measured("third", 2.0, Paper::default(), Some(true)),
        ];
        let outcome = tabulated(&group);
        let failure = outcome.failure.as_deref();
        assert_eq!(failure, Some("tree, dvr: 'second' gives another picture"));
        assert_eq!(outcome.table.json()[1]["same_bytes"], "no");
    }

    #[test]
    fn where_nothing_is_hit_no_share_is_missed() {
        let mut one = measured("first", 6.0, Paper::default(), None);
        assert_eq!(percent_missed(&one), "none (there are no hits)");
        one.surface = Some(SurfaceError {
            missed_share: Some(0.125),
            extra_share: None,
            depth_mean: None,
            depth_p99: None,
            depth_max: None,
        });
        assert_eq!(percent_missed(&one), "12.50 %");
    }
}
