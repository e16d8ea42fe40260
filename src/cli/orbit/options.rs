//! The flags that `orbit` adds to a rendering's.

use crate::batch::ShardChoice;
use crate::frame::FrameRate;
use crate::options::group::group;
use crate::options::text_form::readable;
use crate::options::{AngleDeg, Switch};
use crate::scene::{FrameCount, OrbitAxis};

group! {
    /// How the camera turns, and which frames are made.
    #[command(next_help_heading = "Orbit")]
    pub struct OrbitOptions {
        /// Number of frames; frame k is turned by k·degrees/N, so that a whole turn closes without
        /// a repeated frame
        #[arg(long, value_name = "N", allow_hyphen_values = true)]
        frames: FrameCount,

        /// How far the camera turns in all, right-handed about the axis: about up the eye moves to
        /// the picture's right, as with --azimuth [default: 360]
        #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
        degrees: AngleDeg,

        /// The axis of rotation, through the target: up or right as in the first frame's picture, a
        /// world axis, or a direction in world space; z is the patient's long axis, about which a
        /// C-arm turns [default: up]
        #[arg(long, value_name = "up|right|x|y|z|X,Y,Z", allow_hyphen_values = true)]
        axis: OrbitAxis,

        /// Frames per second of an animation [default: 30]
        #[arg(long, value_name = "F", allow_hyphen_values = true)]
        fps: FrameRate,

        /// Keep finished frames of the same scene, volume and device (.png, .exr, and those of an
        /// animation that was stopped), and make the others
        #[arg(long, value_name = "on|off", num_args = 0..=1, require_equals = true,
            default_missing_value = "on")]
        resume: Switch,

        /// Make every Nth frame only, from frame I on, I from 0 to N-1; auto: as a Slurm array, srun
        /// or MPI says. A file of --stats then has a place for I in its name, such as stats-%d.json
        #[arg(long, value_name = "I/N|auto", allow_hyphen_values = true)]
        shard: ShardChoice,
    }
}

readable!(FrameCount, FrameRate, OrbitAxis, ShardChoice);
