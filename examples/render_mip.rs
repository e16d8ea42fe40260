//! A maximum intensity projection of a volume, seen from the patient's left.
//!
//! ```sh
//! cargo run --release --example render_mip -- head.nrrd head.png
//! ```

use angioray::scene::{Camera, View};
use angioray::{Device, Mode, Octree, Options, Renderer, Result, Scene, Subject, Volume, Wanted};

fn main() -> Result<()> {
    let mut arguments = std::env::args_os().skip(1);
    let (Some(volume), Some(picture)) = (arguments.next(), arguments.next()) else {
        eprintln!("usage: render_mip VOLUME PICTURE");
        std::process::exit(2);
    };
    let volume = Volume::open(volume)?;
    let subject = Subject::of(&volume);
    let mut scene = Scene::of_mode(Mode::Mip, &subject)?;
    scene.camera = Camera::of_view(View::Left, &subject, scene.size)?;

    let device = Device::first()?;
    let octree = Octree::of(&volume)?;
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default())?;
    let rendering = renderer.render(&scene, Wanted::DISPLAY)?;
    rendering.frame.save(&picture)?;
    println!("{:.1} ms on {}", rendering.render_ms, device.info().name);
    Ok(())
}
