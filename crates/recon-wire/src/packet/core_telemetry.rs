//! Core Telemetry, ICD 3.1.1.
use super::record::record;

record! {
    /// Position, velocity and attitude, at about 10 Hz; app to station.
    packet 0 CoreTelemetry {
        /// 1 when flying, 0 when not.
        is_flying: u8,
        /// WGS84 latitude.
        latitude_deg: f64,
        /// WGS84 longitude.
        longitude_deg: f64,
        /// WGS84 altitude as the app knows it.
        altitude_m: f64,
        /// HAG: barometric height above the takeoff point.
        height_above_takeoff_m: f64,
        /// V_N.
        velocity_north_mps: f32,
        /// V_E.
        velocity_east_mps: f32,
        /// V_D, positive down.
        velocity_down_mps: f32,
        /// Yaw, 0 north, clockwise.
        yaw_deg: f64,
        /// Pitch, positive nose up.
        pitch_deg: f64,
        /// Roll, positive right side down.
        roll_deg: f64,
    }
}
