//! Pictures in a page: a strip of all of them, which the script turns into a viewer.

use std::collections::HashSet;
use std::io::Cursor;

use base64::prelude::{BASE64_STANDARD, Engine};
use maud::{Markup, html};

use super::content::{ErrorMap, Gallery, Picture, Scale};
use super::figure::figure;
use crate::error::{Error, Result};

pub(super) fn html(gallery: &Gallery) -> Result<Markup> {
    let mut labels = HashSet::new();
    if let Some(twice) = gallery.pictures.iter().find(|p| !labels.insert(&p.label)) {
        let message = format!("two pictures of the report are named \"{}\"", twice.label);
        return Err(Error::failed(message));
    }
    let opens_on = gallery.opens_on.filter(|&at| at < gallery.pictures.len());
    let pictures = gallery.pictures.iter();
    let pictures: Vec<Markup> = pictures.map(picture_html).collect::<Result<_>>()?;
    Ok(html! {
        @if !pictures.is_empty() {
            div.gallery.card data-opens-on=[opens_on] { ol.strip { @for picture in &pictures { li { (picture) } } } }
        }
    })
}

fn picture_html(picture: &Picture) -> Result<Markup> {
    let name = &picture.label;
    let image = embedded(&picture.png, name)?;
    let map = match &picture.error_map {
        Some(map) => map_html(map, name)?,
        None => Markup::default(),
    };
    Ok(html! {
        figure.picture data-label=(name) data-caption=(picture.caption) {
            img src=(image.url) width=(image.width) height=(image.height) alt={ "Picture: " (name) };
            figcaption { b { (name) } " " span { (picture.caption) } }
            (map)
        }
    })
}

fn map_html(map: &ErrorMap, of: &str) -> Result<Markup> {
    let image = embedded(&map.png, &format!("error map of {of}"))?;
    let unit = match map.unit.is_empty() {
        true => String::new(),
        false => format!(", {}", map.unit),
    };
    Ok(html! {
        div.map {
            img src=(image.url) width=(image.width) height=(image.height)
                alt={ (map.label) " of " (of) " against the reference" };
            div.key {
                p { (map.label) (unit) }
                (scale_html(&map.scale))
                @if !map.marks.is_empty() {
                    ul.marks {
                        @for mark in &map.marks {
                            li { i style={ "background:" (css(mark.color)) } {} (mark.meaning) }
                        }
                    }
                }
            }
        }
    })
}

fn scale_html(scale: &Scale) -> Markup {
    let stops = scale.stops.iter();
    let stops = stops.map(|&(at, color)| format!("{} {}", css(color), percent(at)));
    let gradient = stops.collect::<Vec<_>>().join(",");
    html! {
        @if scale.stops.len() > 1 {
            div.scale style={ "background:linear-gradient(to right," (gradient) ")" } {}
            div.ticks {
                @for &(at, value) in &scale.ticks {
                    span style={ "--at:" (percent(at)) } { (figure(value)) }
                }
            }
        }
    }
}

fn css([r, g, b]: [u8; 3]) -> String {
    format!("rgb({r} {g} {b})")
}

/// A place along a bar in CSS.
fn percent(at: f64) -> String {
    format!("{:.3}%", 100.0 * at.clamp(0.0, 1.0))
}

/// A picture as a URL that holds all of it.
struct Embedded {
    url: String,
    width: u32,
    height: u32,
}

fn embedded(png: &[u8], name: &str) -> Result<Embedded> {
    let reader = png::Decoder::new(Cursor::new(png)).read_info();
    let reader = reader.map_err(|cause| {
        Error::failed(format!(
            "the report's picture \"{name}\" is not a PNG: {cause}"
        ))
    })?;
    let (width, height) = reader.info().size();
    Ok(Embedded {
        url: format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png)),
        width,
        height,
    })
}
