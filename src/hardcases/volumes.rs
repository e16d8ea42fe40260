use super::HardScene;
use super::view::{OBLIQUE, View};
use crate::volume::Volume;

pub fn scenes(name: &str, _member: usize, volume: &Volume) -> Vec<HardScene> {
    let range = volume.range();
    let unit_mm = 4.0 * volume.geometry().smallest_spacing_mm();
    let whole = View::whole("", volume, OBLIQUE);
    match name {
        "constant" => {
            let view = whole.size(17, 17);
            vec![
                view.iso(77.0, true),
                view.iso(77.0, false),
                view.iso(77.5, true),
                view.mip(),
            ]
        }
        "orientations" => {
            let view = whole.size(48, 48);
            vec![view.iso(120.0, true)]
        }
        "wide-index" => vec![whole.size(41, 41).iso(127.0, true)],
        "clip-planes" => vec![whole.size(41, 41).iso(127.0, true)],
        _ => {
            let view = whole.size(17, 17);
            let points = [(range.at(0.1), 0.0), (range.at(0.9), 0.5)];
            let mut scenes = vec![view.iso(range.at(0.45), true), view.mip()];
            if range.width() > 0.0 {
                scenes.push(view.dvr("dvr", unit_mm, &points));
            }
            scenes
        }
    }
}
