//! A million changed headers: of volumes of every format, their names, scenes, transfer functions, and
//! pictures that carry a scene. Each is read or refused, and nothing else: no panic, no hang, no absurd
//! allocation. The suite takes every hundredth; `scripts/fuzz.sh` takes all and prints the figures.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::thread;
use std::time::{Duration, Instant};

use super::memory::max_held;
use super::subjects::Subjects;

/// All that there are.
const CASES: u64 = 1_000_000;

/// How many of them are taken, evenly spread.
const CASES_VARIABLE: &str = "ANGIORAY_FUZZ_CASES";

/// The one that is taken alone.
const ONE_VARIABLE: &str = "ANGIORAY_FUZZ_ONE";

/// Beyond the file's own bytes, of which none has many.
const MAX_MEMORY: usize = 16 << 20;

/// A case that takes this long never ends: its number is printed before the program is given up.
const HANG: Duration = Duration::from_secs(120);

/// What came of one case.
pub struct Outcome {
    pub kind: &'static str,
    pub was_read: bool,
    /// Of the changed file.
    pub bytes: usize,
}

/// What came of all cases of one kind.
#[derive(Debug, Default)]
struct Figures {
    read: u64,
    refused: u64,
    max_held: usize,
    longest: Duration,
}

impl Figures {
    fn add(&mut self, more: &Self) {
        self.read += more.read;
        self.refused += more.refused;
        self.max_held = self.max_held.max(more.max_held);
        self.longest = self.longest.max(more.longest);
    }
}

type ByKind = BTreeMap<&'static str, Figures>;

fn joined(parts: impl Iterator<Item = (&'static str, Figures)>) -> ByKind {
    let mut all = ByKind::new();
    for (kind, figures) in parts {
        all.entry(kind).or_default().add(&figures);
    }
    all
}

/// Takes the cases one by one; what is wrong is reported with the case's number.
fn take(
    cases: impl Iterator<Item = u64>,
    check: impl Fn(u64) -> Outcome,
) -> Result<ByKind, String> {
    let watch = Watch::start();
    let mut all = ByKind::new();
    for case in cases {
        watch.begin(case);
        let began = Instant::now();
        let (outcome, held) = max_held(|| catch_unwind(AssertUnwindSafe(|| check(case))));
        let took = began.elapsed();
        let held = usize::try_from(held).unwrap_or(0);
        let outcome = outcome.map_err(|_| format!("case {case} panics"))?;
        if held > outcome.bytes + MAX_MEMORY {
            return Err(format!(
                "case {case} ({}) of {} bytes held {held} bytes",
                outcome.kind, outcome.bytes
            ));
        }
        all.entry(outcome.kind).or_default().add(&Figures {
            read: u64::from(outcome.was_read),
            refused: u64::from(!outcome.was_read),
            max_held: held,
            longest: took,
        });
    }
    Ok(all)
}

/// Says the number of a case that does not end.
struct Watch {
    /// Moves on with every case.
    state: Arc<State>,
}

#[derive(Default)]
struct State {
    case: AtomicU64,
    begun: AtomicU64,
}

impl Watch {
    fn start() -> Self {
        let state = Arc::<State>::default();
        let watched = Arc::downgrade(&state);
        thread::spawn(move || {
            let mut seen = (u64::MAX, Instant::now());
            while let Some(state) = watched.upgrade() {
                let begun = state.begun.load(Relaxed);
                if begun != seen.0 {
                    seen = (begun, Instant::now());
                } else if seen.1.elapsed() > HANG {
                    eprintln!("case {} does not end", state.case.load(Relaxed));
                    std::process::abort();
                }
                drop(state);
                thread::sleep(Duration::from_millis(200));
            }
        });
        Self { state }
    }

    fn begin(&self, case: u64) {
        self.state.case.store(case, Relaxed);
        self.state.begun.fetch_add(1, Relaxed);
    }
}

fn number(variable: &str) -> Option<u64> {
    let text = std::env::var(variable).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{variable}={text}")))
}

#[test]
fn changed_headers_are_read_or_refused_and_nothing_else() {
    if let Some(one) = number(ONE_VARIABLE) {
        let subjects = Subjects::new();
        take(one..=one, |case| subjects.check(case)).unwrap();
        return;
    }
    let count = number(CASES_VARIABLE)
        .unwrap_or(CASES / 100)
        .clamp(1, CASES);
    let step = (CASES / count) as usize;
    // Each worker changes files of its own.
    let workers = thread::available_parallelism().map_or(1, |n| n.get());
    let work = |worker: usize| {
        let subjects = Subjects::new();
        let cases = (0..CASES).step_by(step).skip(worker).step_by(workers);
        take(cases, |case| subjects.check(case)).unwrap_or_else(|wrong| {
            panic!("{wrong}; {ONE_VARIABLE}=NUMBER takes a case alone");
        })
    };
    let figures = thread::scope(|scope| {
        let all: Vec<_> = (0..workers)
            .map(|n| {
                let work = &work;
                scope.spawn(move || work(n))
            })
            .collect();
        joined(all.into_iter().flat_map(|one| one.join().unwrap()))
    });
    let (mut read, mut refused) = (0, 0);
    for (kind, of_kind) in &figures {
        println!(
            "{kind:>10}: {:>7} read, {:>7} refused, {:>9} bytes held at most, {:>7.1} ms at most",
            of_kind.read,
            of_kind.refused,
            of_kind.max_held,
            of_kind.longest.as_secs_f64() * 1e3
        );
        // Both happen, so neither branch is idle.
        assert!(
            of_kind.read > 0 && of_kind.refused > 0,
            "{kind} {of_kind:?}"
        );
        (read, refused) = (read + of_kind.read, refused + of_kind.refused);
    }
    println!("{:>10}: {read} read, {refused} refused", "all");
    assert_eq!(figures.len(), Subjects::KINDS);
    assert!(
        read > count / 10 && refused > count / 10,
        "{read} {refused}"
    );
}

#[test]
fn a_panic_and_an_absurd_allocation_are_noticed() {
    let outcome = || Outcome {
        kind: "a test",
        was_read: true,
        bytes: 10,
    };
    let fine = take(0..5, |_| outcome()).unwrap();
    assert_eq!(fine.len(), 1);
    assert_eq!((fine["a test"].read, fine["a test"].refused), (5, 0));
    let quiet = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let panicked = take(0..5, |case| {
        assert!(case < 3);
        outcome()
    });
    std::panic::set_hook(quiet);
    assert!(panicked.unwrap_err().contains("case 3 panics"));
    let absurd = take(0..5, |case| {
        drop(vec![0_u8; (case as usize) << 23]);
        outcome()
    });
    assert!(
        absurd
            .unwrap_err()
            .contains("case 3 (a test) of 10 bytes held")
    );
}
