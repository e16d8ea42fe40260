//! `angioray bench` from outside: its list of experiments, its tables and files. Without a device
//! what needs one says so and passes, unless REQUIRE_OPENCL=1.

use crate::cli_place;
use crate::common;

use cli_place::{Place, stderr};

const EXPERIMENTS: [&str; 24] = [
    "vessels",
    "pareto",
    "speed",
    "sparse",
    "effects",
    "sparse-rays",
    "traversals",
    "convergence",
    "rays",
    "gradients",
    "b1",
    "b2",
    "b3",
    "b4",
    "b8",
    "b9",
    "b10",
    "b13",
    "b15",
    "b16",
    "b17",
    "b18",
    "tolerance",
    "check-sampling",
];

#[test]
fn the_help_lists_every_experiment_and_has_an_example() {
    let help = Place::empty().done("bench --help");
    let (_, examples) = help.split_once("Example:").unwrap();
    assert!(examples.contains("angioray bench vessels"), "{help}");
    for name in EXPERIMENTS {
        assert!(help.contains(&format!("  {name}: ")), "{name}: {help}");
    }
}

#[test]
fn wrong_usage_is_refused_with_what_there_is() {
    let place = Place::with_ball();
    place.write("quick.toml", "quick = true\n");
    place.write("both.toml", "quick = true\nfull = true\n");
    for line in ["bench", "bench vesels"] {
        let message = place.refused(line, 2);
        let (_, hint) = message.split_once("hint: ").unwrap();
        assert!(
            EXPERIMENTS.iter().all(|name| hint.contains(name)),
            "{message}"
        );
    }
    for (line, wanted) in [
        ("bench rays ball.nrrd", "takes no volumes"),
        ("bench vessels --rays 5", "no effect"),
        ("bench vessels --seed 5", "no effect"),
        ("bench vessels --frames 5", "no effect"),
        ("bench b1 --peer true", "no effect"),
        (
            "bench speed --frames 0",
            "is not a whole number of at least 1",
        ),
        ("bench rays --rays 0", "is not a whole number of at least 1"),
        ("bench vessels --quick --full", "cannot be combined"),
        ("bench vessels --scene both.toml", "cannot be combined"),
        // A flag wins over the file: what is refused is another thing.
        (
            "bench vessels --scene quick.toml --full --device reference",
            "cannot be measured",
        ),
        (
            "bench vessels --quick=off --full --device reference",
            "cannot be measured",
        ),
        ("bench vessels --device reference", "cannot be measured"),
        ("bench b1 --iso 3", "no effect without a volume"),
        ("bench b1 ball.nrrd --iso 3x", "not a value"),
        ("bench rays --protocol orbit", "times no frames"),
        ("bench speed --protocol orbit", "moves the camera by itself"),
        ("bench b1 --protocol still", "not a protocol"),
        ("bench b1 --restart", "no effect without '--output'"),
    ] {
        let message = place.refused(line, 2);
        assert!(message.contains(wanted), "{line}: {message}");
    }
}

#[test]
fn what_cannot_be_read_or_written_fails_before_the_work() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::empty();
    let message = place.refused(&format!("bench vessels none.nrrd {device}"), 65);
    assert!(message.contains("none.nrrd"), "{message}");
    place.done("phantom sphere -o ball.nrrd --size 16");
    for iso in ["-1", "201"] {
        let message = place.refused(&format!("bench b1 ball.nrrd --iso {iso} {device}"), 2);
        assert!(message.contains("lies outside"), "{message}");
        assert!(message.contains("0 to 200"), "{message}");
    }
    std::fs::create_dir_all(place.path("page/report.html")).unwrap();
    let output = place.run(&format!("bench convergence -o page {device}"));
    assert_eq!(output.status.code(), Some(74));
    assert!(stderr(&output).contains("report.html: cannot write"));
    place.write("taken", "");
    let line = format!("bench convergence -o taken {device}");
    let output = place.run(&line);
    assert_eq!(output.status.code(), Some(74));
    assert!(output.stdout.is_empty(), "{line}");
    assert!(stderr(&output).contains("taken: cannot make the folder"));
}

/// The rows of a Markdown table, each as its cells.
fn rows(markdown: &str) -> Vec<Vec<&str>> {
    let lines = markdown.lines().filter(|line| line.starts_with('|'));
    lines
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect()
}

#[test]
fn vessels_end_in_a_table_and_leave_it_as_files() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    let line = format!("bench vessels ball.nrrd --quick -o out/first {device}");
    let printed = place.done(&line);
    let rows = rows(&printed);
    let volumes = ["vessel of radius 0.5", "vessel of radius 2.5", "ball"];
    for volume in volumes {
        let of_volume = rows.iter().filter(|row| row[0] == volume);
        let missed = |method: &str| {
            let mut row = of_volume.clone().filter(|row| row[1] == method);
            row.next().unwrap()[2].parse::<f64>().unwrap()
        };
        assert_eq!(missed("exact"), 0.0);
        assert_eq!(of_volume.clone().count(), 22);
        // The control: there is something to miss.
        assert!(missed("step 2, none") > 1.0, "{volume}");
    }
    let findings = printed.lines().filter(|line| line.starts_with("- exact"));
    assert_eq!(findings.count(), 3, "{printed}");

    let json = place.json("out/first/results.json");
    assert_eq!(json["experiment"], "vessels");
    let in_json = json["rows"].as_array().unwrap();
    assert_eq!(in_json.len(), 5 * 22);
    let csv = std::fs::read_to_string(place.path("out/first/results.csv")).unwrap();
    let (keys, lines) = csv.split_once("\r\n").unwrap();
    assert!(keys.starts_with("volume,method,missed_share,"), "{keys}");
    assert_eq!(lines.lines().count(), in_json.len());
    assert!(csv.contains("\"step 0.5, regula-falsi:5, probe\""));
    let share = in_json[0]["missed_share"].as_f64().unwrap();
    assert!(csv.contains(&format!(",{share},")), "{share}");
    let of = place.path("out/first");
    let files = std::fs::read_dir(of).unwrap().count();
    assert_eq!(files, 3, "something temporary is left");
    let page = std::fs::read_to_string(place.path("out/first/report.html")).unwrap();
    assert!(page.contains("angioray bench vessels ball.nrrd --quick"));
    assert!(page.contains("step 0.5, regula-falsi:5, probe"));
    assert!(page.contains("Surface: time against hits missed"));
    // What was run, for those who find the file.
    let text_of = |key: &str| json["run"][key].as_str().unwrap().to_owned();
    assert_eq!(text_of("effort"), "quick");
    assert!(text_of("volumes").starts_with("ball (16x16x16"), "{json:#}");
    let line = json["command_line"].as_str().unwrap();
    assert!(line.starts_with("angioray bench vessels ball.nrrd --quick"));
    assert_eq!(json["size"], serde_json::json!([128, 128]));
    assert_eq!(
        (&json["repeats"], &json["protocol"]),
        (&3.into(), &"static".into())
    );
}

#[test]
fn traversals_of_a_volume_give_the_same_bytes() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::with_ball();
    std::fs::rename(place.path("ball.nrrd"), place.path("=1+1.nrrd")).unwrap();
    let [volume, out] = ["=1+1.nrrd", "out"].map(|name| place.path(name));
    let [volume, out] = [volume, out].map(|path| path.display().to_string());
    let line = format!("bench traversals {volume} --quick -o {out} {device}");
    let printed = place.done(&line);
    let rows = rows(&printed);
    let same = rows.iter().filter(|row| row.last() == Some(&"yes"));
    assert_eq!(same.count(), 5 * 5, "{printed}");
    assert!(printed.contains("is the fastest of all"), "{printed}");

    // What a spreadsheet would take for a formula is text in the CSV, and as it is elsewhere.
    let csv = std::fs::read_to_string(place.path("out/results.csv")).unwrap();
    let lines: Vec<&str> = csv.split_terminator("\r\n").skip(1).collect();
    assert!(lines.len() >= 25 && !csv.contains("\r\n="), "{csv}");
    assert!(
        lines.iter().all(|line| line.starts_with("\"'=1+1\",")),
        "{csv}"
    );
    let json = place.json("out/results.json");
    assert_eq!(json["rows"][0]["volume"], "=1+1");
    assert!(json["rows"][0]["median_ms"].is_number(), "{json:#}");

    // Where the files lay is private; the control: they are named.
    let folder = place.path("").file_name().unwrap().display().to_string();
    for file in ["results.json", "results.csv", "report.html"] {
        let text = std::fs::read_to_string(place.path("out").join(file)).unwrap();
        assert!(!text.contains(&folder), "{file} names {folder}");
        assert!(text.contains("=1+1"), "{file}");
    }
    let again = "angioray bench traversals =1+1.nrrd --quick -o out";
    assert!(
        json["command_line"].as_str().unwrap().starts_with(again),
        "{json:#}"
    );
}

#[test]
fn the_other_experiments_end_in_tables() {
    let Some(device) = common::device_flag() else {
        return;
    };
    let place = Place::empty();
    let of = |line: &str| place.done(&format!("bench {line} --quick {device}"));
    let convergence = of("convergence");
    let rows_of = rows(&convergence);
    let row = |name: &str| rows_of.iter().find(|row| row[1] == name).unwrap();
    let order = |name: &str| row(name)[3].parse::<f64>().unwrap();
    assert!((order("riemann") - 1.0).abs() < 0.15, "{convergence}");
    assert!((order("simpson") - 4.0).abs() < 0.15, "{convergence}");
    let gradients = of("gradients");
    let rows_of = rows(&gradients);
    let angle = |name: &str| {
        let row = rows_of.iter().find(|row| row[1] == name).unwrap();
        row[3].parse::<f64>().unwrap()
    };
    // Half a voxel aside is worse than centred, and the reference favours no gradient.
    assert!(angle("central") > 0.0 && angle("central") < 0.5 * angle("forward"));
    let rays = of("rays --rays 3000");
    let all = rows(&rays).pop().unwrap();
    assert_eq!((all[0], all[1], all[3]), ("all", "3000", "0"), "{rays}");
    // The default seed, and another.
    assert_eq!(of("rays --rays 3000 --seed 4"), rays);
    assert_ne!(of("rays --rays 3000 --seed 5"), rays);
}
