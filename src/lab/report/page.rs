//! The page: one HTML file that needs nothing else, and says so to the browser.

use std::io::Write;
use std::path::Path;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::content::{Report, Section};
use super::{bars, gallery, pairs, scatter};
use crate::VERSION;
use crate::error::{Error, Result};
use crate::output::write_atomically;

/// The page's content security policy: nothing is fetched from anywhere, as images, style and scripts
/// are in the file.
const POLICY: &str = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; \
                      script-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";

const STYLES: [&str; 3] = [
    include_str!("page/page.css"),
    include_str!("page/viewer.css"),
    include_str!("page/plots.css"),
];

/// Runs before anything that could fail.
const FAULTS: &str = include_str!("page/faults.js");

/// The scripts that those after them share.
const SHARED: [&str; 3] = [
    include_str!("page/dom.js"),
    include_str!("page/axis.js"),
    include_str!("page/magnified.js"),
];

/// The scripts in the order in which they run, each with names of its own.
const SCRIPTS: [&str; 5] = [
    include_str!("page/viewer.js"),
    include_str!("page/pairs.js"),
    include_str!("page/scatter.js"),
    include_str!("page/table.js"),
    include_str!("page/page.js"),
];

/// One strict script that leaves no name behind.
fn script() -> String {
    let blocks = SCRIPTS.map(|script| format!("{{\n{script}}}\n"));
    let all = SHARED.concat() + &blocks.concat();
    format!("(() => {{\n'use strict';\n{all}}})();\n")
}

impl Report {
    /// The whole page.
    ///
    /// # Errors
    /// A picture or an error map that is no PNG; two pictures of one gallery with one label; a pair of
    /// a picture that no gallery shows.
    pub fn html(&self) -> Result<String> {
        let sections = self.sections.iter().enumerate();
        let sections: Vec<Markup> = sections
            .map(|(n, section)| section_html(n, section, &self.sections))
            .collect::<Result<_>>()?;
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content=(POLICY);
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="color-scheme" content="light dark";
                    meta name="generator" content={ "angioray " (VERSION) };
                    title { (self.title) }
                    script { (PreEscaped(FAULTS)) }
                    @for style in STYLES { style { (PreEscaped(style)) } }
                }
                body {
                    (self.header())
                    (self.contents())
                    main { @for section in &sections { (section) } }
                    footer {
                        "Made by angioray " (VERSION)
                        ". This page is one file and loads nothing from elsewhere."
                    }
                    script { (PreEscaped(script())) }
                }
            }
        };
        Ok(page.into_string())
    }

    /// Writes [`Self::html`] to a file, whole or not at all.
    ///
    /// # Errors
    /// Those of [`Self::html`], and a file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let page = self.html()?;
        write_atomically(path, |file| {
            file.write_all(page.as_bytes())
                .map_err(|cause| Error::writing(path, "write", &cause))
        })
    }

    fn header(&self) -> Markup {
        html! {
            header {
                p.brand { "angioray" }
                h1 { (self.title) }
                @if !self.summary.is_empty() { p.lead { (self.summary) } }
                div.intro {
                    @if !self.findings.is_empty() {
                        section.card.findings {
                            h2 { "Findings" }
                            ul { @for finding in &self.findings { li { (finding) } } }
                        }
                    }
                    @if !self.facts.is_empty() {
                        section.card.facts {
                            h2 { "What was run" }
                            dl {
                                @for (name, value) in &self.facts {
                                    div { dt { (name) } dd { (value) } }
                                }
                            }
                        }
                    }
                }
                @if !self.command.is_empty() {
                    div.command {
                        p #again { "Run it again" }
                        pre tabindex="0" aria-labelledby="again" { code { (self.command) } }
                        button.copy type="button" hidden { "Copy" }
                    }
                }
            }
        }
    }

    /// Links to the sections, where there are several.
    fn contents(&self) -> Markup {
        html! {
            @if self.sections.len() > 1 {
                nav aria-label="Sections" {
                    @for (n, section) in self.sections.iter().enumerate() {
                        a href={ "#section-" (n) } { (section.title) }
                    }
                }
            }
        }
    }
}

/// The section of number `n` of a page with these `sections`.
fn section_html(n: usize, section: &Section, sections: &[Section]) -> Result<Markup> {
    let gallery = match &section.gallery {
        Some(gallery) => gallery::html(gallery).map_err(|error| error.at(&section.title))?,
        None => Markup::default(),
    };
    let pairs = match &section.pairs {
        Some(pairs) => pairs::html(pairs, sections).map_err(|error| error.at(&section.title))?,
        None => Markup::default(),
    };
    Ok(html! {
        section.part id={ "section-" (n) } aria-labelledby={ "title-" (n) } {
            h2 id={ "title-" (n) } { (section.title) }
            @if !section.about.is_empty() { p.about { (section.about) } }
            (gallery)
            (pairs)
            @if !section.scatters.is_empty() {
                div.scatters { @for plot in &section.scatters { (scatter::html(plot)) } }
            }
            @if let Some(bars) = &section.bars { (bars::html(bars)) }
            @if let Some(table) = &section.table { (table.html(&section.title, section.scatters.len())) }
        }
    })
}
