//! No function is too long, and none takes too many parameters, unless a comment above it says why.

use crate::sources::sources;

/// Lines, from the signature's first to the closing brace.
const MAX_LINES: usize = 70;
const MAX_PARAMETERS: usize = 7;

/// What begins the comment that gives the reason, directly above the function.
const LONG: &str = "// long: ";
const MANY_PARAMETERS: &str = "// many parameters: ";

/// A function as it stands in a file that rustfmt has formatted.
struct Function<'a> {
    name: &'a str,
    /// Counts from 1.
    line: usize,
    lines: usize,
    parameters: usize,
    /// The comments and attributes directly above it.
    above: Vec<&'a str>,
}

impl Function<'_> {
    fn has_reason(&self, marker: &str) -> bool {
        let reason = |line: &&str| {
            let rest = line.trim_start().strip_prefix(marker)?;
            (!rest.trim().is_empty()).then_some(())
        };
        self.above.iter().any(|line| reason(line).is_some())
    }

    fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        if self.lines > MAX_LINES && !self.has_reason(LONG) {
            faults.push(format!("{} has {} lines", self.name, self.lines));
        }
        if self.parameters > MAX_PARAMETERS && !self.has_reason(MANY_PARAMETERS) {
            faults.push(format!(
                "{} takes {} parameters",
                self.name, self.parameters
            ));
        }
        faults
    }
}

/// The name of the function that a line begins, where it begins one.
fn name_of(line: &str) -> Option<&str> {
    let mut words = line.trim_start();
    if let Some(rest) = words.strip_prefix("pub(") {
        words = rest.split_once(") ").map_or(words, |(_, rest)| rest);
    }
    for qualifier in [
        "pub ",
        "const ",
        "async ",
        "unsafe ",
        "extern \"C\" ",
        "extern \"system\" ",
    ] {
        words = words.strip_prefix(qualifier).unwrap_or(words);
    }
    let rest = words.strip_prefix("fn ")?;
    let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_'))?;
    Some(&rest[..end])
}

/// The parameters of the signature at the front of `text`, `self` among them.
fn parameters(text: &str) -> usize {
    let (mut depth, mut count, mut is_open) = (0, 0, false);
    let mut angles = 0;
    let mut before = ' ';
    for c in text.chars() {
        match c {
            '<' => angles += 1,
            '>' if before != '-' && before != '=' => angles -= 1,
            '(' | '[' | '{' if depth > 0 || angles == 0 => depth += 1,
            ')' | ']' | '}' if depth > 0 => {
                depth -= 1;
                if depth == 0 {
                    break;
                }
            }
            ',' if depth == 1 && angles == 0 => {
                count += usize::from(is_open);
                is_open = false;
            }
            c if depth > 0 && !c.is_whitespace() => is_open = true,
            _ => {}
        }
        before = c;
    }
    count + usize::from(is_open)
}

/// The functions with a body; signatures alone are those of somebody else's interface, or a trait's.
fn functions(text: &str) -> Vec<Function<'_>> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let Some(name) = name_of(line) else { continue };
        let indent = &line[..line.len() - line.trim_start().len()];
        let end = match line.ends_with(['}', ';']) {
            true => at,
            false => {
                let is_end = |line: &&str| {
                    line.strip_prefix(indent) == Some("}")
                        || line
                            .strip_prefix(indent)
                            .is_some_and(|rest| rest.starts_with(')') && rest.ends_with(';'))
                };
                let length = lines[at..].iter().position(is_end);
                at + length.unwrap_or_else(|| panic!("{name} has no end"))
            }
        };
        if lines[end].ends_with(';') {
            continue;
        }
        let is_above = |line: &&&str| {
            let line = line.trim_start();
            line.starts_with("//") || line.starts_with("#[")
        };
        found.push(Function {
            name,
            line: at + 1,
            lines: end - at + 1,
            parameters: parameters(&lines[at..=end].join("\n")),
            above: lines[..at]
                .iter()
                .rev()
                .take_while(is_above)
                .copied()
                .collect(),
        });
    }
    found
}

#[test]
fn functions_are_short_and_take_few_parameters() {
    let mut faults = Vec::new();
    let mut count = 0;
    for source in [sources("src"), sources("tests")].into_iter().flatten() {
        let all = functions(&source.text);
        count += all.len();
        for function in all {
            let of_function = function.faults().into_iter();
            let place = format!("{}:{}", source.path.display(), function.line);
            faults.extend(of_function.map(|fault| format!("{place}: {fault}")));
        }
    }
    assert!(count > 1000, "only {count} functions were found");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// A function of so many lines and parameters.
fn made_up(above: &str, lines: usize, parameters: usize) -> String {
    let parameters: Vec<String> = (0..parameters)
        .map(|n| format!("p{n}: Vec<(u8, u8)>"))
        .collect();
    let body = "    body();\n".repeat(lines - 2);
    format!(
        "{above}pub fn f<T: Fn(u8, u8)>({}) -> u8 {{\n{body}}}\n",
        parameters.join(", ")
    )
}

fn faults_of(text: &str) -> Vec<String> {
    functions(text).iter().flat_map(Function::faults).collect()
}

#[test]
fn the_check_sees_what_is_too_long_or_takes_too_many_parameters() {
    assert_eq!(faults_of(&made_up("", 70, 7)), [] as [&str; 0]);
    assert_eq!(faults_of(&made_up("", 71, 7)), ["f has 71 lines"]);
    assert_eq!(faults_of(&made_up("", 70, 8)), ["f takes 8 parameters"]);
    let method =
        "impl S {\n    fn g(&self, a: u8, b: [u8; 2], c: u8, d: u8, e: u8, f: u8, g: u8) {}\n}\n";
    assert_eq!(faults_of(method), ["g takes 8 parameters"]);
}

#[test]
fn a_reason_above_a_function_excuses_it_and_an_empty_one_does_not() {
    let reason = "/// Does it.\n// long: a table.\n#[inline]\n";
    assert_eq!(faults_of(&made_up(reason, 90, 3)), [] as [&str; 0]);
    assert_eq!(faults_of(&made_up("// long: \n", 90, 3)).len(), 1);
    assert_eq!(faults_of(&made_up(reason, 90, 9)).len(), 1);
    let reason = "// many parameters: a foreign interface.\n";
    assert_eq!(faults_of(&made_up(reason, 9, 9)), [] as [&str; 0]);
    // A reason of another function does not count.
    let text = made_up("// long: a table.\n", 90, 3) + "\n" + &made_up("", 90, 3);
    assert_eq!(faults_of(&text).len(), 1);
}
