//! Peers that end, babble, fall silent or draw nothing: each costs a sentence, and never a wait
//! without end. The peers here are shell scripts.
#![cfg(unix)]

use crate::fake_peer;

use std::time::{Duration, Instant};

use angioray::lab::measure::Peer;
use angioray::scene::{Emission, Knot, Picture, Rgb, TransferFunction};

use fake_peer::{
    Fake, HELLO, LOAD, NAN, ONE, READY, ZERO, maximum, prepared, refusal, renders, scene_of,
    two_pixels, volume,
};

#[test]
fn planes_that_are_none_are_refused() {
    let render = |color: &str, depth| {
        let fake = Fake::answering(&[LOAD, READY, &renders(color, depth)]);
        refusal(&fake)
    };
    assert_eq!(
        render(&[ONE; 7].concat(), None),
        "the peer fake 1.2 wrote 28 bytes of color.f32: a picture of 2x1 has 32"
    );
    let nan = [[ONE; 4], [NAN; 4]].concat().concat();
    assert!(render(&nan, None).ends_with("infinite or NaN"));
    let depth = [ZERO, NAN].concat();
    assert!(render(&two_pixels(), Some(&depth)).ends_with("negative or NaN"));

    let forgets = r#"*'"render"'*) echo '{"ms":1}' ;;"#;
    assert!(
        refusal(&Fake::answering(&[LOAD, READY, forgets])).ends_with("did not write color.f32")
    );
    let quick = r#"*'"render"'*) echo '{"ms":-1}' ;;"#;
    assert!(refusal(&Fake::answering(&[LOAD, READY, quick])).ends_with("took -1 ms"));
}

#[test]
fn a_setting_that_no_line_of_ours_can_name_is_refused() {
    let hello = |name: &str| {
        let settings = format!(r#"[{{"name":"{name}","modes":["mip"]}}]"#);
        Fake::new(&format!(
            "printf '%s\\n' '{{\"peer\":\"fake\",\"version\":\"1\",\"device\":\"none\",\"settings\":{settings}}}'\ncat >/dev/null\n"
        ))
    };
    for name in ["two\\nlines", &"long".repeat(200)] {
        let message = hello(name).start().err().unwrap().to_string();
        assert!(message.contains("control character"), "{message}");
    }
    // The control: any other goes back as it came.
    let peer = hello("step 0.5, \u{fc}ber").start().unwrap();
    assert_eq!(peer.settings("mip"), ["step 0.5, über"]);
}

#[test]
fn a_peer_that_babbles_is_quoted() {
    let babbles = r#"*'"render"'*) echo 'Warning: no depth buffer' ;;"#;
    assert_eq!(
        refusal(&Fake::answering(&[LOAD, READY, babbles])),
        "the peer fake 1.2 was to render and answered 'Warning: no depth buffer', which is not a JSON object"
    );
    let other = r#"*'"load"'*) echo '{"milliseconds":1}' ;;"#;
    let message = refusal(&Fake::answering(&[other]));
    assert!(
        message.contains("gave another answer: missing field `loaded`"),
        "{message}"
    );
    let twice = r#"*'"load"'*) printf '{"loaded":1}\nmore\n' ;;"#;
    let fake = Fake::answering(&[twice, READY]);
    let volume = volume();
    let mut peer = fake.start().unwrap();
    peer.load(&volume).unwrap();
    let message = peer.load(&volume).unwrap_err().to_string();
    assert!(message.contains("'more'"), "{message}");
    // Without end, and without a line's end.
    let error = Fake::new("yes | tr -d '\\n'").start().err().unwrap();
    assert!(error.to_string().contains("yyy…"), "{error}");
}

#[test]
fn a_peer_that_ends_is_quoted_and_stays_ended() {
    let dies = r#"*'"render"'*) echo 'no display: giving up' >&2; exit 3 ;;"#;
    let fake = Fake::answering(&[LOAD, READY, dies]);
    let volume = volume();
    let mut peer = fake.start().unwrap();
    peer.load(&volume).unwrap();
    let scene = prepared(&mut peer, &volume, &scene_of(&volume, maximum())).unwrap();
    let first = peer.render(&scene).unwrap_err().to_string();
    assert_eq!(
        first,
        "the peer fake 1.2 ended (exit status: 3) where it was to render: no display: giving up"
    );
    assert_eq!(peer.time(&scene).unwrap_err().to_string(), first);

    let at_once = Fake::new("exit 0");
    let message = at_once.start().err().unwrap().to_string();
    let expected = format!(
        "the peer '{}' ended (exit status: 0) where it was to say hello",
        at_once.command
    );
    assert_eq!(message, expected);
}

#[test]
fn a_silent_peer_is_not_waited_for() {
    let start = Instant::now();
    let silent = Fake::new("exec sleep 600");
    let outcome = Peer::start_with_patience(&silent.command, Duration::from_millis(300));
    let message = outcome.err().unwrap().to_string();
    assert!(
        message.ends_with("was to say hello and has not answered for 0.3 s"),
        "{message}"
    );
    // Nor is one that does not listen: a transfer function larger than any pipe.
    let deaf = Fake::new(&format!("{HELLO}\nexec sleep 600"));
    let mut peer = Peer::start_with_patience(&deaf.command, Duration::from_secs(4)).unwrap();
    let volume = volume();
    let knots = (0..4096).map(|i| Knot {
        value: -100.0 + f64::from(i) / 37.0,
        color: Rgb([0.123_456_789_012_345; 3]),
        opacity: 0.123_456_789_012_345,
    });
    let transfer = TransferFunction::new(knots.collect(), 1.0).unwrap();
    let scene = scene_of(&volume, Picture::Emission(Emission::of(transfer)));
    assert!(peer.prepare(&volume, &scene, "fine").is_err());
    drop(peer);
    assert!(start.elapsed() < Duration::from_secs(300));
}

#[test]
fn a_command_that_is_none_is_refused() {
    for (command, exit_code) in [("", 2), ("'unfinished", 2), ("/nowhere/a-peer", 1)] {
        let error = Peer::start(command).err().unwrap();
        assert_eq!(error.exit_code(), exit_code, "{error}");
        assert!(error.to_string().contains(command), "{error}");
    }
}
