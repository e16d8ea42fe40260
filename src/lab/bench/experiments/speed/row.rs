//! The rows of the table.

use super::timing::{Runner, TimedRow};
use crate::lab::measure::RankingMetric;
use crate::lab::report::{Cell, Shown, Table};

type Columns<const N: usize> = [(&'static str, &'static str, Shown); N];

const COLUMNS: Columns<20> = [
    ("volume", "volume", Shown::Short),
    ("picture", "picture", Shown::Short),
    ("renderer", "renderer", Shown::Short),
    ("mode", "mode", Shown::Short),
    ("setting", "setting", Shown::Short),
    ("frames", "frames", Shown::Fixed(0)),
    ("min_ms", "ms, min", Shown::Fixed(2)),
    ("median_ms", "median", Shown::Fixed(2)),
    ("cpu_min_ms", "CPU ms, min", Shown::Fixed(2)),
    ("cpu_median_ms", "median", Shown::Fixed(2)),
    ("cpu_over_cores_ms", "over cores", Shown::Fixed(2)),
    (
        "outside_cast_share",
        "outside the cast, %",
        Shown::Percent(1),
    ),
    ("samples", "samples", Shown::Fixed(0)),
    ("megasamples_per_s", "million a second", Shown::Fixed(1)),
    ("roofline_share", "of sampling alone, %", Shown::Percent(1)),
    ("error", "error, %", Shown::Percent(4)),
    ("of", "of what", Shown::Short),
    ("color_rmse", "colour rmse, %", Shown::Percent(4)),
    ("color_max", "colour max, %", Shown::Percent(3)),
    ("note", "note", Shown::Short),
];

/// The columns beside them when there is a peer.
const BESIDE: Columns<4> = [
    ("peer", "beside", Shown::Short),
    ("peer_setting", "its setting", Shown::Short),
    ("cpu_ratio", "CPU, ours to its", Shown::Fixed(3)),
    ("wall_ratio", "wall", Shown::Fixed(3)),
];

/// The table, without rows yet.
pub fn table(with_peer: bool) -> Table {
    match with_peer {
        true => Table::new(&[&COLUMNS[..], &BESIDE].concat()),
        false => Table::new(&COLUMNS),
    }
}

/// How many threads run at once here, by which processor time is divided.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Our times divided by the peer's, for frames that show the same: medians of the ratio of each round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratios {
    pub cpu: Option<f64>,
    pub wall: f64,
}

/// The peer's row that shows what `row`, one of ours, does, and the ratios to it.
pub fn beside<'a>(row: &TimedRow, rows: &'a [TimedRow]) -> Option<(&'a TimedRow, Ratios)> {
    let is_peer = |other: &&TimedRow| matches!(other.runner, Runner::Peer(_));
    let peer = rows
        .iter()
        .filter(is_peer)
        .find(|other| row.runner == Runner::Ours && other.kind == row.kind)?;
    let cpu = row.processor_ms().zip(peer.processor_ms());
    let ratios = Ratios {
        cpu: cpu.map(|(own, other)| own.over(&other)),
        wall: row.frame_ms().over(&peer.frame_ms()),
    };
    Some((peer, ratios))
}

/// The renderer of a row's frames, by name.
pub fn renderer(row: &TimedRow) -> &str {
    match &row.runner {
        Runner::Ours => "angioray",
        Runner::Sampling => "sampling alone",
        Runner::Peer(name) => name,
    }
}

/// Appends the rows of one picture size.
pub fn tabulate(table: &mut Table, volume: &str, side_px: u32, rows: &[TimedRow]) {
    let max = rows.iter().find(|row| row.runner == Runner::Sampling);
    for row in rows {
        let (frame, cpu) = (row.frame_ms(), row.processor_ms());
        let cpu_median_ms = cpu.as_ref().map(|cpu| cpu.median_ms());
        let first = row.kind.map(|kind| &RankingMetric::of_mode(kind.mode())[0]);
        let mut cells: Vec<Cell> = vec![
            volume.into(),
            format!("{side_px}x{side_px}").into(),
            renderer(row).into(),
            row.kind.map_or("straight rays", |kind| kind.name()).into(),
            row.setting.as_str().into(),
            (row.taken.len() as u64).into(),
            frame.min_ms().into(),
            frame.median_ms().into(),
            cpu.as_ref().map(|cpu| cpu.min_ms()).into(),
            cpu_median_ms.into(),
            cpu_median_ms.map(|ms| ms / cores() as f64).into(),
            row.outside_cast().into(),
            row.samples.into(),
            row.samples_per_s().map(|rate| 1e-6 * rate).into(),
            max.and_then(|max| row.share_of(max)).into(),
            row.error.and_then(|error| error.first).into(),
            first.map(|first| first.title).into(),
            row.error.and_then(|error| error.color_rmse).into(),
            row.error.and_then(|error| error.color_max).into(),
            row.note.clone().into(),
        ];
        if let Some((peer, ratios)) = beside(row, rows) {
            cells.extend([
                renderer(peer).into(),
                peer.setting.as_str().into(),
                ratios.cpu.into(),
                ratios.wall.into(),
            ]);
        }
        table.push(cells);
    }
}
