//! The packets with a part of variable length.
use crate::convert::FromNumber;
use crate::records::Waypoint;
use crate::repr;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use recon_wire::packet::{self, Payload};

macro_rules! extended_telemetry {
    ($($field:ident: $type:ty),+) => {
        /// Slower telemetry and the vehicle's identity (PID 1, ICD 3.1.2).
        #[pyclass(frozen, eq, hash, module = "recon.wire")]
        #[derive(PartialEq, Eq, Hash)]
        pub struct ExtendedTelemetry(pub packet::ExtendedTelemetry);

        #[pymethods]
        impl ExtendedTelemetry {
            #[classattr]
            const PID: u8 = packet::ExtendedTelemetry::PID;

            #[new]
            #[pyo3(signature = (*, $($field,)+ serial))]
            #[allow(clippy::too_many_arguments)]
            fn new($($field: &Bound<'_, PyAny>,)+ serial: &Bound<'_, PyBytes>) -> PyResult<Self> {
                let status = packet::ExtendedStatus {
                    $($field: <$type>::from_number($field, stringify!($field))?,)+
                };
                let serial = serial.as_bytes().to_vec();
                Ok(Self(packet::ExtendedTelemetry { status, serial }))
            }

            $(
                #[getter]
                fn $field(&self) -> $type {
                    self.0.status.$field
                }
            )+

            #[getter]
            fn serial<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
                PyBytes::new(py, &self.0.serial)
            }

            fn __repr__(&self) -> String {
                let fields = [$(concat!(stringify!($field), "=").to_owned() + &repr::number(self.0.status.$field)),+];
                format!("ExtendedTelemetry({}, serial={})", fields.join(", "), repr::bytes(&self.0.serial))
            }
        }
    };
}

extended_telemetry!(
    gnss_satellite_count: u16, gnss_signal_level: i8, max_height_reached: u8,
    max_distance_reached: u8, battery_percent: u8, battery_warning: u8, wind_level: i8,
    camera_state: u8, flight_mode: u8, mission_id: u16
);

/// A line of text from the app (PID 4, later revisions).
#[pyclass(frozen, eq, hash, module = "recon.wire")]
#[derive(PartialEq, Eq, Hash)]
pub struct MessageString(pub packet::MessageString);

#[pymethods]
impl MessageString {
    #[classattr]
    const PID: u8 = packet::MessageString::PID;

    #[new]
    #[pyo3(signature = (*, r#type, text))]
    fn new(r#type: &Bound<'_, PyAny>, text: &Bound<'_, PyBytes>) -> PyResult<Self> {
        let kind = u8::from_number(r#type, "type")?;
        Ok(Self(packet::MessageString {
            kind,
            text: text.as_bytes().to_vec(),
        }))
    }

    #[getter]
    fn r#type(&self) -> u8 {
        self.0.kind
    }

    #[getter]
    fn text<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.text)
    }

    fn __repr__(&self) -> String {
        format!(
            "MessageString(type={}, text={})",
            self.0.kind,
            repr::bytes(&self.0.text)
        )
    }
}

/// One image as a JPEG file (PID 5, later revisions).
#[pyclass(frozen, eq, hash, module = "recon.wire")]
#[derive(PartialEq, Eq, Hash)]
pub struct CompressedImage(pub packet::CompressedImage);

#[pymethods]
impl CompressedImage {
    #[classattr]
    const PID: u8 = packet::CompressedImage::PID;

    #[new]
    #[pyo3(signature = (*, target_fps_hz, jpeg))]
    fn new(target_fps_hz: &Bound<'_, PyAny>, jpeg: &Bound<'_, PyBytes>) -> PyResult<Self> {
        let target_fps_hz = f32::from_number(target_fps_hz, "target_fps_hz")?;
        Ok(Self(packet::CompressedImage {
            target_fps_hz,
            jpeg: jpeg.as_bytes().into(),
        }))
    }

    #[getter]
    fn target_fps_hz(&self) -> f32 {
        self.0.target_fps_hz
    }

    #[getter]
    fn jpeg<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.jpeg)
    }

    fn __repr__(&self) -> String {
        let fps = repr::number(self.0.target_fps_hz);
        format!(
            "CompressedImage(target_fps_hz={fps}, jpeg=<{} bytes>)",
            self.0.jpeg.len()
        )
    }
}

/// Fly these waypoints (PID 253, ICD 3.2.3).
#[pyclass(frozen, eq, hash, module = "recon.wire")]
#[derive(PartialEq, Eq, Hash)]
pub struct ExecuteWaypointMission(pub packet::ExecuteWaypointMission);

#[pymethods]
impl ExecuteWaypointMission {
    #[classattr]
    const PID: u8 = packet::ExecuteWaypointMission::PID;

    #[new]
    #[pyo3(signature = (*, land_at_end, curved_flight, waypoints))]
    fn new(
        land_at_end: &Bound<'_, PyAny>,
        curved_flight: &Bound<'_, PyAny>,
        waypoints: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let mut taken = Vec::new();
        for waypoint in waypoints.try_iter()? {
            taken.push(waypoint?.cast::<Waypoint>()?.get().0);
        }
        Ok(Self(packet::ExecuteWaypointMission {
            land_at_end: u8::from_number(land_at_end, "land_at_end")?,
            curved_flight: u8::from_number(curved_flight, "curved_flight")?,
            waypoints: taken,
        }))
    }

    #[getter]
    fn land_at_end(&self) -> u8 {
        self.0.land_at_end
    }

    #[getter]
    fn curved_flight(&self) -> u8 {
        self.0.curved_flight
    }

    #[getter]
    fn waypoints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(
            py,
            self.0.waypoints.iter().map(|&waypoint| Waypoint(waypoint)),
        )
    }

    fn __repr__(&self) -> String {
        format!(
            "ExecuteWaypointMission(land_at_end={}, curved_flight={}, waypoints=<{} waypoints>)",
            self.0.land_at_end,
            self.0.curved_flight,
            self.0.waypoints.len()
        )
    }
}

/// A well-framed packet whose PID the document does not have.
#[pyclass(frozen, eq, hash, module = "recon.wire")]
#[derive(PartialEq, Eq, Hash)]
pub struct UnknownPacket(pub packet::UnknownPacket);

#[pymethods]
impl UnknownPacket {
    #[new]
    #[pyo3(signature = (*, pid, payload))]
    fn new(pid: &Bound<'_, PyAny>, payload: &Bound<'_, PyBytes>) -> PyResult<Self> {
        let pid = u8::from_number(pid, "pid")?;
        Ok(Self(packet::UnknownPacket {
            pid,
            payload: payload.as_bytes().to_vec(),
        }))
    }

    #[getter]
    fn pid(&self) -> u8 {
        self.0.pid
    }

    #[getter]
    fn payload<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.0.payload)
    }

    fn __repr__(&self) -> String {
        format!(
            "UnknownPacket(pid={}, payload={})",
            self.0.pid,
            repr::bytes(&self.0.payload)
        )
    }
}
