//! One setting for several views of a scene.

use super::{Choice, Contender, Cost, Evidence, Search, Task, Verified, candidates, choose};
use crate::error::Result;
use crate::progress::{Progress, UNKNOWN_TOTAL};
use crate::render::Renderer;
use crate::scene::Setting;
use crate::tolerance::deviation::Deviation;

/// How a setting that was chosen in one view does in another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// Its number among the views.
    pub view: usize,
    pub met: bool,
    /// In the metric's unit.
    pub estimate: f64,
    /// The error is at most this (psnr: at least) with [`CONFIDENCE`](super::CONFIDENCE).
    pub upper: f64,
    pub verified: Verified,
}

/// Chooses in the first view, and verifies in the others. Where one is beyond the bound the choice
/// is made anew in that view; where that does not hold everywhere either, the surest setting is
/// taken. The choice's `met` is that of all views, its cost all that it took.
///
/// # Errors
/// As [`choose`]. No views.
pub fn choose_for_views(
    views: &[Task],
    renderer: &mut Renderer,
    progress: &dyn Progress,
) -> Result<(Choice, Vec<Check>)> {
    let mut cost = Cost::default();
    let mut decided_by = vec![0];
    loop {
        let deciding = decided_by[decided_by.len() - 1];
        let mut choice = choose(&views[deciding], renderer, progress)?;
        cost = sum(cost, choice.cost);
        progress.begin("verifying", UNKNOWN_TOTAL);
        let mut checks = Vec::new();
        let mut beyond = None;
        for view in (0..views.len()).filter(|&view| view != deciding) {
            let check = check(view, &views[view], &choice.setting, renderer, &mut cost)?;
            checks.push(check);
            if !check.met {
                beyond = Some(view);
                break;
            }
        }
        progress.end();
        match beyond {
            Some(view) if choice.met && !decided_by.contains(&view) => decided_by.push(view),
            Some(_) => {
                let surest = candidates(views[0].options.mode())?.pop();
                if let Some(surest) = surest {
                    let own = views[deciding].options.how().undecided();
                    let contender = Contender::new(&surest, &own, &views[deciding])?;
                    checks = (0..views.len())
                        .map(|view| {
                            check(view, &views[view], &contender.setting, renderer, &mut cost)
                        })
                        .collect::<Result<_>>()?;
                    let own_check = checks.remove(deciding);
                    choice = Choice {
                        setting: contender.setting,
                        resolved: contender.resolved,
                        met: own_check.met && checks.iter().all(|check| check.met),
                        estimate: own_check.estimate,
                        upper: own_check.upper,
                        verified: own_check.verified,
                        ..choice
                    };
                }
                return Ok((Choice { cost, ..choice }, checks));
            }
            None => return Ok((Choice { cost, ..choice }, checks)),
        }
    }
}

/// A setting in a view that had no say in choosing it.
fn check(
    view: usize,
    task: &Task,
    setting: &Setting,
    renderer: &mut Renderer,
    cost: &mut Cost,
) -> Result<Check> {
    let began = std::time::Instant::now();
    let own = task.options.how().undecided();
    let mut contenders = vec![Contender::new(setting, &own, task)?];
    if let Some(surest) = candidates(task.options.mode())?.pop() {
        contenders.push(Contender::new(&surest, &own, task)?);
    }
    let deviation = Deviation::new(task.bound, task.volume)?;
    let mut search = Search {
        task,
        deviation,
        renderer,
        contenders,
        cost: Cost::default(),
    };
    let surest_scene = search.contenders[search.surest()].resolved.scene.clone();
    let frame = search.surest_frame()?;
    let mut evidence = Evidence::new(deviation, task.volume, &surest_scene, frame, task.seed)?;
    let rays = search.rays();
    let found = search.verify(0, &mut evidence, rays)?;
    search.cost.rays = evidence.rays();
    search.cost.ms = began.elapsed().as_secs_f64() * 1e3;
    *cost = sum(*cost, search.cost);
    Ok(Check {
        view,
        met: found.met,
        estimate: deviation.shown(found.judgement.figure),
        upper: deviation.shown(found.judgement.upper),
        verified: found.verified,
    })
}

fn sum(a: Cost, b: Cost) -> Cost {
    Cost {
        ms: a.ms + b.ms,
        rays: a.rays + b.rays,
        renderings: a.renderings + b.renderings,
        build_ms: a.build_ms + b.build_ms,
        upload_ms: a.upload_ms + b.upload_ms,
        uploaded_bytes: a.uploaded_bytes + b.uploaded_bytes,
    }
}
