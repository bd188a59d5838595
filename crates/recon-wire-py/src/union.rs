//! Any packet, between Rust and Python.
use crate::image::Image;
use crate::packets::{
    CompressedImage, ExecuteWaypointMission, ExtendedTelemetry, MessageString, UnknownPacket,
};
use crate::records::{
    Acknowledgment, CameraControl, CoreTelemetry, EmergencyCommand, VirtualStickCommand, Waypoint,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use recon_wire::Packet;

macro_rules! packets {
    ($($name:ident),+) => {
        /// Adds the class of every packet to the module, and the waypoint's.
        pub fn add_packets(module: &Bound<'_, PyModule>) -> PyResult<()> {
            module.add_class::<Waypoint>()?;
            module.add_class::<Image>()?;
            $(module.add_class::<$name>()?;)+
            Ok(())
        }

        /// The Python object of a packet.
        pub fn to_python(py: Python<'_>, packet: Packet) -> PyResult<Py<PyAny>> {
            Ok(match packet {
                Packet::Image(packet) => Py::new(py, Image::around(py, packet)?)?.into_any(),
                $(Packet::$name(packet) => Py::new(py, $name(packet))?.into_any(),)+
            })
        }

        /// The packet of a Python object; TypeError for anything else.
        pub fn from_python(object: &Bound<'_, PyAny>) -> PyResult<Packet> {
            if let Ok(image) = object.cast::<Image>() {
                return Ok(image.get().to_packet(object.py())?.into());
            }
            $(
                if let Ok(packet) = object.cast::<$name>() {
                    return Ok(packet.get().0.clone().into());
                }
            )+
            let name = object.get_type().name()?;
            Err(PyTypeError::new_err(format!("expected a packet of recon.wire, came {name}")))
        }
    };
}

packets!(
    CoreTelemetry,
    ExtendedTelemetry,
    Acknowledgment,
    MessageString,
    CompressedImage,
    VirtualStickCommand,
    ExecuteWaypointMission,
    CameraControl,
    EmergencyCommand,
    UnknownPacket
);
