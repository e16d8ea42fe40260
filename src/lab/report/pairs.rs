//! Pictures of two sections side by side: data by which the script finds them in the page, so that none
//! is there twice.

use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};

use super::content::{Pairs, Section};
use super::scatter::in_script;
use crate::error::{Error, Result};

/// The comparison of pictures of a page with these sections; empty if no two of them have a picture in
/// common.
pub(super) fn html(pairs: &Pairs, sections: &[Section]) -> Result<Markup> {
    for shown in pairs.settings.iter().flat_map(|setting| &setting.pictures) {
        let gallery = sections
            .get(shown.section)
            .and_then(|one| one.gallery.as_ref());
        let pictures = gallery.map_or(&[][..], |gallery| &gallery.pictures);
        if !pictures.iter().any(|picture| picture.label == shown.label) {
            return Err(Error::failed(format!(
                "the report has no picture \"{}\" in its section {}",
                shown.label, shown.section
            )));
        }
    }
    let settings = pairs.settings.iter().filter(|one| one.pictures.len() > 1);
    let settings: Vec<Value> = settings
        .map(|setting| {
            let pictures = setting.pictures.iter().map(|shown| {
                json!({ "mode": shown.mode, "section": shown.section, "label": shown.label })
            });
            json!({ "label": setting.label, "pictures": pictures.collect::<Value>() })
        })
        .collect();
    Ok(html! {
        @if !settings.is_empty() {
            div.pairs.card {
                script type="application/json" { (PreEscaped(in_script(&settings.into()))) }
                noscript { p { "The view needs JavaScript; its pictures are in the sections above." } }
            }
        }
    })
}
