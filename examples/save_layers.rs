//! An isosurface with its layers in one EXR file: depth, normals, and what is proven of each pixel.
//!
//! ```sh
//! cargo run --release --example save_layers -- head.nrrd head.exr
//! ```

use angioray::frame::{DEPTH, Layer};
use angioray::{Device, Mode, Octree, Options, Renderer, Result, Scene, Subject, Volume, Wanted};

fn main() -> Result<()> {
    let mut arguments = std::env::args_os().skip(1);
    let (Some(volume), Some(picture)) = (arguments.next(), arguments.next()) else {
        eprintln!("usage: save_layers VOLUME PICTURE.exr");
        std::process::exit(2);
    };
    let volume = Volume::open(volume)?;
    let scene = Scene::of_mode(Mode::Iso, &Subject::of(&volume))?;

    let device = Device::first()?;
    let octree = Octree::of(&volume)?;
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default())?;
    let wanted = Wanted::NONE.with([Layer::Depth, Layer::Normal, Layer::Kind, Layer::Certificate]);
    let frame = renderer.render(&scene, wanted)?.frame;
    frame.save(&picture)?;

    let depths_mm = frame.plane(DEPTH).unwrap_or_default();
    let hits = depths_mm
        .iter()
        .filter(|depth_mm| depth_mm.is_finite())
        .count();
    let nearest_mm = depths_mm.iter().copied().fold(f32::INFINITY, f32::min);
    println!(
        "{hits} of {} pixels hit, the nearest at {nearest_mm} mm",
        depths_mm.len()
    );
    println!("{} pixels are undecided", frame.undecided().unwrap_or(0));
    Ok(())
}
