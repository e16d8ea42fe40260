//! A scatter plot in a page: its data, which the script draws to the width that there is.

use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};

use super::content::{Axis, Point, Scatter};
use super::figure::figure;

pub(super) fn html(plot: &Scatter) -> Markup {
    html! {
        figure.scatter.card {
            figcaption { h3 { (plot.title) } }
            script type="application/json" { (PreEscaped(in_script(&data(plot)))) }
            noscript { p { "The plot needs JavaScript; its figures are in the table." } }
        }
    }
}

fn data(plot: &Scatter) -> Value {
    json!({
        "title": plot.title,
        "x": axis(&plot.x),
        "y": axis(&plot.y),
        "points": plot.points.iter().map(point).collect::<Value>(),
    })
}

fn axis(axis: &Axis) -> Value {
    json!({ "label": axis.label, "unit": axis.unit })
}

fn point(point: &Point) -> Value {
    json!({
        "label": point.label,
        "group": point.group,
        "x": point.x,
        "y": point.y,
        "xText": figure(point.x),
        "yText": figure(point.y),
        "onFront": point.on_front,
        "details": point.details,
    })
}

/// JSON that cannot end the script element it stands in: `<`, which begins `</script>` and `<!--`,
/// only ever occurs in strings, where it may be escaped.
pub(super) fn in_script(value: &Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_ends_the_script() {
        let hostile = Scatter {
            title: "</script><!--<script>\"&\u{2028}".into(),
            ..Scatter::default()
        };
        let text = in_script(&data(&hostile));
        assert!(!text.contains('<'), "{text}");
        let back: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(back["title"], hostile.title);
    }

    #[test]
    fn a_figure_that_is_none_is_null() {
        let point = Point {
            x: f64::NAN,
            y: f64::INFINITY,
            ..Point::default()
        };
        let value = super::point(&point);
        assert_eq!(value["x"], Value::Null);
        assert_eq!(value["y"], Value::Null);
    }
}
