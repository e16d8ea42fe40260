//! Who takes part in `angioray compare`: settings with names of their own, another renderer, what an
//! error bound chooses. Without a device what needs one says so and passes, unless REQUIRE_OPENCL=1.
#![cfg(unix)]

use crate::cli_place;
use crate::common;

use std::fs;

use std::path::{Path, PathBuf};

use angioray::frame::read_metadata;
use base64::prelude::{BASE64_STANDARD, Engine};
use cli_place::{Place, pixels, stderr};
use serde_json::Value;

const SMALL: &str = "compare ball.nrrd -o out --size 40x40 --repeats 1 --cache off";

/// A peer that draws black, 40 pixels a side, and whose second setting it dies of.
const PEER: &str = r#"echo '{"peer":"black","version":"9","device":"none","settings":[{"name":"night","modes":["mip","iso"]},{"name":"deadly","modes":["iso"]}]}'
while read -r line; do
case "$line" in
*'"load"'*) echo '{"loaded":1}' ;;
*'"deadly"'*) exit 3 ;;
*'"scene"'*) echo '{"ready":2.5,"supported":true,"note":"no light at all"}' ;;
*'"color"'*)
  head -c 25600 /dev/zero >"$(printf '%s' "$line" | sed 's/.*"color":"\([^"]*\)".*/\1/')"
  echo '{"ms":7}' ;;
*'"render"'*) echo '{"ms":6}' ;;
*) echo '{}' ;;
esac
done
"#;

fn with_peer(times: usize) -> Place {
    let place = Place::with_ball();
    place.write("peer.sh", PEER);
    let peers = ["'sh peer.sh'"].repeat(times).join(", ");
    place.write("peers.toml", &format!("peer = [{peers}]\n"));
    place
}

fn rows(place: &Place) -> Vec<Value> {
    let results = place.json("out/results.json");
    results["rows"].as_array().unwrap().clone()
}

#[test]
fn another_renderer_has_a_row_like_ours() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = with_peer(1);
    let printed = place.done(&format!("{SMALL} --modes mip --scene peers.toml {device}"));
    assert!(printed.contains("black 9: night"), "{printed}");
    assert!(printed.contains("no light at all"), "{printed}");
    let rows = rows(&place);
    let peer = rows
        .iter()
        .find(|row| row["renderer"] == "black 9")
        .unwrap();
    assert_eq!(peer["times_ms"]["frame"]["median"], 6.0);
    assert_eq!(peer["times_ms"]["prepare"], 2.5);
    // Black where the ball is white.
    assert_eq!(peer["error"]["color"]["max"], 1.0);
    let page = fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("no light at all"));
    // The control: ours draw the ball.
    for ours in rows.iter().filter(|row| row["renderer"] == "angioray") {
        assert!(ours["error"]["color"]["max"].as_f64().unwrap() < 1.0);
        assert_eq!(ours["note"], Value::Null);
    }
}

#[test]
fn a_peer_that_dies_costs_its_own_rows() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = with_peer(1);
    let line = format!("{SMALL} --modes iso --iso 100 --scene peers.toml {device}");
    let output = place.run(&line);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("2 of 10 settings failed"),
        "{}",
        stderr(&output)
    );
    let rows = rows(&place);
    let (failed, sound): (Vec<&Value>, Vec<&Value>) =
        rows.iter().partition(|row| !row["failure"].is_null());
    let names: Vec<&Value> = failed.iter().map(|row| &row["setting"]).collect();
    // One of which it died, and one that it can draw no more.
    assert_eq!(names, ["night", "deadly"]);
    assert_eq!(sound.len(), 8);
    assert!(sound.iter().all(|row| row["times_ms"]["repeats"] == 1));
    let page = fs::read_to_string(place.path("out/report.html")).unwrap();
    let why = failed[1]["failure"].as_str().unwrap();
    assert!(why.contains("black 9") && page.contains("ended"), "{why}");
}

#[test]
fn what_a_bound_chooses_takes_part_and_is_stored() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    place.write("one.toml", "[[setting]]\nname = 'coarse'\nstep = 4\n");
    let output = place.run(&format!(
        "{SMALL} --modes mip,dvr --configs one.toml --max-error value:1% {device}"
    ));
    assert!(output.status.success(), "{}", stderr(&output));
    let messages = stderr(&output);
    assert!(
        messages.contains("dvr: max-error value:0.01 has no meaning there"),
        "{messages}"
    );
    let results = place.json("out/results.json");
    let chosen = &results["max_error"]["mip"];
    assert_eq!(
        (&chosen["metric"], &chosen["met"]),
        (&"value".into(), &true.into())
    );
    assert!(results["max_error"]["dvr"].is_null());
    let rows = rows(&place);
    let names: Vec<&Value> = rows.iter().map(|row| &row["setting"]).collect();
    assert_eq!(names, ["coarse", "max-error value:0.01", "coarse"]);
    assert_eq!(rows[1]["flags"], chosen["chosen"]);
    let greatest = |row: &Value| row["error"]["value"]["max"].as_f64().unwrap();
    assert!(greatest(&rows[1]) <= 0.01);
    // The control: without it the bound would not be met.
    assert!(greatest(&rows[0]) > 0.01, "{}", greatest(&rows[0]));
}

#[test]
fn a_picture_says_how_to_make_it_again() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    place.write(
        "one.toml",
        "[[setting]]\nname = 'coarse'\nstep = 3\nprobe = 'off'\n",
    );
    place.done(&format!(
        "{SMALL} --modes iso --iso 100 --azimuth 25 --configs one.toml {device}"
    ));
    let results = place.json("out/results.json");
    let seen = &results["scenes"]["iso"];
    assert_eq!(
        (seen["iso"].as_f64(), seen["mode"].as_str()),
        (Some(100.0), Some("iso"))
    );
    let png = "out/pictures/iso-01-coarse.png";
    let text = |file: &str| {
        let metadata = read_metadata(&place.path(file)).unwrap();
        assert!(metadata.iter().any(|(key, _)| key == "version"), "{file}");
        let (_, scene) = metadata
            .into_iter()
            .find(|(key, _)| key == "scene")
            .unwrap();
        scene
    };
    place.write("again.toml", &text(png));
    place.done(&format!("render -o again.png --scene again.toml {device}"));
    let decoded = |file: &str| pixels(&place.path(file));
    assert!(decoded("again.png") == decoded(png));
    // The control: the reference's own scene says nothing of steps, and is another picture.
    place.write("other.toml", &text("out/pictures/iso-00-reference.png"));
    place.done(&format!("render -o other.png --scene other.toml {device}"));
    assert!(decoded("other.png") != decoded(png));
}

/// The files under a folder.
fn files_under(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let files = entries.flat_map(|path| match path.is_dir() {
        true => files_under(&path),
        false => vec![path],
    });
    files.collect()
}

/// What a file says in words: a page with its embedded pictures' texts, a picture's texts.
fn words_of(file: &Path) -> String {
    let texts_of = |picture: &Path| {
        let texts = read_metadata(picture).unwrap().into_iter();
        texts.map(|(key, text)| key + &text).collect::<String>()
    };
    match file.extension().and_then(|ending| ending.to_str()) {
        Some("png" | "exr") => texts_of(file),
        _ => {
            let text = fs::read_to_string(file).unwrap();
            let embedded = text.split("data:image/png;base64,").skip(1);
            let embedded: String = embedded
                .map(|rest| {
                    let png = BASE64_STANDARD.decode(rest.split('"').next().unwrap());
                    let file = tempfile::NamedTempFile::new().unwrap();
                    fs::write(file.path(), png.unwrap()).unwrap();
                    texts_of(file.path())
                })
                .collect();
            text + &embedded
        }
    }
}

#[test]
fn a_comparison_that_is_passed_on_does_not_say_where_things_lay() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    let folder = place.path("");
    let folder = folder.to_str().unwrap();
    place.write("peer.sh", PEER);
    place.write("scene.toml", &format!("peer = [\"sh {folder}/peer.sh\"]\n"));
    place.write(
        "tf.toml",
        "points = [[0, 0, 0, 0, 0], [200, 1, 1, 1, 0.5]]\n",
    );
    place.write(
        "one.toml",
        "[[setting]]\nname = 'coarse'\nstep = 3\n[[setting]]\nname = '=1+1'\nstep = 2\n",
    );
    let line = format!(
        "compare {folder}/ball.nrrd -o {folder}/out --size 40x40 --repeats 1 --modes iso,mip,dvr \
         --configs {folder}/one.toml --scene={folder}/scene.toml --cache {folder}/cache {device}"
    );
    // One of the peer's settings kills it.
    let output = place.run(&line);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let name = Path::new(folder).file_name().unwrap().to_str().unwrap();
    let files = files_under(&place.path("out"));
    assert!(files.len() > 30);
    for file in files {
        let words = words_of(&file);
        assert!(!words.contains(name), "{}: {words}", file.display());
        let is_map = file.to_str().unwrap().contains("-error.");
        let is_csv = file.extension().is_some_and(|ending| ending == "csv");
        assert!(
            is_map || is_csv || words.contains("ball.nrrd"),
            "{}",
            file.display()
        );
    }
    let results = place.json("out/results.json");
    assert_eq!(results["volume"]["file"], "ball.nrrd");
    assert_eq!(results["scenes"]["mip"]["volume"], "ball.nrrd");
    let command = results["command_line"].as_str().unwrap();
    let expected = "angioray compare ball.nrrd -o out --size 40x40 --repeats 1 --modes iso,mip,dvr \
                    --configs one.toml --scene=scene.toml --cache cache";
    assert!(command.starts_with(expected), "{command}");
    let csv = fs::read_to_string(place.path("out/results.csv")).unwrap();
    assert!(
        csv.contains(",\"'=1+1\",") && !csv.contains(",=1+1,"),
        "{csv}"
    );

    // The control: a picture of its own keeps the place, and is found.
    place.done(&format!(
        "render {folder}/ball.nrrd -o one.png --size 8x8 {device}"
    ));
    assert!(words_of(&place.path("one.png")).contains(name));
}

#[test]
fn long_work_in_a_pipe_reports_what_is_being_done() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    // It takes longer to read than lines are apart, and has a name that would move the cursor.
    let slow = PEER.replace("*'\"load\"'*)", "*'\"load\"'*) sleep 7;");
    place.write("peer.sh", &slow.replace("\"black\"", "\"bl\\u202eack\""));
    place.write("peers.toml", "peer = 'sh peer.sh'\n");
    let output = place.run(&format!("{SMALL} --modes mip --scene peers.toml {device}"));
    let messages = stderr(&output);
    assert!(output.status.success(), "{messages}");
    let line = messages
        .lines()
        .find(|line| line.contains("loads the volume"));
    let line = line.unwrap_or_else(|| panic!("no such line: {messages}"));
    assert!(
        line.starts_with("bl\\u{202e}ack loads the volume ") && line.ends_with(" s"),
        "{line}"
    );
    assert!(
        !messages.contains(['\u{1b}', '\r', '\u{202e}']),
        "{messages}"
    );
}

#[test]
fn a_report_opens_on_the_fastest_and_shows_modes_side_by_side() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    place.write(
        "three.toml",
        "[[setting]]\nname = 'exact'\nmodes = ['iso', 'mip']\nsampling = 'exact'\n\
         [[setting]]\nname = 'rough'\nmodes = ['mip']\nstep = 2\nprobe = 'off'\n[[setting]]\nname = 'coarse'\nstep = 3\nprobe = 'off'\n",
    );
    place.done(&format!(
        "{SMALL} --modes iso,mip --iso 100 --configs three.toml {device}"
    ));
    let page = fs::read_to_string(place.path("out/report.html")).unwrap();
    let galleries: Vec<&str> = page.split("class=\"gallery card\"").skip(1).collect();
    assert_eq!(galleries.len(), 2);
    let rows = rows(&place);
    for (gallery, mode) in galleries.iter().zip(["iso", "mip"]) {
        let opens_on = gallery.split('"').nth(1).unwrap().parse::<usize>().unwrap();
        let label = gallery.split("data-label=\"").nth(opens_on + 1).unwrap();
        let label = label.split('"').next().unwrap();
        // Exact casting has nothing to show beside the reference, however fast it was.
        assert_ne!(label, "exact", "{mode}");
        let ms = |row: &&Value| row["times_ms"]["frame"]["median"].as_f64().unwrap();
        let others = rows
            .iter()
            .filter(|row| row["mode"] == mode && row["setting"] != "exact");
        let fastest = others.min_by(|a, b| ms(a).total_cmp(&ms(b))).unwrap();
        assert_eq!(fastest["setting"], label, "{mode}");
    }
    let (_, pairs) = page.split_once("class=\"pairs card\"").unwrap();
    let (_, data) = pairs
        .split_once("<script type=\"application/json\">")
        .unwrap();
    let data: Value = serde_json::from_str(data.split("</script>").next().unwrap()).unwrap();
    let settings: Vec<&Value> = data
        .as_array()
        .unwrap()
        .iter()
        .map(|one| &one["label"])
        .collect();
    assert_eq!(settings, ["reference", "exact", "coarse"]);
    let modes = |at: usize| data[at]["pictures"].as_array().unwrap().len();
    assert!((0..3).all(|at| modes(at) == 2), "{data}");

    // The control: one mode has nothing to stand beside.
    place.done(&format!(
        "{SMALL} --modes mip --configs three.toml {device}"
    ));
    let page = fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(!page.contains("class=\"pairs card\""));
}

#[test]
fn a_figure_has_one_unit_in_finding_and_table() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::empty();
    // Thin enough that coarse steps miss some of it.
    place.done("phantom vessels -o ball.nrrd --size 24 --seed 3");
    place.write(
        "one.toml",
        "[[setting]]\nname = 'coarse'\nstep = 3\nprobe = 'off'\nquad = 'riemann'\n",
    );
    place.write(
        "two.toml",
        "[[setting]]\nname = 'coarse'\nstep = 3\nprobe = 'off'\n",
    );
    for (mode, configs, column) in [
        ("iso", "two", "missed or added, %"),
        ("mip", "two", "value rmse, %"),
        ("dvr", "one", "colour rmse, %"),
    ] {
        place.done(&format!(
            "{SMALL} --modes {mode} --configs {configs}.toml {device}"
        ));
        let results = place.json("out/results.json");
        let finding = results["findings"][0].as_str().unwrap();
        let reported = finding.rsplit("coarse (").next().unwrap();
        let reported = reported.trim_end_matches(')').rsplit(", ").next().unwrap();
        let page = fs::read_to_string(place.path("out/report.html")).unwrap();
        let table = page.split("class=\"sortable\"").nth(1).unwrap();
        let cells = |of: &str, tag: &str| -> Vec<String> {
            let cells = of
                .split(tag)
                .skip(1)
                .map(|cell| cell.split_once('>').unwrap().1);
            cells
                .map(|cell| cell.split('<').next().unwrap().to_owned())
                .collect()
        };
        let (head, body) = table.split_once("</thead>").unwrap();
        let at = cells(head, "<th ").iter().position(|title| title == column);
        let at = at.unwrap_or_else(|| panic!("{mode} has no column {column}: {head}"));
        // The row's first cell is its head.
        let shown = &cells(body, "<td ")[at - 1];
        let number = |text: &str| {
            text.parse::<f64>()
                .unwrap_or_else(|_| panic!("{text}: {finding}"))
        };
        let (reported, shown) = (number(reported), number(shown));
        assert!(
            reported > 0.0 && (reported - shown).abs() <= 0.01 * reported,
            "{mode}: {finding}: {shown}"
        );
    }
}

#[test]
fn names_that_would_be_taken_for_another_are_refused() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = with_peer(2);
    for (file, settings) in [
        (
            "reference.toml",
            "[[setting]]\nname = 'reference'\nstep = 1\n",
        ),
        ("given.toml", "[[setting]]\nname = 'as given'\nstep = 1\n"),
        (
            "bound.toml",
            "[[setting]]\nname = 'max-error rmse:0.1'\nstep = 1\n",
        ),
        (
            "mip.toml",
            "[[setting]]\nname = 'a'\nmodes = ['mip']\nstep = 1\n",
        ),
    ] {
        place.write(file, settings);
    }
    for (line, wanted) in [
        ("--configs reference.toml", "called 'reference'"),
        ("--configs given.toml --step 2", "called 'as given'"),
        (
            "--configs bound.toml --max-error rmse:0.1",
            "called 'max-error rmse:0.1'",
        ),
        ("--scene peers.toml", "called 'black 9: night'"),
        ("--configs mip.toml", "no setting for mode 'iso'"),
        (
            "--quad simpson",
            "'quad' cannot be combined with mode 'iso'",
        ),
        ("--max-error value:1%", "only a projection shows values"),
    ] {
        let line = format!("{SMALL} --modes iso --iso 100 {device} {line}");
        let message = place.refused(&line, 2);
        assert!(message.contains(wanted), "{line}: {message}");
    }
    let message = place.refused(&format!("{SMALL} --modes mip --refine none {device}"), 2);
    assert!(
        message.contains("'refine' cannot be combined with mode 'mip'"),
        "{message}"
    );
    // The control: alone each of these is fine, and a file's modes are those that are compared.
    place.done(&format!("{SMALL} --configs mip.toml {device}"));
    assert_eq!(rows(&place).len(), 1);
}

#[test]
fn an_earlier_comparison_leaves_nothing_behind() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    place.write("one.toml", "[[setting]]\nname = 'a'\nstep = 1\n");
    let line = format!("{SMALL} --configs one.toml {device}");
    place.done(&format!("{line} --modes iso --iso 100"));
    let of_iso = place.path("out/pictures/iso-01-a.png");
    assert!(of_iso.exists());
    place.done(&format!("{line} --modes mip"));
    assert!(!of_iso.exists());
    assert!(place.path("out/pictures/mip-01-a.png").exists());
}

#[test]
fn a_flat_volume_is_compared_too() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::empty();
    place.write(
        "flat.nrrd",
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3 3 3\nencoding: ascii\n\n\
         7 7 7 7 7 7 7 7 7 7 7 7 7 7 7 7 7 7 7 7 7 7 7 7 7 7 7\n",
    );
    let line = "compare flat.nrrd -o out --size 40x40 --repeats 1 --cache off --modes mip";
    place.done(&format!("{line} {device}"));
    let rows = rows(&place);
    assert!(rows.len() >= 6);
    for row in &rows {
        assert_eq!(row["failure"], Value::Null, "{}", row["setting"]);
        assert_eq!(row["error"]["value"], Value::Null);
        assert!(row["error"]["color"]["rmse"].as_f64().unwrap() < 1e-6);
    }
}

#[test]
fn without_a_cache_folder_nothing_is_cached_and_all_else_works() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    fs::create_dir(place.path("home")).unwrap();
    place.write("home/angioray", "");
    place.write("one.toml", "[[setting]]\nname = 'a'\nstep = 1\n");
    let line = format!(
        "compare ball.nrrd -o out --size 40x40 --repeats 1 --modes mip --configs one.toml {device}"
    );
    let output = place
        .command(&line)
        .env("XDG_CACHE_HOME", place.path("home"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let messages = stderr(&output);
    assert!(messages.contains("pictures are not cached"), "{messages}");
    assert_eq!(rows(&place).len(), 1);
    fs::remove_dir_all(place.path("out")).unwrap();
    // One that the user names has to work.
    let message = place.refused(&format!("{line} --cache home/angioray"), 74);
    assert!(message.contains("--cache off"), "{message}");
}
