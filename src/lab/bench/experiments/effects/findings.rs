//! What the figures say, in sentences.

use super::effect::{AO, Effect, OCCLUDED_WITHIN, WIDEST_PX};
use super::measure::Tried;
use super::side_px;
use crate::lab::bench::Bench;
use crate::lab::report::figure;

/// How many times as long as without it an effect may take to be called cheap.
const CHEAP: f64 = 2.0;

/// The findings of an effect; none where nothing is seen.
pub fn of(place: &str, effect: &Effect, tried: &[Tried]) -> Vec<String> {
    let place = format!("{place}, {}", effect.name);
    let mut sentences = Vec::new();
    sentences.extend(nearest(&place, effect, tried));
    sentences.extend(by_rays(&place, tried));
    sentences.extend(tried.iter().filter_map(|one| within_bound(&place, one)));
    sentences
}

/// Which setting is nearest to the reference, and which of the cheap ones.
fn nearest(place: &str, effect: &Effect, tried: &[Tried]) -> Option<String> {
    let (without, settings) = tried.split_first()?;
    let ratio = |one: &Tried| one.times.over(&without.times);
    let error = |one: &Tried| one.error.whole();
    let least = |cheap: bool| {
        let settings = settings.iter().filter(|one| !cheap || ratio(one) <= CHEAP);
        let settings = settings.filter_map(|one| Some((one, error(one)?)));
        settings.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let said = |(one, error): (&Tried, f64)| {
        format!(
            "{} ({}, {:.2} times as long as without)",
            one.name(),
            figure(error),
            ratio(one)
        )
    };
    let mut sentence = format!(
        "{place}: the {} of {} is {} without it and least with {}",
        effect.judged_by.error_name(),
        effect.judged_by.name(),
        figure(error(without)?),
        said(least(false)?)
    );
    if settings.len() > 1 {
        sentence += &match least(true) {
            Some(cheap) => {
                format!(
                    "; of what takes at most {CHEAP} times as long the nearest is {}",
                    said(cheap)
                )
            }
            None => format!("; nothing takes at most {CHEAP} times as long"),
        };
    }
    Some(sentence)
}

/// How the error of occlusion by rays falls with their number.
fn by_rays(place: &str, tried: &[Tried]) -> Option<String> {
    let by_rays = tried.iter().filter_map(|one| {
        let rays = one.setting.strip_prefix("rays=")?.parse::<f64>().ok()?;
        (one.option.as_deref() == Some(AO)).then_some(())?;
        Some((rays, one.error.whole()?))
    });
    let by_rays: Vec<(f64, f64)> = by_rays.collect();
    let (&(few, few_error), &(many, many_error)) = (by_rays.first()?, by_rays.last()?);
    if many <= few || many_error <= 0.0 {
        return None;
    }
    let falls = few_error / many_error;
    let order = falls.ln() / (many / few).ln();
    let errors = by_rays.iter().map(|&(_, error)| figure(error));
    Some(format!(
        "{place}: from {few} to {many} rays the mean error of ao falls by a factor of {} ({}), as 1 over their number to the \
         power {order:.2}; of random rays it would be 0.5",
        figure(falls),
        errors.collect::<Vec<_>>().join(", ")
    ))
}

/// How far what is bounded is from the reference at most.
fn within_bound(place: &str, one: &Tried) -> Option<String> {
    let bound = one.setting.strip_prefix("bound=")?;
    let share = one.error.share()?;
    Some(format!(
        "{place}: what is bounded within {bound} is off by {} at most, by {} in 99 of 100 hits",
        figure(share.max?),
        figure(share.p99?)
    ))
}

/// How to read the figures.
pub fn conditions(bench: &Bench) -> [String; 3] {
    let protocol = bench.protocol().description(bench.preset);
    [
        format!(
            "occlusion and visibility are shares of light, compared at each hit: a bias above 0 is too much of them; occlusion \
             reaches {OCCLUDED_WITHIN} of the volume's radius"
        ),
        format!(
            "a lens is focused on the median depth, so wide that circles are up to {WIDEST_PX} pixels wide; rmse is of \
             sRGB-encoded colours, in focus, before and behind the focal plane, and beside what the pinhole sees"
        ),
        format!(
            "times are {protocol}, each setting in turn with the picture without the effect: pictures of {0}x{0} pixels, on {1}",
            side_px(bench.preset),
            bench.device.info().name
        ),
    ]
}
