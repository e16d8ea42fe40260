//! Kernel sources: embedded in the program, or read from disk while developing.

use std::borrow::Cow;
use std::path::Path;

use crate::error::{Error, Result};

/// Names the folder from which kernels are read instead of the embedded ones.
const FROM_DISK: &str = "ANGIORAY_KERNELS";

macro_rules! embedded {
    ($($path:literal),* $(,)?) => {
        &[$(($path, include_str!(concat!("../../kernels/", $path)))),*]
    };
}

/// Every kernel file, its path below `kernels/`.
const FILES: &[(&str, &str)] = embedded![
    "lib/abi.clh",
    "lib/find/approach.clh",
    "lib/find/crossing.clh",
    "lib/find/leaving.clh",
    "lib/find/peak.clh",
    "lib/find/ray_sets.clh",
    "lib/find/refine.clh",
    "lib/find/surface_point.clh",
    "lib/light/accumulate.clh",
    "lib/light/color.clh",
    "lib/light/cube.clh",
    "lib/light/emission.clh",
    "lib/light/feeler.clh",
    "lib/light/medium.clh",
    "lib/light/preintegrated.clh",
    "lib/light/quadrature.clh",
    "lib/light/section.clh",
    "lib/light/shade.clh",
    "lib/light/toward_light.clh",
    "lib/light/transfer.clh",
    "lib/math/exponential.clh",
    "lib/math/lanes.clh",
    "lib/math/pair.clh",
    "lib/math/power.clh",
    "lib/math/unit.clh",
    "lib/ray/block_walk.clh",
    "lib/ray/blocks.clh",
    "lib/ray/blur.clh",
    "lib/ray/camera.clh",
    "lib/ray/cast_planes.clh",
    "lib/ray/clip.clh",
    "lib/ray/differ.clh",
    "lib/ray/interval.clh",
    "lib/ray/jitter.clh",
    "lib/ray/lattice.clh",
    "lib/ray/marks.clh",
    "lib/ray/pixels.clh",
    "lib/ray/planes.clh",
    "lib/ray/ray.clh",
    "lib/ray/source.clh",
    "lib/ray/visible.clh",
    "lib/skip/cell_path.clh",
    "lib/skip/cells.clh",
    "lib/skip/frustum_field.clh",
    "lib/skip/frustum_values.clh",
    "lib/skip/march.clh",
    "lib/skip/nodes.clh",
    "lib/skip/packet.clh",
    "lib/skip/pyramid.clh",
    "lib/skip/segment_march.clh",
    "lib/skip/segments.clh",
    "lib/skip/smooth_surface.clh",
    "lib/skip/spans.clh",
    "lib/volume/cubic.clh",
    "lib/volume/field.clh",
    "lib/volume/gradient.clh",
    "lib/volume/normal.clh",
    "lib/volume/voxels.clh",
    "pass/adaptive_emission.cl",
    "pass/add_picture.cl",
    "pass/ambient_occlusion.cl",
    "pass/behind_surface.cl",
    "pass/blur_along.cl",
    "pass/blur_circles.cl",
    "pass/blur_reach.cl",
    "pass/blur_squares.cl",
    "pass/bound_occlusion.cl",
    "pass/cast_emission.cl",
    "pass/cast_maximum.cl",
    "pass/cast_shadows.cl",
    "pass/cast_surface.cl",
    "pass/circles_of_confusion.cl",
    "pass/compare_samples.cl",
    "pass/count_marked.cl",
    "pass/dim_at_edges.cl",
    "pass/exact_projection.cl",
    "pass/exact_surface.cl",
    "pass/fill_uncast.cl",
    "pass/gather_blur.cl",
    "pass/interpolate_hits.cl",
    "pass/light_depths.cl",
    "pass/list_marked.cl",
    "pass/mark_checked.cl",
    "pass/mark_edges.cl",
    "pass/mark_exceeding.cl",
    "pass/mark_grid.cl",
    "pass/mark_refill.cl",
    "pass/mark_uncertain.cl",
    "pass/mark_varying_light.cl",
    "pass/mark_varying_values.cl",
    "pass/mean_of_samples.cl",
    "pass/mix_blurred.cl",
    "pass/occlusion_between.cl",
    "pass/put_blurred.cl",
    "pass/sample_field.cl",
    "pass/screen_occlusion.cl",
    "pass/shade_surface.cl",
    "pass/smooth_occlusion.cl",
    "pass/sum_counts.cl",
    "pass/surface_normal.cl",
    "pass/thickness.cl",
    "pass/tint_by_depth.cl",
    "pass/tone_curve.cl",
    "pass/window_value.cl",
    "test/abi.cl",
    "test/absorption.cl",
    "test/clip.cl",
    "test/color.cl",
    "test/field.cl",
    "test/gradient.cl",
    "test/interval.cl",
    "test/peak.cl",
    "test/reflection.cl",
    "test/spans.cl",
    "test/transfer.cl",
];

/// The paths of all kernel files below `kernels/`.
pub fn files() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|(path, _)| *path)
}

/// The file at `path` below `kernels/` with every `#include "…"` replaced once by the file it
/// names, and `#line` marks, so that a build error reads `kernels/pass/x.cl:15:14`.
///
/// # Errors
/// A file that does not exist, or cannot be read from disk.
pub fn flatten(path: &str) -> Result<String> {
    let mut text = String::new();
    let mut included = Vec::new();
    append(path, &mut included, &mut text)?;
    Ok(text)
}

fn append(path: &str, included: &mut Vec<String>, text: &mut String) -> Result<()> {
    if included.iter().any(|seen| seen == path) {
        return Ok(());
    }
    included.push(path.to_owned());
    let file = read(path)?;
    text.push_str(&format!("#line 1 \"kernels/{path}\"\n"));
    for (number, line) in file.lines().enumerate() {
        if let Some(name) = line
            .strip_prefix("#include \"")
            .and_then(|rest| rest.strip_suffix('"'))
        {
            append(name, included, text)?;
            text.push_str(&format!("#line {} \"kernels/{path}\"\n", number + 2));
        } else if line == "#pragma once" {
            text.push('\n'); // each file is included once as it is
        } else {
            text.push_str(line);
            text.push('\n');
        }
    }
    Ok(())
}

fn read(path: &str) -> Result<Cow<'static, str>> {
    if let Some(folder) = std::env::var_os(FROM_DISK) {
        let on_disk = Path::new(&folder).join(path);
        return std::fs::read_to_string(&on_disk)
            .map(Cow::Owned)
            .map_err(|e| Error::reading(&on_disk, "read the kernel source", &e));
    }
    FILES
        .iter()
        .find(|(name, _)| *name == path)
        .map(|(_, text)| Cow::Borrowed(*text))
        .ok_or_else(|| Error::failed(format!("there is no kernel file '{path}'")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kernel_file_is_embedded() {
        fn collect(kernels: &Path, folder: &Path, found: &mut Vec<String>) {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    collect(kernels, &path, found);
                } else {
                    let name = path.strip_prefix(kernels).unwrap().to_str().unwrap();
                    found.push(name.to_owned());
                }
            }
        }
        let kernels = Path::new(env!("CARGO_MANIFEST_DIR")).join("kernels");
        let mut on_disk = Vec::new();
        collect(&kernels, &kernels, &mut on_disk);
        on_disk.sort();
        assert_eq!(on_disk, files().collect::<Vec<_>>());
    }

    #[test]
    fn includes_are_flattened_once_and_lines_keep_their_names() {
        let text = flatten("pass/exact_surface.cl").unwrap();
        assert!(!text.contains("#include"));
        assert_eq!(text.matches("} RayGrid;").count(), 1);
        assert!(text.contains("#line 1 \"kernels/lib/ray/ray.clh\""));
        // The line after the last include is marked with its own number.
        let source = read("pass/exact_surface.cl").unwrap();
        let after = source
            .lines()
            .position(|l| l == "#include \"lib/ray/cast_planes.clh\"")
            .unwrap()
            + 2;
        assert!(text.contains(&format!("#line {after} \"kernels/pass/exact_surface.cl\"")));
    }

    #[test]
    fn an_unknown_file_is_an_error() {
        assert!(flatten("pass/nothing.cl").is_err());
    }
}
