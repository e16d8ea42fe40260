"""Writes the fixtures of tests/readers/ into tests/data/volumes with the formats' own programs.

    python3 -m venv VENV && VENV/bin/pip install SimpleITK nibabel pynrrd numpy
    VENV/bin/python tests/data/make_volumes.py

Every volume is the same ramp, 5 x 4 x 3 voxels:

    voxel(x, y, z) = x + 10 y + 100 z + offset,   frame t of a series: + 1000 t (or + 1 t in u8)

so that a swapped axis, byte or frame cannot go unseen. What a fixture is for stands where it is
made; what it must read as stands in tests/readers/. Written by SimpleITK 2.5, nibabel 5.4,
pynrrd 1.1, numpy 2.4; headers that none of them can write (skips, lists, patterns) are spelled out
here in the formats' own words.
"""

import bz2
import gzip
import os
import shutil
import zlib

import nibabel as nib
import nrrd
import numpy as np
import SimpleITK as sitk

OUT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "volumes")
shutil.rmtree(OUT, ignore_errors=True)
os.makedirs(OUT)
os.chdir(OUT)

NX, NY, NZ = 5, 4, 3
SPACING = (0.5, 0.75, 2.0)
ORIGIN = (10.0, -20.0, 30.5)

# Columns are the world directions (LPS) of x, y, z: rotations by 0.3 about z after 0.5 about x.
c3, s3, c5, s5 = np.cos(0.3), np.sin(0.3), np.cos(0.5), np.sin(0.5)
OBLIQUE = np.array([[c3, -s3, 0], [s3, c3, 0], [0, 0, 1]]) @ np.array(
    [[1, 0, 0], [0, c5, -s5], [0, s5, c5]]
)
# x runs to +z, y to -x, z to +y of the world: determinant -1.
LEFT_HANDED = np.array([[0.0, -1, 0], [0, 0, 1], [1, 0, 0]])

TYPES = {
    "u8": np.uint8, "i8": np.int8, "u16": np.uint16, "i16": np.int16, "u32": np.uint32,
    "i32": np.int32, "u64": np.uint64, "i64": np.int64, "f32": np.float32, "f64": np.float64,
}
# An offset in which each type shows its own: signs, high bytes, digits.
OFFSETS = {
    "u8": 20, "i8": -110, "u16": 60000, "i16": -30000, "u32": 3_000_000, "i32": -2_000_000,
    "u64": 5_000_000, "i64": -6_000_000, "f32": 0.25, "f64": -0.125,
}


def ramp(kind="i16", offset=None):
    """The ramp, indexed z, y, x."""
    z, y, x = np.meshgrid(range(NZ), range(NY), range(NX), indexing="ij")
    offset = OFFSETS[kind] if offset is None else offset
    return (x + 10 * y + 100 * z + offset).astype(TYPES[kind])


def series(kind="i16", frames=3, step=1000):
    """Frames of ramps, indexed t, z, y, x."""
    return np.stack([ramp(kind, step * t) for t in range(frames)])


def image(array, direction=np.eye(3), vector=False):
    made = sitk.GetImageFromArray(array, isVector=vector)
    if made.GetDimension() == 3:
        made.SetSpacing(SPACING)
        made.SetOrigin(ORIGIN)
        made.SetDirection(direction.ravel())
    return made


def text(name, header, data=b""):
    with open(name, "wb") as out:
        out.write(header.encode() + data)


# --- NRRD and MetaImage by SimpleITK -------------------------------------------------------------
for suffix in ("nrrd", "mha"):
    for kind in TYPES:  # every number type
        sitk.WriteImage(image(ramp(kind)), f"sitk_{kind}.{suffix}")
    # directions; compressed: gzip in NRRD, zlib in MetaImage
    sitk.WriteImage(image(ramp(), OBLIQUE), f"sitk_oblique.{suffix}", useCompression=True)
    sitk.WriteImage(image(ramp(), LEFT_HANDED), f"sitk_left_handed.{suffix}")
    # two components a voxel: frames that lie beside each other, not one after the other
    sitk.WriteImage(
        image(np.moveaxis(series(frames=2), 0, -1).copy(), vector=True), f"sitk_two.{suffix}"
    )
    # three components: refused
    sitk.WriteImage(
        image(np.moveaxis(series("u8", 3, 1), 0, -1).copy(), vector=True), f"sitk_rgb.{suffix}"
    )
    # a fourth axis through "space"
    sitk.WriteImage(sitk.GetImageFromArray(series(), isVector=False), f"sitk_series.{suffix}")
    # one slice, two axes
    flat = sitk.GetImageFromArray(ramp()[1])
    flat.SetSpacing(SPACING[:2])
    flat.SetOrigin(ORIGIN[:2])
    sitk.WriteImage(flat, f"sitk_flat.{suffix}")
# detached headers; .mhd's data raw, then zlib
sitk.WriteImage(image(ramp(), OBLIQUE), "sitk_detached.nhdr")
sitk.WriteImage(image(ramp(), OBLIQUE), "sitk_detached.mhd")
sitk.WriteImage(image(ramp(), OBLIQUE), "sitk_packed.mhd", useCompression=True)

# --- NRRD by pynrrd ------------------------------------------------------------------------------
# pynrrd indexes x, y, z in its default (Fortran) order.
xyz = np.asfortranarray(ramp().transpose(2, 1, 0))
# spaces other than LPS: the vectors here are the file's own, in its space
FILE_AXES = (OBLIQUE @ np.diag(SPACING)).T
for space in ("right-anterior-superior", "left-anterior-superior", "scanner-xyz"):
    nrrd.write(
        f"pynrrd_{space}.nrrd", xyz,
        {"space": space, "space directions": FILE_AXES, "space origin": np.array(ORIGIN)},
    )
# encodings and byte orders
for encoding in ("raw", "gzip", "bzip2", "ascii"):
    nrrd.write(f"pynrrd_{encoding}.nrrd", xyz, {"encoding": encoding, "spacings": SPACING})
for encoding in ("raw", "gzip", "bzip2"):
    nrrd.write(f"pynrrd_{encoding}_big.nrrd", xyz.astype(">i2"),
               {"encoding": encoding, "endian": "big", "spacings": SPACING})
nrrd.write("pynrrd_ascii_f32.nrrd",
           np.asfortranarray(ramp("f32").transpose(2, 1, 0)), {"encoding": "ascii"})
nrrd.write("pynrrd_f64_big.nrrd",
           np.asfortranarray(ramp("f64").transpose(2, 1, 0)).astype(">f8"),
           {"encoding": "raw", "endian": "big"})
# gzip in a file of its own
nrrd.write("pynrrd_detached.nhdr", xyz, {"encoding": "gzip", "spacings": SPACING},
           detached_header=True)
# frames first (kind list), in the middle, last (no kinds)
txyz = series().transpose(0, 3, 2, 1)
nrrd.write("pynrrd_list_first.nrrd", np.asfortranarray(txyz),
           {"encoding": "raw", "kinds": ["list", "domain", "domain", "domain"],
            "space": "left-posterior-superior", "space origin": np.array(ORIGIN),
            "space directions": np.vstack([[np.nan] * 3, FILE_AXES])})
nrrd.write("pynrrd_time_third.nrrd", np.asfortranarray(np.moveaxis(txyz, 0, 2)),
           {"encoding": "gzip", "kinds": ["domain", "domain", "time", "domain"]})
# time as the first axis, of a space with time: its direction has only a fourth component
nrrd.write("pynrrd_time_first.nrrd", np.asfortranarray(txyz),
           {"encoding": "raw", "space": "left-posterior-superior-time",
            "space origin": np.array([*ORIGIN, 0.0]),
            "space directions": np.vstack([[0, 0, 0, 0.1], np.hstack([FILE_AXES, np.zeros((3, 1))])])})
nrrd.write("pynrrd_series.nrrd", np.asfortranarray(np.moveaxis(txyz, 0, 3)), {"encoding": "bzip2"})

# --- NRRD in its own words: skips, lists, patterns -----------------------------------------------
little = ramp().astype("<i2").tobytes()
BASE = "NRRD0005\n# by hand\ntype: signed short\ndimension: 3\nsizes: 5 4 3\nendian: little\nkey:=value\n"
text("skip.raw", "first line\nsecond\n", b"1234567" + little)
text("skip.nhdr", BASE + "encoding: raw\nline skip: 2\nbyte skip: 7\ndata file: skip.raw\n")
text("from_end.nhdr", BASE + "encoding: raw\nbyteskip: -1\ndatafile: skip.raw\n")
# for gzip the lines are skipped before decoding, the bytes after it
text("skip_gz.bin", "a line\n", gzip.compress(b"123" + little, mtime=0))
text("skip_gz.nhdr", BASE + "encoding: gz\nline skip: 1\nbyte skip: 3\ndata file: skip_gz.bin\n")
for z in range(NZ):
    text(f"slice_{z + 8:03}.raw", "", ramp()[z].astype("<i2").tobytes())
    text(f"slice_{z + 8:03}.raw.bz2", "", bz2.compress(ramp()[z].astype("<i2").tobytes()))
NAMES = "".join(f"slice_{z + 8:03}.raw\n" for z in range(NZ))
text("list.nhdr", BASE + "encoding: raw\ndata file: LIST\n" + NAMES)
text("pattern.nhdr", BASE + "encoding: bz2\ndata file: slice_%03d.raw.bz2 8 10 1 2\n")
# carriage returns, an attached header, no byte order
text("crlf.nrrd", "NRRD0001\r\ntype: short\r\ndimension: 3\r\nsizes: 5 4 3\r\nencoding: raw\r\n\r\n", little)

# --- MetaImage in its own words ------------------------------------------------------------------
META = ("NDims = 3\nDimSize = 5 4 3\nPosition = 10 -20 30.5\nElementSize = 0.5 0.75 2\n"
        "ElementType = MET_SHORT\n")
big = ramp().astype(">i2").tobytes()
# no ObjectType; old names of the fields; big-endian
text("big.mha", META + "ElementByteOrderMSB = True\nElementDataFile = LOCAL\n", big)
text("big_packed.mha", META + "BinaryDataByteOrderMSB = True\nCompressedData = True\nElementDataFile = LOCAL\n",
     zlib.compress(big))
text("list.mhd", META + "ElementDataFile = LIST\n" + NAMES)
text("pattern.mhd", META + "ElementDataFile = slice_%03d.raw 8 10 1\n")
text("from_end.mhd", META + "HeaderSize = -1\nElementDataFile = skip.raw\n")
text("skip.mhd", META + "HeaderSize = 25\nElementDataFile = skip.raw\n")
text("ascii.mha", META + "BinaryData = False\nElementDataFile = LOCAL\n",
     " ".join(str(v) for v in ramp().ravel()).encode() + b"\n")
text("negative.mha", META.replace("0.5 0.75", "-0.5 0.75") + "ElementDataFile = LOCAL\n", little)

# --- NIfTI by nibabel and SimpleITK --------------------------------------------------------------
# nibabel's affines are RAS; the expected geometry is LPS.
RAS = np.diag([-1.0, -1, 1, 1])


def affine(direction):
    made = np.eye(4)
    made[:3, :3] = direction @ np.diag(SPACING)
    made[:3, 3] = ORIGIN
    return RAS @ made


def nifti(array, cls=nib.Nifti1Image, world=affine(OBLIQUE), endian="<", dtype=None):
    header = cls.header_class(endianness=endian)
    made = cls(np.asfortranarray(array.T), None, header=header, dtype=dtype or array.dtype)
    if world is not None:
        made.header.set_sform(world, 1)
        made.header.set_qform(world, 1)
    return made


def save(made, name):
    """nibabel refreshes the geometry on saving, so the header is kept as it was set."""
    made.to_filename(name)


for kind in TYPES:  # every number type, both versions, both byte orders
    big_endian = kind in ("u16", "i32", "f32", "f64")
    save(nifti(ramp(kind), endian=">" if big_endian else "<", dtype=TYPES[kind]), f"nib1_{kind}.nii")
    save(nifti(ramp(kind), nib.Nifti2Image, endian="<" if big_endian else ">", dtype=TYPES[kind]),
         f"nib2_{kind}.nii.gz")
sitk.WriteImage(image(ramp(), OBLIQUE), "sitk_oblique.nii")
sitk.WriteImage(image(ramp(), LEFT_HANDED), "sitk_left_handed.nii.gz")
# pairs
save(nib.Nifti1Pair(np.asfortranarray(ramp().T), affine(OBLIQUE)), "nib_pair.hdr")
save(nib.Nifti1Pair(np.asfortranarray(ramp().T), affine(OBLIQUE)), "nib_pair_gz.img.gz")
# only the qform set: left-handed, so that pixdim[0] is -1
made = nifti(ramp(), world=None)
made.header.set_qform(affine(LEFT_HANDED), 1)
made.header.set_sform(None, 0)
save(made, "nib_qform.nii")
# the two disagree: the sform wins
made = nifti(ramp(), world=None)
made.header.set_qform(affine(LEFT_HANDED), 1)
made.header.set_sform(affine(OBLIQUE), 2)
save(made, "nib_both.nii")
# a sheared sform
made = nifti(ramp(), world=None)
sheared = np.eye(4)
sheared[:3, :3] = [[2, 1, 0], [0, 2, 0], [0, 0, 3]]
made.header.set_sform(sheared, 1)
save(made, "nib_sheared.nii")
# neither: only voxel sizes, one of them negative
made = nifti(ramp(), world=None)
made.header.set_sform(None, 0)
made.header.set_qform(None, 0)
made.header["pixdim"][1:4] = (0.5, -0.75, 2)
save(made, "nib_uncoded.nii")
# metres and micrometres
for unit, scale in (("meter", 0.001), ("micron", 1000)):
    world = affine(OBLIQUE)
    world[:3] *= scale
    made = nifti(ramp(), world=world)
    made.header.set_xyzt_units(unit)
    save(made, f"nib_{unit}.nii")
# slope and intercept: nibabel writes none by itself for integers, so they are put into the file
for name, slope, intercept in (("rising", 2.0, -1024.0), ("falling", -0.5, 3.0), ("none", 0.0, 7.0)):
    save(nifti(ramp("u8")), "tmp.nii")
    data = bytearray(open("tmp.nii", "rb").read())
    data[112:120] = np.array([slope, intercept], "<f4").tobytes()
    text(f"slope_{name}.nii", "", bytes(data))
os.remove("tmp.nii")
# a series
save(nifti(series()), "nib_series.nii.gz")
# colour: refused
rgb = np.zeros((NX, NY, NZ), [("R", "u1"), ("G", "u1"), ("B", "u1")])
save(nib.Nifti1Image(rgb, np.eye(4)), "nib_rgb.nii.gz")

# --- NumPy ---------------------------------------------------------------------------------------
for kind in TYPES:
    np.save(f"np_{kind}.npy", ramp(kind))
np.save("np_f16.npy", ramp("f32").astype(np.float16))
np.save("np_bool.npy", ramp("u8") > 120)
np.save("np_big.npy", ramp().astype(">i2"))
np.save("np_fortran.npy", np.asfortranarray(ramp()))
np.save("np_series.npy", series())
np.save("np_series_fortran.npy", np.asfortranarray(series()))
np.save("np_flat.npy", ramp()[1])
np.save("np_rgb.npy", np.zeros((3, 4, 5, 3), np.uint8))
np.save("np_complex.npy", ramp().astype(np.complex64))
for version in ((2, 0), (3, 0)):
    with open(f"np_version{version[0]}.npy", "wb") as out:
        np.lib.format.write_array(out, ramp(), version=version)
np.savez("np_stored.npz", ramp())
np.savez_compressed("np_packed.npz", ramp("f32"))
# several arrays: the one of a likely name and of three axes
np.savez_compressed("np_several.npz", spacing=np.array(SPACING), other=ramp("u8"), volume=ramp())
np.savez("np_none.npz", spacing=np.array(SPACING))

# --- headerless ----------------------------------------------------------------------------------
text("ramp_5x4x3_uint16be.raw", "", ramp("u16").astype(">u2").tobytes())
text("ramp_5x4x3_int16.raw.gz", "", gzip.compress(little, mtime=0))
text("ramp.bin", "head", little)

# --- wrapped once more, and under a wrong name ---------------------------------------------------
text("wrapped.nrrd.gz", "", gzip.compress(open("sitk_i16.nrrd", "rb").read(), mtime=0))
text("wrapped.mha.gz", "", gzip.compress(open("sitk_oblique.mha", "rb").read(), mtime=0))
text("really_nrrd.nii", "", open("sitk_oblique.nrrd", "rb").read())
text("really_nifti.raw", "", open("nib2_i16.nii.gz", "rb").read())
# two gzip members, then the zeros that some archives pad with
whole = open("nib1_i16.nii", "rb").read()
text("members.nii.gz", "", gzip.compress(whole[:400], mtime=0) + gzip.compress(whole[400:], mtime=0)
     + bytes(64))
