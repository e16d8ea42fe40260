//! How wrong a picture is: emission and absorption at two step lengths, each against the reference.
//!
//! ```sh
//! cargo run --release --example reference_error -- head.nrrd
//! ```

use angioray::extent::ImageSize;
use angioray::frame::error::color_error;
use angioray::progress::Silent;
use angioray::reference;
use angioray::scene::StepVoxels;
use angioray::{Device, Mode, Octree, Options, Renderer, Result, Scene, Subject, Volume, Wanted};

fn main() -> Result<()> {
    let Some(volume) = std::env::args_os().nth(1) else {
        eprintln!("usage: reference_error VOLUME");
        std::process::exit(2);
    };
    let volume = Volume::open(volume)?;
    let mut scene = Scene::of_mode(Mode::Dvr, &Subject::of(&volume))?;
    scene.size = ImageSize::new(64, 64)?;
    let expected = reference::render(&volume, &scene, Wanted::DISPLAY, &Silent)?;

    let device = Device::first()?;
    let octree = Octree::of(&volume)?;
    let mut renderer = Renderer::new(&device, &volume, &octree, Options::default())?;
    for step_voxels in [1.0, 0.25] {
        scene.sampling.step = StepVoxels::new(step_voxels)?;
        let frame = renderer.render(&scene, Wanted::DISPLAY)?.frame;
        let error = color_error(&expected, &frame)?;
        println!(
            "step {step_voxels}: rmse {:.2e}, at most {:.2} of 255",
            error.rmse,
            255.0 * error.max
        );
    }
    Ok(())
}
