//! The packets made of numbers only, and the waypoint.
use crate::convert::FromNumber;
use crate::repr;
use pyo3::prelude::*;
use recon_wire::packet::{self, Payload};

macro_rules! record_class {
    ($(#[$doc:meta])* $name:ident { $($field:ident: $type:ty),+ } $($pid:tt)*) => {
        $(#[$doc])*
        #[pyclass(frozen, eq, hash, module = "recon.wire")]
        #[derive(PartialEq, Eq, Hash)]
        pub struct $name(pub packet::$name);

        #[pymethods]
        impl $name {
            $($pid)*

            #[new]
            #[pyo3(signature = (*, $($field),+))]
            #[allow(clippy::too_many_arguments)]
            fn new($($field: &Bound<'_, PyAny>),+) -> PyResult<Self> {
                Ok(Self(packet::$name {
                    $($field: <$type>::from_number($field, stringify!($field))?,)+
                }))
            }

            $(
                #[getter]
                fn $field(&self) -> $type {
                    self.0.$field
                }
            )+

            fn __repr__(&self) -> String {
                let fields = [$(concat!(stringify!($field), "=").to_owned() + &repr::number(self.0.$field)),+];
                format!("{}({})", stringify!($name), fields.join(", "))
            }
        }
    };
}

record_class! {
    /// Position, velocity and attitude (PID 0, ICD 3.1.1).
    CoreTelemetry {
        is_flying: u8, latitude_deg: f64, longitude_deg: f64, altitude_m: f64,
        height_above_takeoff_m: f64, velocity_north_mps: f32, velocity_east_mps: f32,
        velocity_down_mps: f32, yaw_deg: f64, pitch_deg: f64, roll_deg: f64
    }
    #[classattr] const PID: u8 = packet::CoreTelemetry::PID;
}

record_class! {
    /// The app's answer to a command (PID 3, ICD 3.1.4).
    Acknowledgment { positive: u8, source_pid: u8 }
    #[classattr] const PID: u8 = packet::Acknowledgment::PID;
}

record_class! {
    /// Hover, land now, or return home and land (PID 255, ICD 3.2.1).
    EmergencyCommand { action: u8 }
    #[classattr] const PID: u8 = packet::EmergencyCommand::PID;
}

record_class! {
    /// Start or stop the images (PID 254, ICD 3.2.2).
    CameraControl { action: u8, target_fps_hz: f32 }
    #[classattr] const PID: u8 = packet::CameraControl::PID;
}

record_class! {
    /// Fly with this velocity, heading and height (PID 252, ICD 3.2.4).
    VirtualStickCommand {
        mode: u8, yaw_deg: f32, velocity_x_mps: f32, velocity_y_mps: f32,
        height_above_takeoff_m: f32, timeout_s: f32
    }
    #[classattr] const PID: u8 = packet::VirtualStickCommand::PID;
}

record_class! {
    /// One waypoint of a mission (ICD 3.2.3).
    Waypoint {
        latitude_deg: f64, longitude_deg: f64, altitude_m: f64, corner_radius_m: f32,
        speed_mps: f32, loiter_time_s: f32, gimbal_pitch_deg: f32
    }
}
