//! The page in which a comparison ends, in a browser: it works, it says what it was given, and it
//! asks nobody for anything. Needs Chromium; skips without, unless `REQUIRE_CHROMIUM=1`.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use angioray::report::{
    Axis, Bar, Bars, ErrorMap, Gallery, Mark, Picture, Point, Report, Scale, Scatter, Section,
    Shown, Table,
};
use serde_json::Value;

const HOSTILE: &str = "</script><script>throw 1</script><img src=x onerror=alert(1)>\"'&amp;<!--";

fn chromium() -> Option<PathBuf> {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let found = std::env::split_paths(&paths)
        .flat_map(|folder| names.map(|name| folder.join(name)))
        .find(|program| program.exists());
    if found.is_none() {
        let required = std::env::var("REQUIRE_CHROMIUM").is_ok_and(|v| v == "1");
        assert!(!required, "REQUIRE_CHROMIUM=1, but there is no Chromium");
        eprintln!("skipped: there is no Chromium");
    }
    found
}

/// What the browser made of a page.
struct Seen {
    dom: String,
    /// Messages of the console, and the browser's about the page.
    console: Vec<String>,
}

impl Seen {
    /// An attribute of the root element.
    fn root(&self, name: &str) -> Option<String> {
        let root = &self.dom[self.dom.find("<html")?..];
        let root = &root[..root.find("<head")?];
        let (_, rest) = root.split_once(&format!(" {name}=\""))?;
        let text = rest.split_once('"')?.0;
        let text = text.replace("&quot;", "\"").replace("&lt;", "<");
        Some(text.replace("&gt;", ">").replace("&amp;", "&"))
    }

    fn probe(&self) -> Value {
        let text = self.root("data-probe");
        serde_json::from_str(&text.expect("the probe ran")).unwrap()
    }

    /// What is wrong with the page, by both witnesses and its images.
    fn faults(&self) -> Vec<String> {
        let mut faults = self.console.clone();
        faults.extend(self.root("data-faults"));
        let loaded = self.root("data-images-loaded").unwrap_or_default();
        match loaded.split_once('/') {
            Some((shown, all)) if shown == all => {}
            _ => faults.push(format!("images loaded: {loaded}")),
        }
        faults
    }
}

/// On a desk, and in a hand: width and height of the window.
const DESK: (u32, u32) = (1200, 900);
const PHONE: (u32, u32) = (390, 844);

/// Opens a page with a script at its end that runs when all is loaded, and gives what became of it.
/// `value` is the script's result.
fn open(chromium: &Path, page: &str, value: &str) -> Seen {
    open_in(chromium, page, value, DESK, &[])
}

/// The page in a frame of a size, whose findings the page around it takes over: Chromium's own window
/// is never narrower than 500 pixels.
fn framed(page: &str, (width, height): (u32, u32)) -> String {
    let page = page.replace('&', "&amp;").replace('"', "&quot;");
    format!(
        "<!DOCTYPE html><html><head></head><body style='margin:0'>\
         <iframe style='width:{width}px;height:{height}px;border:0' srcdoc=\"{page}\"></iframe>\
         <script>addEventListener('load', () => setTimeout(() => Object.assign(document.documentElement.dataset,\
         document.querySelector('iframe').contentDocument.documentElement.dataset), 1000));</script></body></html>"
    )
}

/// The same in a window of a size, with more flags of Chromium's.
fn open_in(chromium: &Path, page: &str, value: &str, window: (u32, u32), flags: &[&str]) -> Seen {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let probe = format!(
        "<script>addEventListener('load', () => {{ const all = (s) => [...document.querySelectorAll(s)];\n\
         const text = (s) => all(s).map((e) => e.textContent);\n\
         document.documentElement.dataset.probe = JSON.stringify((() => {{ {value} }})()); }});</script>"
    );
    let (before, after) = page.rsplit_once("</body>").unwrap();
    let page = framed(&format!("{before}{probe}</body>{after}"), window);
    fs::write(at("page.html"), page).unwrap();
    let mut child = Command::new(chromium)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--disable-dev-shm-usage",
            "--enable-logging=stderr",
            "--v=0",
            "--window-size=1200,900",
            "--hide-scrollbars",
            "--virtual-time-budget=3000",
            "--dump-dom",
        ])
        .args(flags)
        .arg(format!("--user-data-dir={}", at("profile").display()))
        .arg(format!("file://{}", at("page.html").display()))
        .stdin(Stdio::null())
        .stdout(File::create(at("dom")).unwrap())
        .stderr(File::create(at("log")).unwrap())
        .spawn()
        .unwrap();
    let until = Instant::now() + Duration::from_secs(120);
    while child.try_wait().unwrap().is_none() {
        if Instant::now() > until {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("Chromium did not end");
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let text = |name: &str| String::from_utf8_lossy(&fs::read(at(name)).unwrap()).into_owned();
    let log = text("log");
    let console = log.lines().filter(|line| line.contains("CONSOLE"));
    Seen {
        dom: text("dom"),
        console: console.map(str::to_owned).collect(),
    }
}

/// A PNG of one colour.
fn png(color: [u8; 3]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 8, 6);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&color.repeat(48)).unwrap();
    writer.finish().unwrap();
    bytes
}

fn picture(label: &str, gray: u8, error_map: Option<ErrorMap>) -> Picture {
    Picture {
        label: label.into(),
        caption: format!("caption of {label}"),
        png: png([gray; 3]),
        error_map,
    }
}

fn map() -> ErrorMap {
    ErrorMap {
        png: png([200, 10, 10]),
        label: format!("error {HOSTILE}"),
        unit: "voxels".into(),
        scale: Scale::linear(-0.5, 0.5, &[[0, 0, 255], [255; 3], [255, 0, 0]]),
        marks: vec![Mark {
            color: [230, 159, 0],
            meaning: HOSTILE.into(),
        }],
    }
}

fn point(label: &str, group: &str, x: f64, y: f64, on_front: bool) -> Point {
    Point {
        label: label.into(),
        group: group.into(),
        x,
        y,
        on_front,
        details: vec![("samples".into(), HOSTILE.into())],
    }
}

fn table() -> Table {
    let columns = [
        ("name", "name", Shown::Short),
        ("ms", "time, ms", Shown::Fixed(1)),
    ];
    let mut table = Table::new(&columns);
    table.push(vec![HOSTILE.into(), 100.0.into()]);
    table.push(vec!["none".into()]);
    table.push_on_front(vec!["fast".into(), 9.5.into()]);
    table
}

fn report() -> Report {
    let full = Section {
        title: HOSTILE.into(),
        about: HOSTILE.into(),
        gallery: Some(Gallery {
            pictures: vec![
                picture("exact", 250, None),
                picture(HOSTILE, 100, Some(map())),
                picture("step 2", 50, Some(map())),
            ],
        }),
        scatters: vec![Scatter {
            title: HOSTILE.into(),
            x: Axis {
                label: "time".into(),
                unit: "ms".into(),
            },
            y: Axis {
                label: "rmse".into(),
                unit: String::new(),
            },
            points: vec![
                point("step 2", "fixed", 3.0, 0.02, true),
                point(HOSTILE, "fixed", 12.0, 1e-4, true),
                point("exact", HOSTILE, 40.0, 0.0, true),
                point("slow", "fixed", 90.0, 0.5, false),
                point("failed", "fixed", f64::NAN, 0.5, false),
            ],
        }],
        bars: Some(Bars {
            title: HOSTILE.into(),
            unit: "ms".into(),
            rows: vec![Bar {
                label: HOSTILE.into(),
                parts: vec![("cast".into(), 8.0), (HOSTILE.into(), 2.0)],
            }],
        }),
        table: Some(table()),
    };
    let sparse = Section {
        title: "sparse".into(),
        gallery: Some(Gallery {
            pictures: vec![picture("only", 90, None)],
        }),
        scatters: vec![
            Scatter {
                points: vec![point("zero", "g", 1.0, 0.0, true)],
                ..Scatter::default()
            },
            Scatter::default(),
        ],
        bars: Some(Bars::default()),
        table: Some(Table::new(&[("name", "name", Shown::Short)])),
        ..Section::default()
    };
    Report {
        title: HOSTILE.into(),
        summary: HOSTILE.into(),
        facts: vec![(HOSTILE.into(), HOSTILE.into())],
        command: format!("angioray compare '{HOSTILE}'"),
        findings: vec![HOSTILE.into()],
        sections: vec![full, sparse],
    }
}

#[test]
fn everything_is_there_and_nothing_is_asked_for() {
    let Some(chromium) = chromium() else { return };
    let page = report().html().unwrap();
    assert!(!page.contains("http:") && !page.contains("https:"));
    let seen = open(
        &chromium,
        &page,
        "return { titles: text('h1, h2[id]'), command: text('.command code'), \
         points: all('.scatter').map((f) => f.querySelectorAll('svg .point .hit').length), \
         fronts: all('.scatter').map((f) => (f.querySelector('svg[role] > .front')?.getAttribute('d') ?? '').length > 9), \
         leftOut: text('.left-out'), shelves: all('.shelf').length, \
         dividers: all('.divider').filter((d) => !d.hidden).length, key: text('.pane .key li'), \
         ticks: text('.pane .ticks span'), bars: all('.track span').map((s) => s.style.width), \
         rows: text('table.sortable tbody th'), none: text('.none'), \
         names: text('text.name'), wide: document.documentElement.scrollWidth <= innerWidth };",
    );
    assert_eq!(seen.faults(), [""; 0]);
    let probe = seen.probe();
    assert_eq!(
        probe["titles"],
        serde_json::json!([HOSTILE, HOSTILE, "sparse"])
    );
    assert_eq!(probe["command"][0], format!("angioray compare '{HOSTILE}'"));
    assert_eq!(probe["points"], serde_json::json!([4, 1, 0]));
    assert_eq!(probe["fronts"], serde_json::json!([true, true, false]));
    assert_eq!(probe["leftOut"].as_array().unwrap().len(), 1);
    assert_eq!(probe["shelves"], 2);
    assert_eq!(probe["dividers"], 1, "a single picture has none");
    assert_eq!(probe["key"], serde_json::json!([HOSTILE]));
    assert_eq!(probe["ticks"], serde_json::json!(["−0.5", "0", "0.5"]));
    assert_eq!(probe["bars"], serde_json::json!(["80%", "20%"]));
    assert_eq!(probe["rows"], serde_json::json!([HOSTILE, "none", "fast"]));
    assert_eq!(probe["none"].as_array().unwrap().len(), 1);
    assert!(probe["names"].as_array().unwrap().contains(&"exact".into()));
    assert_eq!(probe["wide"], true, "the page does not scroll sideways");
}

#[test]
fn it_reacts() {
    let Some(chromium) = chromium() else { return };
    let seen = open(
        &chromium,
        &report().html().unwrap(),
        "const press = (to, key) => to.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true }));
         const gallery = all('.gallery')[0]; const find = (s) => gallery.querySelector(s);
         const divider = find('.divider'); const layer = find('.layer'); const seen = {};
         press(divider, 'ArrowRight');
         seen.keys = [divider.ariaValueNow, layer.style.clipPath];
         const box = find('.stage').getBoundingClientRect();
         const point = (name, part) => find('.stage').dispatchEvent(new PointerEvent(name,
           { bubbles: true, clientX: box.left + part * box.width, clientY: box.top + 5 }));
         point('pointerdown', 0.5); point('pointermove', 0.25); point('pointerup', 0.25); point('pointermove', 0.9);
         seen.dragged = divider.ariaValueNow;
         const right = find('select.right'); right.value = 2; right.dispatchEvent(new Event('change'));
         seen.chosen = layer.firstChild.src === all('.picture')[2].querySelector('img').src;
         find('.swap').click();
         seen.swapped = [find('select.left').value, right.value];
         find('[aria-label=Larger]').click();
         seen.zoomed = find('.stage img').style.transform;
         find('[data-mode=flicker]').click();
         seen.flicker = [divider.hidden, layer.style.clipPath, find('.play').textContent];
         find('.play').click();
         seen.stopped = find('.play').textContent;
         const before = layer.hidden; press(find('.stage'), ' ');
         seen.flipped = layer.hidden !== before;
         const mark = all('.scatter .point[tabindex]')[0]; mark.focus();
         seen.tip = text('.tip dd'); press(mark, 'ArrowRight'); seen.next = text('.tip b')[0];
         press(document.activeElement, 'Escape'); seen.away = all('.tip').every((tip) => tip.hidden);
         mark.dispatchEvent(new MouseEvent('click', { bubbles: true })); all('.tip button')[0].click();
         seen.led = right.value;
         const sort = all('table.sortable thead button')[1]; const order = () => text('table.sortable tbody th');
         sort.click(); seen.ascending = order(); sort.click(); seen.descending = order();
         return seen;",
    );
    assert_eq!(seen.faults(), [""; 0]);
    let probe = seen.probe();
    let json = |text: &str| serde_json::from_str::<Value>(text).unwrap();
    assert_eq!(probe["keys"], json(r#"["52", "inset(0px 0px 0px 52%)"]"#));
    assert_eq!(probe["dragged"], "25");
    assert_eq!(probe["chosen"], true);
    assert_eq!(probe["swapped"], json(r#"["2", "0"]"#));
    assert_eq!(probe["zoomed"], "translate(-50%, -50%) scale(2)");
    assert_eq!(probe["flicker"], json(r#"[true, "none", "Stop"]"#));
    assert_eq!(probe["stopped"], "Start");
    assert_eq!(probe["flipped"], true);
    assert_eq!(
        probe["tip"],
        serde_json::json!(["fixed", "3 ms", "0.02", HOSTILE])
    );
    assert_eq!(probe["next"], HOSTILE);
    assert_eq!(probe["away"], true);
    assert_eq!(probe["led"], "2");
    assert_eq!(
        probe["ascending"],
        serde_json::json!(["fast", HOSTILE, "none"])
    );
    assert_eq!(
        probe["descending"],
        serde_json::json!([HOSTILE, "fast", "none"])
    );
}

#[test]
fn it_fits_a_phone() {
    let Some(chromium) = chromium() else { return };
    let page = report().html().unwrap();
    let sizes = "return [innerWidth, document.documentElement.scrollWidth];";
    let seen = open_in(&chromium, &page, sizes, PHONE, &[]);
    assert_eq!(seen.faults(), [""; 0]);
    assert_eq!(seen.probe(), serde_json::json!([390, 390]));
    // The control: something too wide.
    let wide = page.replace("<main>", "<main><div style='width:500px;height:9px'></div>");
    let seen = open_in(&chromium, &wide, sizes, PHONE, &[]);
    assert_ne!(seen.probe()[1], 390);
}

#[test]
fn it_is_dark_where_the_reader_s_screen_is() {
    let Some(chromium) = chromium() else { return };
    let page = report().html().unwrap();
    let ground = "return getComputedStyle(document.body).backgroundColor;";
    let dark = ["--blink-settings=preferredColorScheme=0"];
    let seen = open_in(&chromium, &page, ground, DESK, &dark);
    assert_eq!(seen.faults(), [""; 0]);
    assert_eq!(seen.probe(), "rgb(15, 18, 22)");
    let light = ["--blink-settings=preferredColorScheme=1"];
    let seen = open_in(&chromium, &page, ground, DESK, &light);
    assert_eq!(seen.probe(), "rgb(246, 247, 249)");
}

#[test]
fn every_axis_names_marks_that_stand_apart() {
    let Some(chromium) = chromium() else { return };
    // Short stretches from everywhere in a decade, of small and large figures, and long ones.
    let stretches = (0..10).flat_map(|n| {
        let low = 10_f64.powf(f64::from(n) / 10.0);
        [(1e-4, 1.0), (1e-2, 1.4), (1.0, 1.0), (1.0, 3.0), (1e4, 2.0)]
            .map(|(size, over)| (low * size, low * size * over))
    });
    let long = [1e1, 1e2, 1e3, 1e6, 1e15].map(|over| (0.003, 0.003 * over));
    let scatters = stretches.chain(long).map(|(low, high)| Scatter {
        title: format!("{low} {high}"),
        points: vec![
            point("a", "g", low, low, true),
            point("b", "g", high, high, false),
        ],
        ..Scatter::default()
    });
    let page = Report {
        sections: vec![Section {
            scatters: scatters.collect(),
            ..Section::default()
        }],
        ..Report::default()
    };
    let page = page.html().unwrap();
    let axes = "return all('.scatter').flatMap((f) => ['middle', 'end'].map((anchor) => {
        const names = [...f.querySelectorAll(`.tick[text-anchor=${anchor}]`)];
        const boxes = names.map((n) => n.getBoundingClientRect());
        const apart = (a, b) => a.right < b.left || b.right < a.left || a.bottom <= b.top || b.bottom <= a.top;
        return { of: f.querySelector('h3').textContent, anchor, names: names.map((n) => n.textContent),
          apart: boxes.every((a, n) => boxes.slice(n + 1).every((b) => apart(a, b))),
          within: boxes.every((a) => a.left >= 0 && a.right <= innerWidth) }; }));";
    for window in [DESK, PHONE] {
        let seen = open_in(&chromium, &page, axes, window, &[]);
        assert_eq!(seen.faults(), [""; 0]);
        let probe = seen.probe();
        let axes = probe.as_array().unwrap();
        assert_eq!(axes.len(), 2 * 55);
        for axis in axes {
            let named = axis["names"].as_array().unwrap().len();
            assert!((2..=12).contains(&named), "{axis}");
            assert!(axis["apart"] == true && axis["within"] == true, "{axis}");
        }
    }
    // The control: names for all marks do not fit.
    let crowded = page.replace("ENOUGH_NAMES = 3", "ENOUGH_NAMES = 99");
    let crowded = crowded.replace("named.some(near)", "false");
    let seen = open_in(&chromium, &crowded, axes, PHONE, &[]);
    let probe = seen.probe();
    assert!(
        probe
            .as_array()
            .unwrap()
            .iter()
            .any(|axis| axis["apart"] == false)
    );
}

#[test]
fn the_report_that_the_readme_shows_has_no_faults() {
    let Some(chromium) = chromium() else { return };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/report/report.html");
    let page = fs::read_to_string(path).unwrap();
    let parts = "return [all('.scatter .point .hit').length > 0, all('.pane img').length > 0, \
                 document.documentElement.scrollWidth <= innerWidth];";
    for window in [DESK, PHONE] {
        let seen = open_in(&chromium, &page, parts, window, &[]);
        assert_eq!(seen.faults(), [""; 0]);
        assert_eq!(seen.probe(), serde_json::json!([true, true, true]));
    }
}

/// The checks above can fail.
#[test]
fn a_broken_page_is_caught() {
    let Some(chromium) = chromium() else { return };
    let page = report().html().unwrap();
    let with = |added: &str| page.replace("<main>", &format!("<main>{added}"));
    let broken = [
        (
            "a script that throws",
            with("<script>nothing.there()</script>"),
        ),
        (
            "a promise that fails",
            with("<script>Promise.reject('no')</script>"),
        ),
        (
            "an image that is none",
            page.replacen("base64,iVBOR", "base64,AAAAA", 1),
        ),
        (
            "a request that leaves",
            with("<img src='http://127.0.0.1:9/x.png'>"),
        ),
    ];
    for (what, page) in broken {
        let faults = open(&chromium, &page, "return 1;").faults();
        assert!(!faults.is_empty(), "{what} went unseen");
    }
}

#[test]
fn what_is_no_picture_is_refused() {
    let mut report = report();
    let pictures = |report: &mut Report| report.sections[0].gallery.take().unwrap().pictures;
    let mut wrong = pictures(&mut report);
    wrong[2].png = b"GIF89a".to_vec();
    report.sections[0].gallery = Some(Gallery { pictures: wrong });
    let error = report.html().unwrap_err().to_string();
    assert!(error.contains("\"step 2\" is no PNG"), "{error}");

    let mut twice = pictures(&mut report);
    twice[2] = twice[0].clone();
    report.sections[0].gallery = Some(Gallery { pictures: twice });
    let error = report.html().unwrap_err().to_string();
    assert!(error.contains("two pictures"), "{error}");
}
