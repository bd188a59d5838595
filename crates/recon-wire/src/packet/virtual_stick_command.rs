//! VirtualStick Command, ICD 3.2.4.
use super::record::record;

record! {
    /// Fly with this velocity, heading and height; station to app.
    packet 252 VirtualStickCommand {
        /// 0 mode A (north and east), 1 mode B (forward and right).
        mode: u8,
        /// Yaw, 0 north, clockwise.
        yaw_deg: f32,
        /// V_x: north in mode A, forward in mode B.
        velocity_x_mps: f32,
        /// V_y: east in mode A, right in mode B.
        velocity_y_mps: f32,
        /// HAG: height above the takeoff point.
        height_above_takeoff_m: f32,
        /// After this long without a newer command V_x and V_y become 0.
        timeout_s: f32,
    }
}
