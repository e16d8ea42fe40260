//! MP4 and WebM: raw frames through a pipe to ffmpeg.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use tempfile::NamedTempFile;

use crate::error::{Error, Result};
use crate::extent::ImageSize;
use crate::frame::{Frame, quantize};

use super::{Animation, AnimationFormat};

const PROGRAM: &str = "ffmpeg";

/// ffmpeg's name of a container, and of the encoders that will do, the best first, each with its
/// quality: hardly distinguishable from the frames.
type Codec = (&'static str, &'static [&'static str]);

const H264: &[Codec] = &[
    ("libx264", &["-preset", "medium", "-crf", "16"]),
    ("libopenh264", &["-b:v", "12M"]),
];
const VP9: &[Codec] = &[("libvpx-vp9", &["-crf", "20", "-b:v", "0", "-row-mt", "1"])];

fn codecs(format: AnimationFormat) -> &'static [Codec] {
    match format {
        AnimationFormat::WebM => VP9,
        _ => H264,
    }
}

pub(super) fn check(format: AnimationFormat) -> Result<()> {
    codec(format).map(drop)
}

/// The first encoder that the ffmpeg that is there has.
fn codec(format: AnimationFormat) -> Result<Codec> {
    let mut command = Command::new(PROGRAM);
    command.args(["-hide_banner", "-loglevel", "error", "-encoders"]);
    let listed = command
        .stdin(Stdio::null())
        .output()
        .map_err(|cause| unavailable(&cause))?;
    let listed = String::from_utf8_lossy(&listed.stdout).into_owned();
    let is_listed = |name: &str| listed.split_whitespace().any(|word| word == name);
    let wanted = codecs(format);
    wanted
        .iter()
        .find(|(name, _)| is_listed(name))
        .copied()
        .ok_or_else(|| {
            let names: Vec<&str> = wanted.iter().map(|(name, _)| *name).collect();
            Error::resource(format!(
                "the ffmpeg that is installed has no encoder {}",
                names.join(" or ")
            ))
            .hint("install a full ffmpeg, or write an .apng or .gif")
        })
}

fn unavailable(cause: &io::Error) -> Error {
    let why = match cause.kind() {
        ErrorKind::NotFound => "is not installed".to_owned(),
        _ => format!("cannot be run: {cause}"),
    };
    Error::resource(format!("ffmpeg, which writes .mp4 and .webm, {why}")).hint(
        "install it (apt-get install ffmpeg, dnf install ffmpeg, brew install ffmpeg), or write an .apng, a .gif, or pictures by a name such as frames/%04d.png",
    )
}

/// ffmpeg writes a file of its own, since it seeks in it; once it is whole it is copied to `out`.
pub(super) fn encode(
    out: &mut impl Write,
    path: &Path,
    animation: &Animation,
    size: ImageSize,
    frames: &mut dyn Iterator<Item = Result<Frame>>,
) -> Result<()> {
    let codec = codec(animation.format)?;
    let temporary = |cause: io::Error| Error::writing(&std::env::temp_dir(), "write", &cause);
    let movie = NamedTempFile::new().map_err(temporary)?;
    let mut messages = tempfile::tempfile().map_err(temporary)?;
    let mut command = command(animation, size, codec, movie.path());
    command.stderr(messages.try_clone().map_err(temporary)?);
    let mut running = Running(command.spawn().map_err(|cause| unavailable(&cause))?);
    let mut fed = Ok(());
    if let Some(mut pipe) = running.0.stdin.take() {
        for frame in frames {
            fed = pipe.write_all(&even(&quantize::rgb8(&frame?)?, size));
            if fed.is_err() {
                break;
            }
        }
    }
    let status = running.0.wait().map_err(|cause| unavailable(&cause))?;
    match (status.success(), fed) {
        (true, Ok(())) => {}
        (true, Err(cause)) => return Err(Error::writing(path, "write", &cause)),
        (false, _) => {
            let reason = last_line(&mut messages).unwrap_or_else(|| status.to_string());
            return Err(Error::resource(format!(
                "{}: ffmpeg failed: {reason}",
                path.display()
            )));
        }
    }
    let mut movie = File::open(movie.path()).map_err(temporary)?;
    io::copy(&mut movie, out).map_err(|cause| Error::writing(path, "write", &cause))?;
    Ok(())
}

/// Colours as BT.709 says, which players take HD video for.
fn command(
    animation: &Animation,
    size: ImageSize,
    (encoder, quality): Codec,
    movie: &Path,
) -> Command {
    let [width, height] = even_size(size);
    let mut command = Command::new(PROGRAM);
    command
        .args(["-hide_banner", "-loglevel", "error", "-nostdin", "-y"])
        .args(["-f", "rawvideo", "-pix_fmt", "rgb24"])
        .args(["-video_size", &format!("{width}x{height}")])
        .args(["-framerate", &animation.rate.to_string(), "-i", "pipe:0"])
        .args(["-vf", "scale=out_color_matrix=bt709:out_range=tv"])
        .args(["-c:v", encoder])
        .args(quality)
        .args(["-pix_fmt", "yuv420p", "-colorspace", "bt709"])
        .args(["-color_primaries", "bt709", "-color_trc", "bt709"])
        .args(["-color_range", "tv"]);
    match animation.format {
        AnimationFormat::WebM => command.args(["-f", "webm"]),
        _ => command.args(["-movflags", "+faststart", "-f", "mp4"]),
    };
    command
        .arg(movie)
        .stdin(Stdio::piped())
        .stdout(Stdio::null());
    // A Ctrl-C is for this program, which stops in order.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    command
}

/// A child that does not outlive its frames.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // Both fail only where it has ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Half as many colours as pixels along either axis: both sides must be even.
fn even_size(size: ImageSize) -> [u32; 2] {
    [size.width(), size.height()].map(|side| side.next_multiple_of(2))
}

/// The picture with its last column and row repeated where its sides are odd.
fn even(rgb: &[u8], size: ImageSize) -> Vec<u8> {
    let row_bytes = 3 * size.width() as usize;
    let [width, height] = even_size(size).map(|side| side as usize);
    let mut padded = Vec::with_capacity(3 * width * height);
    let rows = rgb.chunks_exact(row_bytes);
    let last = rgb.len().saturating_sub(row_bytes);
    for row in rows.chain(std::iter::once(&rgb[last..])).take(height) {
        padded.extend_from_slice(row);
        if row_bytes < 3 * width {
            padded.extend_from_slice(&row[row_bytes - 3..]);
        }
    }
    padded
}

fn last_line(messages: &mut File) -> Option<String> {
    let mut text = String::new();
    messages.rewind().ok()?;
    messages.read_to_string(&mut text).ok()?;
    let mut lines = text.lines().rev().map(str::trim);
    lines.find(|line| !line.is_empty()).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_sides_repeat_their_last_row_and_column() {
        let padded = |width, height, rgb: &[u8]| even(rgb, ImageSize::new(width, height).unwrap());
        let pixel = |n: u8| [n, n, n];
        let rgb = |pixels: &[u8]| pixels.iter().flat_map(|&n| pixel(n)).collect::<Vec<u8>>();
        assert_eq!(padded(1, 1, &rgb(&[7])), rgb(&[7, 7, 7, 7]));
        assert_eq!(
            padded(3, 1, &rgb(&[1, 2, 3])),
            rgb(&[1, 2, 3, 3, 1, 2, 3, 3])
        );
        assert_eq!(padded(2, 2, &rgb(&[1, 2, 3, 4])), rgb(&[1, 2, 3, 4]));
    }
}
