//! One typed function per kernel of `kernels/pass`: `&` is read, `&mut` is written.

mod adaptive_emission;
mod cast_emission;
mod cast_maximum;
mod cast_surface;
mod emission_inputs;
mod exact_projection;
mod exact_surface;
mod inputs;
mod run;
mod sample_field;
mod shade_surface;
mod surface_normal;
mod tone_curve;
mod window_value;

pub use adaptive_emission::adaptive_emission;
pub use cast_emission::cast_emission;
pub use cast_maximum::cast_maximum;
pub use cast_surface::cast_surface;
pub use emission_inputs::EmissionInputs;
pub use exact_projection::exact_projection;
pub use exact_surface::exact_surface;
pub use inputs::CastInputs;
pub use run::{Passes, Run};
pub use sample_field::sample_field;
pub use shade_surface::shade_surface;
pub use surface_normal::surface_normal;
pub use tone_curve::tone_curve;
pub use window_value::window_value;
