//! Camera Control, ICD 3.2.2.
use super::record::record;

record! {
    /// Start or stop the images; station to app.
    packet 254 CameraControl {
        /// 0 stop, 1 start.
        action: u8,
        /// Images per second wanted; ignored when stopping.
        target_fps_hz: f32,
    }
}
