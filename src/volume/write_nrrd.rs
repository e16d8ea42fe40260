//! A volume as an attached NRRD file (format definition: teem.sourceforge.net/nrrd/format.html).

use std::io::{self, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use glam::DVec3;

use super::{Rescale, Volume, VoxelType};
use crate::error::{Error, Result};
use crate::memory;
use crate::output::write_atomically;

/// Writes `volume` to `path`: attached header, LPS space, raw or gzip encoding, the machine's
/// byte order (named in the header; little on every machine in use). NRRD has no calibration: a
/// calibrated volume's physical values are written, as f32 where that holds them, else as f64.
///
/// The file appears under its name only when it is whole.
///
/// # Errors
/// The file cannot be written; a physical value lies beyond f32.
pub fn write_nrrd(volume: &Volume, path: &Path, gzip: bool) -> Result<()> {
    let (single, double);
    let (type_name, bytes) = if volume.rescale() == Rescale::IDENTITY {
        let name = match volume.voxels().voxel_type() {
            VoxelType::U8 => "uint8",
            VoxelType::U16 => "uint16",
            VoxelType::I16 => "int16",
            VoxelType::F32 => "float",
        };
        (name, volume.voxels().bytes())
    } else {
        double = physical_voxels(volume).map_err(|error| error.at(path.display()))?;
        single = in_single_precision(&double)?;
        match &single {
            Some(single) => ("float", bytemuck::cast_slice(single)),
            None => ("double", bytemuck::cast_slice(&double)),
        }
    };
    let endian = if cfg!(target_endian = "big") {
        "big"
    } else {
        "little"
    };
    write_nrrd_of(volume, type_name, endian, bytes, path, gzip)
}

/// Writes an NRRD file as [`write_nrrd`] does, with other voxels than the volume's own: bytes of NRRD's
/// type `type_name`.
///
/// # Errors
/// The file cannot be written.
pub fn write_nrrd_of(
    volume: &Volume,
    type_name: &str,
    endian: &str,
    voxels: &[u8],
    path: &Path,
    gzip: bool,
) -> Result<()> {
    write_atomically(path, |out| {
        let write = || -> io::Result<()> {
            out.write_all(header(volume, type_name, endian, gzip).as_bytes())?;
            if gzip {
                let mut encoder = GzEncoder::new(out, Compression::default());
                encoder.write_all(voxels)?;
                encoder.finish()?;
                Ok(())
            } else {
                out.write_all(voxels)
            }
        };
        write().map_err(|cause| Error::writing(path, "write the volume", &cause))
    })
}

/// The header, its closing blank line included.
fn header(volume: &Volume, type_name: &str, endian: &str, gzip: bool) -> String {
    let [nx, ny, nz] = volume.dims().array();
    let world_from_index = volume.geometry().world_from_index();
    let axes = world_from_index.matrix3;
    let vector = |v: DVec3| format!("({},{},{})", v.x, v.y, v.z);
    format!(
        "NRRD0005\n\
         type: {type_name}\n\
         dimension: 3\n\
         space: left-posterior-superior\n\
         sizes: {nx} {ny} {nz}\n\
         space directions: {} {} {}\n\
         kinds: domain domain domain\n\
         endian: {endian}\n\
         encoding: {}\n\
         space origin: {}\n\
         \n",
        vector(axes.x_axis),
        vector(axes.y_axis),
        vector(axes.z_axis),
        if gzip { "gzip" } else { "raw" },
        vector(world_from_index.translation),
    )
}

fn physical_voxels(volume: &Volume) -> Result<Vec<f64>> {
    let range = volume.range();
    if range.min.abs().max(range.max.abs()) > f64::from(f32::MAX) {
        return Err(Error::input(format!(
            "the values {} to {} do not fit single precision",
            range.min, range.max
        )));
    }
    let rescale = volume.rescale();
    volume.voxels().each_with(|stored| rescale.physical(stored))
}

/// The values as f32; `None` if rounding would move one by more than a millionth of their range.
fn in_single_precision(values: &[f64]) -> Result<Option<Vec<f32>>> {
    let (min, max) = (values.iter()).fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), &v| {
        (min.min(v), max.max(v))
    });
    let close = (max - min) * 1e-6;
    let mut singles = memory::room(values.len(), format_args!("{} voxels of f32", values.len()))?;
    for &value in values {
        let single = value as f32;
        if (f64::from(single) - value).abs() > close {
            return Ok(None);
        }
        singles.push(single);
    }
    Ok(Some(singles))
}
