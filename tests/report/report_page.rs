//! The page in which a comparison ends, in a browser: it works, it says what it was given, and it
//! requests nothing from the network. Needs Chromium; skips without, unless `REQUIRE_CHROMIUM=1`.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use angioray::frame::read_metadata;
use angioray::lab::report::{
    Axis, Bar, Bars, ErrorMap, Gallery, Mark, PairSetting, PairedPicture, Pairs, Picture, Point,
    Report, Scale, Scatter, Section, Shown, Table,
};
use base64::prelude::{BASE64_STANDARD, Engine};
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

fn gallery(pictures: Vec<Picture>) -> Gallery {
    Gallery {
        pictures,
        opens_on: None,
    }
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
            opens_on: None,
        }),
        pairs: None,
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
        gallery: Some(gallery(vec![picture("only", 90, None)])),
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
fn everything_is_there_and_nothing_is_requested() {
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
    // Short ranges from everywhere in a decade, of small and large figures, and long ones.
    let ranges = (0..10).flat_map(|n| {
        let low = 10_f64.powf(f64::from(n) / 10.0);
        [(1e-4, 1.0), (1e-2, 1.4), (1.0, 1.0), (1.0, 3.0), (1e4, 2.0)]
            .map(|(size, over)| (low * size, low * size * over))
    });
    let long = [1e1, 1e2, 1e3, 1e6, 1e15].map(|over| (0.003, 0.003 * over));
    let scatters = ranges.chain(long).map(|(low, high)| Scatter {
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

#[test]
fn it_opens_on_the_picture_that_shows_most() {
    let Some(chromium) = chromium() else { return };
    let of = |opens_on: Option<usize>| {
        let mut report = report();
        report.sections[0].gallery.as_mut().unwrap().opens_on = opens_on;
        let shown = "const pane = all('.gallery')[0]; const src = (s) => pane.querySelector(s).src; \
                     const of = (n) => all('.picture')[n]; \
                     return [src('.stage > img') === of(0).querySelector('img').src, \
                     src('.layer img') === of(2).querySelector('img').src, \
                     text('.pane:last-child figcaption b')[0]];";
        let seen = open(&chromium, &report.html().unwrap(), shown);
        assert_eq!(seen.faults(), [""; 0]);
        seen.probe()
    };
    assert_eq!(
        of(Some(2)),
        serde_json::json!([true, true, "Error of step 2"])
    );
    // The control: without it, and with one that is not there, on the second.
    let second = serde_json::json!([true, false, format!("Error of {HOSTILE}")]);
    assert_eq!(of(None), second);
    assert_eq!(of(Some(7)), second);
}

/// A page of three modes, the third of which has no setting but the reference in common.
fn in_modes() -> Report {
    let section = |title: &str, pictures: Vec<Picture>| Section {
        title: title.into(),
        gallery: Some(gallery(pictures)),
        ..Section::default()
    };
    let picture = |label: &str, gray: u8| picture(label, gray, None);
    let shown = |mode: &str, section: usize, label: &str| PairedPicture {
        mode: mode.into(),
        section,
        label: label.into(),
    };
    let pairs = Pairs {
        settings: vec![
            PairSetting {
                label: "reference".into(),
                pictures: vec![
                    shown("iso", 0, "reference"),
                    shown("mip", 1, "reference"),
                    shown(HOSTILE, 2, "reference"),
                ],
            },
            PairSetting {
                label: HOSTILE.into(),
                pictures: vec![shown("iso", 0, HOSTILE), shown("mip", 1, HOSTILE)],
            },
            PairSetting {
                label: "alone".into(),
                pictures: vec![shown("mip", 1, "reference")],
            },
        ],
    };
    Report {
        sections: vec![
            section("iso", vec![picture("reference", 10), picture(HOSTILE, 20)]),
            section("mip", vec![picture("reference", 30), picture(HOSTILE, 40)]),
            section(HOSTILE, vec![picture("reference", 50)]),
            Section {
                title: "Modes side by side".into(),
                pairs: Some(pairs),
                ..Section::default()
            },
        ],
        ..Report::default()
    }
}

#[test]
fn two_modes_stand_side_by_side_in_one_setting() {
    let Some(chromium) = chromium() else { return };
    let page = in_modes().html().unwrap();
    let acts = "const box = all('.pairs')[0]; const find = (s) => box.querySelector(s); \
        const pick = (s, value) => { find(s).value = value; find(s).dispatchEvent(new Event('change')); }; \
        const number = (image) => all('.strip img').findIndex((one) => one.src === image.src); \
        const shown = () => [...box.querySelectorAll('.pane img')].map(number); \
        const seen = { opens: shown(), settings: text('.setting option'), modes: text('.pairs .right option') }; \
        pick('.right', find('.right').options[2].value); seen.third = shown(); \
        pick('.setting', 1); seen.other = shown(); \
        seen.disabled = [...find('.right').options].map((o) => o.disabled); \
        find('.swap').click(); seen.swapped = shown(); \
        find('[aria-label=Larger]').click(); \
        seen.zoomed = [...box.querySelectorAll('.pane img')].map((i) => i.style.transform); \
        seen.captions = text('.pairs figcaption b'); \
        const boxes = [...box.querySelectorAll('.pane')].map((p) => p.getBoundingClientRect()); \
        seen.beside = boxes[0].right <= boxes[1].left && boxes[0].top === boxes[1].top; return seen;";
    for window in [DESK, PHONE] {
        let seen = open_in(&chromium, &page, acts, window, &[]);
        assert_eq!(seen.faults(), [""; 0]);
        let zoomed = "translate(-50%, -50%) scale(2)";
        let expected = serde_json::json!({
            "opens": [0, 2], "settings": ["reference", HOSTILE], "modes": ["iso", "mip", HOSTILE],
            "third": [0, 4], "other": [1, 3], "disabled": [false, false, true], "swapped": [3, 1],
            "zoomed": [zoomed, zoomed],
            "captions": [format!("mip: {HOSTILE}"), format!("iso: {HOSTILE}")], "beside": true,
        });
        assert_eq!(seen.probe(), expected);
    }
    // No picture is in the page twice.
    assert_eq!(page.matches("data:image/png").count(), 5);

    // The control: a picture that no section shows is refused.
    let mut lost = in_modes();
    let pairs = lost.sections[3].pairs.as_mut().unwrap();
    pairs.settings[1].pictures[0].section = 2;
    let error = lost.html().unwrap_err().to_string();
    assert!(
        error.contains("no picture") && error.contains("section 2"),
        "{error}"
    );
}

/// Gives what of a page's text cannot be seen: cut off by its own box or by that of another, or beyond the
/// window's edge. What can be scrolled to is there.
const CLIPPED: &str = "const name = (e) => `${e.tagName}.${e.getAttribute('class')}: ${e.textContent.slice(0, 40)}`;
    const scrolls = (e) => ['auto', 'scroll'].includes(getComputedStyle(e).overflowX);
    const reachable = (e) => { for (let at = e.parentElement; at; at = at.parentElement) if (scrolls(at)) return true; return false; };
    const visible = (e) => e.getClientRects().length && getComputedStyle(e).visibility === 'visible';
    const hasText = (e) => [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim());
    const pen = document.createElement('canvas').getContext('2d');
    const chosen = (e) => { const s = getComputedStyle(e); pen.font = s.font;
      const room = e.clientWidth - parseFloat(s.paddingLeft) - parseFloat(s.paddingRight);
      return pen.measureText(e.selectedOptions[0]?.textContent ?? '').width > room; };
    const cut = (e) => { const s = getComputedStyle(e); if (scrolls(e)) return false;
      return s.overflowX !== 'visible' && (e.scrollWidth > e.clientWidth + 1 || e.scrollHeight > e.clientHeight + 1); };
    const inked = (e) => { const range = document.createRange(); range.selectNodeContents(e); return range.getBoundingClientRect(); };
    const beyond = (box) => box.left < -0.5 || box.right > innerWidth + 0.5;
    const out = (e) => (beyond(e.getBoundingClientRect()) || beyond(inked(e))) && !reachable(e);
    const shown = all('body *').filter((e) => visible(e) && !['SCRIPT', 'STYLE'].includes(e.tagName));
    return [...shown.filter((e) => hasText(e) && (cut(e) || out(e))), ...all('select').filter((e) => visible(e) && chosen(e)),
      ...all('.stage').filter((e) => [...e.children].some((c) => c.matches('.tag') && visible(c)
        && (c.getBoundingClientRect().right > e.getBoundingClientRect().right || c.scrollWidth > c.clientWidth + 1)))].map(name);";

/// Names and figures as long as they get.
// long: one page, written out.
fn with_long_names() -> Report {
    let long = "VTK 9.7.2: fixed-point, step 0.5";
    let mut report = in_modes();
    for section in &mut report.sections[..2] {
        let pictures = &mut section.gallery.as_mut().unwrap().pictures;
        pictures[1].label = long.into();
        pictures[1].error_map = Some(ErrorMap {
            marks: vec![Mark {
                color: [1, 2, 3],
                meaning: "nothing there in either".into(),
            }],
            label: "projected value".into(),
            unit: "% of the value range".into(),
            ..map()
        });
    }
    let pairs = report.sections[3].pairs.as_mut().unwrap();
    pairs.settings[1].label = long.into();
    for picture in &mut pairs.settings[1].pictures {
        picture.label = long.into();
    }
    report.title =
        "head_256x256x256_uint8_with_contrast_and_a_long_name.nrrd: speed against error".into();
    report.command = format!(
        "angioray compare {} -o out --modes iso,mip,dvr",
        "x".repeat(70)
    );
    report.facts = vec![("Compared with".into(), "y".repeat(80))];
    report.findings = vec![format!(
        "iso: on the Pareto front: {long} (12.3 ms, 1.2×10⁻⁵), {}",
        "z".repeat(60)
    )];
    report.sections[0].scatters = vec![Scatter {
        title: "Time against error of the projected value, rms".into(),
        x: Axis {
            label: "time of a frame".into(),
            unit: "ms".into(),
        },
        y: Axis {
            label: "error of the projected value, rms".into(),
            unit: "% of the value range".into(),
        },
        points: vec![
            point(long, long, 3.0, 1e-7, true),
            point(
                "b",
                "another family of settings, with a long name",
                900.0,
                20.0,
                true,
            ),
        ],
    }];
    report.sections[0].bars = Some(Bars {
        title: "Passes of a frame, on the device's clock".into(),
        unit: "ms".into(),
        rows: vec![
            Bar {
                label: long.into(),
                parts: vec![
                    ("exact_surface".into(), 123_456.0),
                    ("tone_curve".into(), 23_456.0),
                ],
            },
            Bar {
                label: "b".into(),
                parts: vec![
                    ("surface_normal_by_gradients".into(), 1e-5),
                    ("x".into(), 4e4),
                ],
            },
        ],
    });
    report.sections[0].table = Some(table());
    report
}

#[test]
fn nothing_is_clipped() {
    let Some(chromium) = chromium() else { return };
    let page = with_long_names().html().unwrap();
    for window in [PHONE, DESK] {
        let seen = open_in(&chromium, &page, CLIPPED, window, &[]);
        assert_eq!(seen.faults(), [""; 0]);
        assert_eq!(seen.probe(), serde_json::json!([]), "{window:?}");
    }
    // The control: pages whose style cuts something off.
    let with = |style: &str| page.replace("</head>", &format!("<style>{style}</style></head>"));
    let broken = [
        (
            "a tag on one line",
            with(".stage .tag { white-space: nowrap; overflow: hidden; }"),
        ),
        (
            "a title in the plot",
            with(".axis.y { white-space: nowrap; font-size: 20px; }"),
        ),
        (
            "a command on one line",
            with(".command pre { white-space: pre; overflow: hidden; }"),
        ),
        (
            "a narrow choice",
            with("select { width: 90px !important; }"),
        ),
        (
            "a bar too short for its figure",
            with(".track span { max-width: 30px; }"),
        ),
        ("a wide section", with("h2 { width: 500px; }")),
    ];
    for (what, page) in broken {
        let seen = open_in(&chromium, &page, CLIPPED, PHONE, &[]);
        assert_ne!(seen.probe(), serde_json::json!([]), "{what} went unseen");
    }
}

/// The pictures that a page holds, with the texts that they carry.
fn embedded(page: &str) -> Vec<Vec<(String, String)>> {
    let after = page.split("data:image/png;base64,").skip(1);
    let encoded = after.map(|text| text.split(['"', '\'']).next().unwrap());
    let decoded = encoded.map(|text| BASE64_STANDARD.decode(text).unwrap());
    let texts = decoded.map(|png| {
        let file = tempfile::Builder::new().suffix(".png").tempfile().unwrap();
        fs::write(file.path(), png).unwrap();
        read_metadata(file.path()).unwrap()
    });
    texts.collect()
}

/// Texts that name a place of the machine on which they were made.
fn places(texts: &[(String, String)]) -> Vec<&str> {
    let words = texts
        .iter()
        .flat_map(|(_, text)| text.split([' ', '"', '\'', '\n', '=', ',']));
    let is_place = |word: &&str| {
        let on_windows = word
            .get(1..3)
            .is_some_and(|rest| rest == ":\\" || rest == ":/");
        (word.starts_with('/') && word.len() > 1) || on_windows || word.starts_with("file:")
    };
    words.filter(is_place).collect()
}

#[test]
fn the_report_that_the_readme_shows_names_no_place_of_its_maker() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/report/report.html");
    let page = fs::read_to_string(path).unwrap();
    let pictures = embedded(&page);
    assert!(pictures.len() > 10);
    let scenes = pictures.iter().flatten().filter(|(key, _)| key == "scene");
    assert!(scenes.clone().count() > 5);
    for texts in &pictures {
        assert_eq!(places(texts), [""; 0]);
    }
    for (_, scene) in scenes {
        assert!(scene.contains("volume = \"vessels.nrrd\""), "{scene}");
    }
    let (_, command) = page.split_once("<code>").unwrap();
    let (command, _) = command.split_once("</code>").unwrap();
    assert_eq!(places(&[(String::new(), command.into())]), [""; 0]);
}

#[test]
fn a_picture_that_names_a_place_is_found() {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    let scene = "mode = \"iso\"\nvolume = \"/home/someone/head.nrrd\"\n";
    encoder
        .add_itxt_chunk("scene".into(), scene.into())
        .unwrap();
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[0]).unwrap();
    writer.finish().unwrap();
    let mut report = report();
    report.sections[0].gallery.as_mut().unwrap().pictures[1].png = bytes;
    let pictures = embedded(&report.html().unwrap());
    assert_eq!(pictures.len(), 6);
    let found: Vec<&str> = pictures.iter().flat_map(|texts| places(texts)).collect();
    assert_eq!(found, ["/home/someone/head.nrrd"]);
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
    report.sections[0].gallery = Some(gallery(wrong));
    let error = report.html().unwrap_err().to_string();
    assert!(error.contains("\"step 2\" is not a PNG"), "{error}");

    let mut twice = pictures(&mut report);
    twice[2] = twice[0].clone();
    report.sections[0].gallery = Some(gallery(twice));
    let error = report.html().unwrap_err().to_string();
    assert!(error.contains("two pictures"), "{error}");
}
