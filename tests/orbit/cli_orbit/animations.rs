//! Animations hold the frames of the pictures.

use std::fs;
use std::process::Command;

use angioray::frame::read_metadata;
use image::AnimationDecoder;

use super::{REFERENCE, apart, pixels, place};
use crate::cli_place::stderr;

#[test]
fn animations_hold_the_frames_of_the_pictures() {
    let place = place();
    let orbit =
        format!("orbit v.nrrd --iso 70 --color #f08030 --size 31x23 --frames 6 {REFERENCE}");
    place.done(&format!("{orbit} -o f/%02d.png"));
    let frame = |k: usize| pixels(&place.path(&format!("f/{k:02}.png")));
    let frames: Vec<Vec<u8>> = (0..6).map(frame).collect();
    // The control of what follows: the frames are well apart.
    for k in 1..6 {
        assert!(apart(&frames[k], &frames[k - 1]).0 > 2.0);
    }

    place.done(&format!("{orbit} -o a.apng --fps 12.5"));
    let file = fs::File::open(place.path("a.apng")).unwrap();
    let mut reader = png::Decoder::new(std::io::BufReader::new(file))
        .read_info()
        .unwrap();
    let control = *reader.info().animation_control().unwrap();
    assert_eq!((control.num_frames, control.num_plays), (6, 0));
    for (k, frame) in frames.iter().enumerate() {
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert!(&pixels == frame, "{k}");
        let shown = reader.info().frame_control().unwrap();
        let seconds = f64::from(shown.delay_num) / f64::from(shown.delay_den);
        assert!((seconds - 0.08).abs() < 1e-9, "{seconds}");
    }
    let metadata = read_metadata(&place.path("a.apng")).unwrap();
    let of_frame_0 = read_metadata(&place.path("f/00.png")).unwrap();
    assert_eq!(metadata, of_frame_0);

    place.done(&format!("{orbit} -o a.gif --fps 25"));
    let file = std::io::BufReader::new(fs::File::open(place.path("a.gif")).unwrap());
    let decoder = image::codecs::gif::GifDecoder::new(file).unwrap();
    let decoded = decoder.into_frames().collect_frames().unwrap();
    assert_eq!(decoded.len(), 6);
    for (k, shown) in decoded.iter().enumerate() {
        assert_eq!(shown.delay().numer_denom_ms(), (40, 1));
        let rgb = image::DynamicImage::from(shown.buffer().clone()).into_rgb8();
        let (mean, max) = apart(&rgb.into_raw(), &frames[k]);
        assert!(mean < 1.0 && max < 32, "{k}: {mean} {max}");
    }
}

#[test]
fn videos_hold_the_frames_of_the_pictures() {
    let place = place();
    let orbit =
        format!("orbit v.nrrd --iso 70 --color #f08030 --size 95x71 --frames 6 {REFERENCE}");
    if Command::new("ffmpeg").arg("-version").output().is_err() {
        eprintln!("skipped: there is no ffmpeg");
        return;
    }
    place.done(&format!("{orbit} -o f/%02d.png"));
    for name in ["a.mp4", "a.webm"] {
        place.done(&format!("{orbit} -o {name} --fps 10"));
        let decoded = Command::new("ffmpeg")
            .args(["-loglevel", "error", "-i"])
            .arg(place.path(name))
            .args(["-vf", "scale=in_color_matrix=bt709", "-pix_fmt", "rgb24"])
            .args(["-f", "rawvideo", "-"])
            .output()
            .unwrap();
        assert_eq!(stderr(&decoded), "");
        // The sides are made even.
        let size = 96 * 72 * 3;
        assert_eq!(decoded.stdout.len(), 6 * size, "{name}");
        for k in 0..6 {
            let shown = &decoded.stdout[k * size..][..size];
            let rows = shown.chunks_exact(96 * 3).take(71);
            let shown: Vec<u8> = rows.flat_map(|row| &row[..95 * 3]).copied().collect();
            let frame = |k: usize| pixels(&place.path(&format!("f/{k:02}.png")));
            let (mean, _) = apart(&shown, &frame(k));
            let (other, _) = apart(&shown, &frame((k + 1) % 6));
            assert!(
                mean < 2.0 && other > 2.0 * mean,
                "{name} {k}: {mean} {other}"
            );
        }
    }
}

#[test]
fn without_ffmpeg_a_video_is_refused_before_any_work() {
    let place = place();
    let run = |name: &str| {
        let line = format!("orbit v.nrrd --iso 70 --size 16 --frames 2 -o {name} {REFERENCE}");
        place.command(&line).env("PATH", "").output().unwrap()
    };
    for name in ["a.mp4", "a.webm"] {
        let output = run(name);
        let messages = stderr(&output);
        assert_eq!(output.status.code(), Some(74), "{messages}");
        assert!(
            messages.contains("ffmpeg") && messages.contains("hint: install it"),
            "{messages}"
        );
        assert!(!place.path(name).exists());
    }
    // The control: what needs no ffmpeg is written.
    assert!(run("a.gif").status.success());
}
