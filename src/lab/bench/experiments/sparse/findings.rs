//! What the figures say, in sentences.

use super::measure::{WRONG_DEPTH_VOXELS, WayRow};
use super::neighbours::MARGIN_VOXELS;
use super::way::Family;
use crate::lab::bench::{Bench, Protocol};

/// The findings of a picture: a sentence a family.
pub fn of(place: &str, measured: &[(Protocol, Vec<WayRow>)]) -> Vec<String> {
    let Some((_, rows)) = measured.first() else {
        return Vec::new();
    };
    let mut families: Vec<Family> = rows.iter().map(|row| row.family).collect();
    families.dedup();
    let families = families.into_iter();
    let families = families.filter(|family| !matches!(family, Family::Whole | Family::OneByOne));
    families
        .map(|family| sentence(place, family, measured))
        .collect()
}

fn sentence(place: &str, family: Family, measured: &[(Protocol, Vec<WayRow>)]) -> String {
    let of_family = |rows: &'_ [WayRow]| -> Vec<WayRow> {
        rows.iter()
            .filter(|row| row.family == family)
            .cloned()
            .collect()
    };
    let rows = of_family(&measured[0].1);
    let percents = |share: fn(&WayRow) -> Option<f64>| {
        let each = rows.iter().map(|row| match share(row) {
            Some(share) => format!("{:.2}", 100.0 * share),
            None => "none".into(),
        });
        each.collect::<Vec<_>>().join(", ")
    };
    let settings = rows.iter().filter_map(WayRow::setting);
    let mut text = format!(
        "{place}: {} at {} casts {} % of the rays and loses {} % of the vessels' pixels",
        family.name(),
        settings.collect::<Vec<_>>().join(", "),
        percents(|row| Some(row.rays_share)),
        percents(|row| row.lost.lost_share())
    );
    if rows.iter().any(|row| row.lost.displaced.is_some()) {
        let shares = percents(|row| row.lost.displaced_share());
        text += &format!(", and shows {shares} % of them at another depth");
    }
    for (protocol, all) in measured {
        let ratio = |row: &WayRow| format!("{:.2}", row.times.over(&all[row.base].times));
        let ratios: Vec<String> = of_family(all).iter().map(ratio).collect();
        text += &format!(
            "; it takes {} times as long ({protocol})",
            ratios.join(", ")
        );
    }
    text
}

/// Why the experiment failed: what certified promises does not hold.
pub fn failure(place: &str, measured: &[(Protocol, Vec<WayRow>)]) -> Option<String> {
    let mut rows = measured.iter().flat_map(|(_, rows)| rows);
    let wrong = rows.find(|row| {
        let lost = row.lost;
        let wrong = lost.lost + lost.extra + lost.displaced.unwrap_or(0);
        row.family == Family::Certified && wrong > 0
    })?;
    Some(format!(
        "{place}: {} lost {} pixels, invented {}, displaced {}",
        wrong.name(),
        wrong.lost.lost,
        wrong.lost.extra,
        wrong.lost.displaced.unwrap_or(0)
    ))
}

/// How to read the figures.
pub fn conditions(bench: &Bench, protocols: &[Protocol]) -> [String; 3] {
    let protocols = protocols.iter();
    let protocols = protocols.map(|protocol| protocol.description(bench.preset));
    [
        format!(
            "lost, extra and displaced pixels (by more than {WRONG_DEPTH_VOXELS} voxel) and colours are compared with a \
             ray in every pixel, where the camera is first; in mip a pixel shows a vessel where its maximum reaches the \
             surface's value"
        ),
        format!(
            "a ray from its neighbours' depth (Belyaev et al. 2018) begins {MARGIN_VOXELS} voxels before the nearest hit \
             of the four coarse rays around it, and is a whole ray where none of them hit; its times are the cast's \
             alone, of both passes, beside those of whole rays by the same caster"
        ),
        format!(
            "times are {}: pictures of {1}x{1} pixels",
            protocols.collect::<Vec<_>>().join(", or "),
            bench.preset.side_px()
        ),
    ]
}
