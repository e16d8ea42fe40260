//! A volume as an attached NRRD file (format definition: teem.sourceforge.net/nrrd/format.html).

use std::io::{self, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use glam::DVec3;

use super::{Rescale, Volume, VoxelType, Voxels};
use crate::error::{Error, Result};
use crate::output::write_atomically;

/// Writes `volume` to `path`: attached header, LPS space, raw or gzip encoding, the machine's
/// byte order (named in the header; little on every machine in use). NRRD has no calibration: a
/// calibrated volume's physical values are written, as f32.
///
/// The file appears under its name only when it is whole.
///
/// # Errors
/// The file cannot be written; a physical value lies beyond f32.
pub fn write_nrrd(volume: &Volume, path: &Path, gzip: bool) -> Result<()> {
    let calibrated;
    let voxels = if volume.rescale() == Rescale::IDENTITY {
        volume.voxels()
    } else {
        calibrated = physical_voxels(volume).map_err(|error| error.at(path.display()))?;
        &calibrated
    };
    let type_name = match voxels.voxel_type() {
        VoxelType::U8 => "uint8",
        VoxelType::U16 => "uint16",
        VoxelType::I16 => "int16",
        VoxelType::F32 => "float",
    };
    let endian = if cfg!(target_endian = "big") {
        "big"
    } else {
        "little"
    };
    write_nrrd_of(volume, type_name, endian, voxels.bytes(), path, gzip)
}

/// As [`write_nrrd`], with other voxels than the volume's own: bytes of NRRD's type `type_name`.
///
/// # Errors
/// The file cannot be written.
pub(super) fn write_nrrd_of(
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

fn physical_voxels(volume: &Volume) -> Result<Voxels> {
    let range = volume.range();
    if range.min.abs().max(range.max.abs()) > f64::from(f32::MAX) {
        return Err(Error::input(format!(
            "the values {} to {} do not fit single precision",
            range.min, range.max
        )));
    }
    let rescale = volume.rescale();
    let physical = |stored| rescale.physical(stored) as f32;
    Ok(volume.voxels().each_as_f32(physical)?.into())
}
