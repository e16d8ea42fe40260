//! The rows as tables: all figures for programs, those that matter for people.

use crate::lab::report::{Cell, Shown, Table};

use crate::frame::error::Figures;
use crate::scene::Mode;

use super::row::Row;

/// Key, title, form, and the figure of a row.
type Column = (&'static str, &'static str, Shown, fn(&Row) -> Cell);

/// Every figure, unit in the key; those for programs alone have titles that no table shows.
const ALL: &[Column] = &[
    ("mode", "mode", Shown::Short, |row| row.of_mode().into()),
    ("setting", "setting", Shown::Short, |row| {
        row.setting.as_str().into()
    }),
    ("renderer", "renderer", Shown::Short, |row| {
        row.renderer.as_str().into()
    }),
    ("flags", "flags", Shown::Short, |row| {
        row.flags.as_str().into()
    }),
    ("family", "family", Shown::Short, |row| {
        row.family.as_str().into()
    }),
    ("failure", "failure", Shown::Short, |row| {
        row.failure.clone().into()
    }),
    ("note", "note", Shown::Short, |row| row.note.clone().into()),
    ("repeats", "repeats", Shown::Fixed(0), |row| {
        (row.times_ms.repeats as u64).into()
    }),
    FRAME_MS,
    ("frame_mad_ms", "± ms", Shown::Fixed(2), |row| {
        row.times_ms.frame.map(|spread| spread.mad).into()
    }),
    ("frame_min_ms", "ms, min", Shown::Fixed(2), |row| {
        row.times_ms.frame.map(|spread| spread.min).into()
    }),
    PROCESSOR_MS,
    ("render_median_ms", "passes, ms", Shown::Fixed(2), |row| {
        row.times_ms.render.map(|spread| spread.median).into()
    }),
    ("render_mad_ms", "± ms", Shown::Fixed(2), |row| {
        row.times_ms.render.map(|spread| spread.mad).into()
    }),
    ("render_min_ms", "passes, min", Shown::Fixed(2), |row| {
        row.times_ms.render.map(|spread| spread.min).into()
    }),
    ("upload_ms", "upload, ms", Shown::Fixed(1), |row| {
        row.times_ms.upload.into()
    }),
    ("build_ms", "build, ms", Shown::Fixed(1), |row| {
        row.times_ms.build.into()
    }),
    ("classify_ms", "classify, ms", Shown::Fixed(2), |row| {
        row.times_ms.classify.into()
    }),
    ("gradient_ms", "gradients, ms", Shown::Fixed(2), |row| {
        row.times_ms.gradient.into()
    }),
    ("prepare_ms", "prepare, ms", Shown::Fixed(1), |row| {
        row.times_ms.prepare.into()
    }),
    ("encode_ms", "encode, ms", Shown::Fixed(1), |row| {
        row.times_ms.encode.into()
    }),
    RMSE,
    MAX,
    ("p99", "p99", Shown::Short, |row| {
        row.error.and_then(|e| Some(e.color?.p99)).into()
    }),
    ("psnr_db", "PSNR, dB", Shown::Fixed(1), |row| {
        let psnr = row.error.and_then(|e| Some(e.color?.psnr_db));
        psnr.filter(|db| db.is_finite()).into()
    }),
    SSIM,
    FLIP,
    ("reference_hits", "hits", Shown::Fixed(0), |row| {
        row.error.and_then(|e| Some(e.depth?.reference_hits)).into()
    }),
    MISSED,
    EXTRA,
    ("missed_share", "missed, %", Shown::Percent(3), |row| {
        row.error.and_then(|e| e.depth?.missed_share()).into()
    }),
    ("extra_share", "extra, %", Shown::Percent(3), |row| {
        row.error.and_then(|e| e.depth?.extra_share()).into()
    }),
    ("depth_mean_voxels", "depth mean", Shown::Short, |row| {
        row.error.and_then(|e| e.depth?.mean).into()
    }),
    DEPTH_P99,
    (
        "depth_max_voxels",
        "depth max, voxels",
        Shown::Short,
        |row| row.error.and_then(|e| e.depth?.max).into(),
    ),
    ("normal_mean_deg", "normal mean, °", Shown::Short, |row| {
        row.error.and_then(|e| e.normal?.mean_deg).into()
    }),
    ("normal_p99_deg", "normal p99, °", Shown::Short, |row| {
        row.error.and_then(|e| e.normal?.p99_deg).into()
    }),
    (
        "value_mean_share",
        "value mean, %",
        Shown::Percent(4),
        |row| row.error.and_then(|e| e.value?.mean).into(),
    ),
    ("value_missed", "not covered", Shown::Fixed(0), |row| {
        row.error.and_then(|e| Some(e.value?.missed)).into()
    }),
    ("value_extra", "covered besides", Shown::Fixed(0), |row| {
        row.error.and_then(|e| Some(e.value?.extra)).into()
    }),
    VALUE_RMSE,
    (
        "value_p99_share",
        "value p99, %",
        Shown::Percent(4),
        |row| row.error.and_then(|e| e.value?.p99).into(),
    ),
    VALUE_MAX,
    OCCLUSION_MEAN,
    ("occlusion_p99", "occlusion p99", Shown::Fixed(4), |row| {
        row.error.and_then(|e| e.occlusion?.p99).into()
    }),
    OCCLUSION_BIAS,
    VISIBILITY_MEAN,
    ("visibility_p99", "visibility p99", Shown::Fixed(4), |row| {
        row.error.and_then(|e| e.visibility?.p99).into()
    }),
    VISIBILITY_BIAS,
    FOCUSED_RMSE,
    NEAR_RMSE,
    FAR_RMSE,
    BESIDE_RMSE,
    SILHOUETTE,
    ("rays", "rays", Shown::Fixed(0), |row| {
        row.counts.map(|c| c.rays).into()
    }),
    ("samples", "samples", Shown::Fixed(0), |row| {
        row.counts.map(|c| c.samples).into()
    }),
    ("nodes", "nodes", Shown::Fixed(0), |row| {
        row.counts.map(|c| c.nodes).into()
    }),
    ("hits", "hits", Shown::Fixed(0), |row| {
        row.counts.map(|c| c.hits).into()
    }),
    SAMPLES_PER_RAY,
    NODES_PER_RAY,
    ("host_peak_bytes", "host, bytes", Shown::Fixed(0), |row| {
        row.memory.and_then(|memory| memory.host_peak_bytes).into()
    }),
    ("device_bytes", "device, bytes", Shown::Fixed(0), |row| {
        row.memory.map(|memory| memory.device_bytes).into()
    }),
    (
        "uploaded_bytes",
        "uploaded, bytes",
        Shown::Fixed(0),
        |row| row.memory.map(|memory| memory.uploaded_bytes).into(),
    ),
    ("on_front", "front", Shown::Short, |row| {
        row.on_front.join(" ").into()
    }),
    ("png", "picture", Shown::Short, |row| {
        row.files.as_ref().map(|files| files.png.clone()).into()
    }),
];

const FRAME_MS: Column = ("frame_median_ms", "ms", Shown::Fixed(2), |row| {
    row.frame_ms().into()
});
const PROCESSOR_MS: Column = ("processor_median_ms", "CPU ms", Shown::Fixed(2), |row| {
    row.times_ms.processor.into()
});
const RMSE: Column = ("rmse", "colour rmse, %", Shown::Percent(4), |row| {
    row.error.and_then(|e| Some(e.color?.rmse)).into()
});
const MAX: Column = ("max", "colour max, %", Shown::Percent(3), |row| {
    row.error.and_then(|e| Some(e.color?.max)).into()
});
const SSIM: Column = ("ssim", "SSIM", Shown::Fixed(5), |row| {
    row.error.and_then(|e| e.ssim).into()
});
const FLIP: Column = ("flip", "FLIP", Shown::Short, |row| {
    row.error.and_then(|e| e.flip).into()
});
/// The share of wrong hits, by which surfaces are ranked, in the findings and plots too.
const WRONG_HITS: Column = (
    "wrong_hits_share",
    "missed or added, %",
    Shown::Percent(3),
    |row| row.error.and_then(|e| e.depth?.wrong_share()).into(),
);
const MISSED: Column = ("missed", "missed", Shown::Fixed(0), |row| {
    row.error.and_then(|e| Some(e.depth?.missed)).into()
});
const EXTRA: Column = ("extra", "extra", Shown::Fixed(0), |row| {
    row.error.and_then(|e| Some(e.depth?.extra)).into()
});
const DEPTH_P99: Column = (
    "depth_p99_voxels",
    "depth p99, voxels",
    Shown::Short,
    |row| row.error.and_then(|e| e.depth?.p99).into(),
);
const VALUE_RMSE: Column = (
    "value_rmse_share",
    "value rmse, %",
    Shown::Percent(4),
    |row| row.error.and_then(|e| e.value?.rmse).into(),
);
const VALUE_MAX: Column = (
    "value_max_share",
    "value max, %",
    Shown::Percent(4),
    |row| row.error.and_then(|e| e.value?.max).into(),
);
const OCCLUSION_MEAN: Column = ("occlusion_mean", "occlusion mean", Shown::Fixed(4), |row| {
    row.error.and_then(|e| e.occlusion?.mean).into()
});
/// Above 0 where the picture is too dark.
const OCCLUSION_BIAS: Column = ("occlusion_bias", "occlusion bias", Shown::Fixed(4), |row| {
    row.error.and_then(|e| e.occlusion?.bias).into()
});
const VISIBILITY_MEAN: Column = (
    "visibility_mean",
    "visibility mean",
    Shown::Fixed(4),
    |row| row.error.and_then(|e| e.visibility?.mean).into(),
);
/// Above 0 where the picture is too bright.
const VISIBILITY_BIAS: Column = (
    "visibility_bias",
    "visibility bias",
    Shown::Fixed(4),
    |row| row.error.and_then(|e| e.visibility?.bias).into(),
);
/// Of pixels in focus, before and behind it, and where nothing is seen but through the lens.
const FOCUSED_RMSE: Column = (
    "focused_rmse",
    "in focus rmse, %",
    Shown::Percent(4),
    |row| row.error.and_then(|e| e.focus?.in_focus.rmse).into(),
);
const NEAR_RMSE: Column = ("near_rmse", "near rmse, %", Shown::Percent(4), |row| {
    row.error.and_then(|e| e.focus?.near.rmse).into()
});
const FAR_RMSE: Column = ("far_rmse", "far rmse, %", Shown::Percent(4), |row| {
    row.error.and_then(|e| e.focus?.far.rmse).into()
});
const BESIDE_RMSE: Column = ("beside_rmse", "beside rmse, %", Shown::Percent(4), |row| {
    row.error.and_then(|e| e.focus?.beside.rmse).into()
});
const SILHOUETTE: Column = ("silhouette", "silhouette, %", Shown::Percent(3), |row| {
    row.error.and_then(|e| e.focus?.silhouette).into()
});
const SAMPLES_PER_RAY: Column = ("samples_per_ray", "samples a ray", Shown::Fixed(1), |row| {
    row.counts.map(|c| c.samples_per_ray()).into()
});
const NODES_PER_RAY: Column = ("nodes_per_ray", "nodes a ray", Shown::Fixed(1), |row| {
    row.counts.map(|c| c.nodes_per_ray()).into()
});
/// The remark on a row, if there is one.
const REMARK: Column = ("remark", "remark", Shown::Short, |row| {
    row.remark().map(str::to_owned).into()
});
/// The setting's name for people, with the renderer only if it is another's.
const NAME: Column = ("setting", "setting", Shown::Short, |row| row.title().into());

/// The columns for surfaces, which show their hits; for projections, their values.
const OF_SURFACES: &[Column] = &[WRONG_HITS, MISSED, EXTRA, DEPTH_P99];
/// Those beside them where light from everywhere is occluded, and where there are shadows.
const OF_OCCLUDED: &[Column] = &[OCCLUSION_MEAN, OCCLUSION_BIAS];
const OF_SHADOWS: &[Column] = &[VISIBILITY_MEAN, VISIBILITY_BIAS];
/// And where there is a lens.
const OF_LENS: &[Column] = &[FOCUSED_RMSE, NEAR_RMSE, FAR_RMSE, BESIDE_RMSE, SILHOUETTE];
const OF_PROJECTIONS: &[Column] = &[VALUE_RMSE, VALUE_MAX];

/// All figures of all rows.
pub fn whole_table(rows: &[Row]) -> Table {
    table(rows, ALL.iter())
}

/// The figures of one mode's rows that matter in it.
pub fn short_table(rows: &[Row]) -> Table {
    let surface = rows.iter().any(|row| row.mode == Mode::Iso);
    let projection = rows
        .iter()
        .any(|row| row.error.is_some_and(|error| error.value.is_some()));
    let any_has = |has: fn(&Figures) -> bool| {
        (rows.iter()).any(|row| row.error.is_some_and(|error| has(&error)))
    };
    let columns_if = |has, columns| if any_has(has) { columns } else { &[][..] };
    let own: &[Column] = match (surface, projection) {
        (true, _) => OF_SURFACES,
        (_, true) => OF_PROJECTIONS,
        _ => &[],
    };
    let columns = [NAME, FRAME_MS, PROCESSOR_MS].into_iter();
    let own = (own.iter())
        .chain(columns_if(|error| error.occlusion.is_some(), OF_OCCLUDED))
        .chain(columns_if(|error| error.visibility.is_some(), OF_SHADOWS))
        .chain(columns_if(|error| error.focus.is_some(), OF_LENS));
    let columns =
        columns
            .chain(own.copied())
            .chain([RMSE, MAX, SSIM, FLIP, SAMPLES_PER_RAY, NODES_PER_RAY]);
    let columns: Vec<Column> = columns.chain(remark(rows)).collect();
    table(rows, columns.iter())
}

/// All modes for reading: with the mode, and the figures that matter in any of them.
pub fn printed_table(rows: &[Row]) -> Table {
    let columns = [
        ALL[0], NAME, FRAME_MS, WRONG_HITS, MISSED, EXTRA, DEPTH_P99, VALUE_RMSE, RMSE, MAX, SSIM,
        FLIP,
    ];
    let columns: Vec<Column> = columns.into_iter().chain(remark(rows)).collect();
    table(rows, columns.iter())
}

fn remark(rows: &[Row]) -> Option<Column> {
    rows.iter()
        .any(|row| row.remark().is_some())
        .then_some(REMARK)
}

fn table<'a>(rows: &[Row], columns: impl Iterator<Item = &'a Column> + Clone) -> Table {
    let heads: Vec<_> = columns
        .clone()
        .map(|&(key, title, shown, _)| (key, title, shown))
        .collect();
    let mut table = Table::new(&heads);
    for row in rows {
        let cells = columns.clone().map(|(_, _, _, of)| of(row)).collect();
        if row.on_front.is_empty() {
            table.push(cells);
        } else {
            table.push_on_front(cells);
        }
    }
    table
}
