//! The packets of the ICD, one file each; [`crate::frame`] puts them into frames and takes them out.
mod acknowledgment;
mod camera_control;
mod compressed_image;
mod core_telemetry;
mod emergency_command;
mod execute_waypoint_mission;
mod extended_telemetry;
mod image;
mod message_string;
mod record;
mod unknown_packet;
mod virtual_stick_command;

pub use acknowledgment::Acknowledgment;
pub use camera_control::CameraControl;
pub use compressed_image::CompressedImage;
pub use core_telemetry::CoreTelemetry;
pub use emergency_command::EmergencyCommand;
pub use execute_waypoint_mission::{ExecuteWaypointMission, Waypoint};
pub use extended_telemetry::{ExtendedStatus, ExtendedTelemetry};
pub use image::Image;
pub use message_string::MessageString;
pub use unknown_packet::UnknownPacket;
pub use virtual_stick_command::VirtualStickCommand;

use crate::error::Error;
use crate::field::Reader;
use crate::limits::Limits;

/// What every packet of the document can do.
pub trait Payload: Sized {
    /// Its packet ID.
    const PID: u8;
    /// Bytes of every payload of this PID; None when they vary.
    const FIXED_BYTES: Option<usize> = None;
    /// Bytes of the payload.
    fn payload_bytes(&self) -> usize;
    /// Whether the wire and `limits` can carry it.
    fn check(&self, limits: &Limits) -> Result<(), Error>;
    /// Appends the payload.
    fn write(&self, out: &mut Vec<u8>) -> Result<(), Error>;
    /// Takes the packet off the front of a payload.
    fn read(reader: &mut Reader<'_>) -> Result<Self, Error>;
}

macro_rules! packets {
    ($($name:ident),+) => {
        /// Any packet.
        #[derive(Clone, Debug, PartialEq, Eq)]
        pub enum Packet {
            $(#[doc = concat!("See [`", stringify!($name), "`].")] $name($name),)+
            /// A well-framed packet with a PID that the document does not have.
            UnknownPacket(UnknownPacket),
        }

        /// Name and PID of every packet of the document.
        pub const PIDS: &[(&str, u8)] = &[$((stringify!($name), $name::PID)),+];

        /// Bytes of every payload with this PID; None when they vary or the PID is unknown.
        #[inline]
        pub(crate) fn fixed_bytes(pid: u8) -> Option<usize> {
            match pid {
                $($name::PID => $name::FIXED_BYTES,)+
                _ => None,
            }
        }

        impl Packet {
            /// Takes the packet with this PID off the front of a payload.
            #[inline]
            pub(crate) fn read(pid: u8, reader: &mut Reader<'_>) -> Result<Self, Error> {
                Ok(match pid {
                    $($name::PID => Self::$name($name::read(reader)?),)+
                    _ => Self::UnknownPacket(UnknownPacket { pid, payload: reader.remaining().to_vec() }),
                })
            }

            /// Its packet ID.
            pub fn pid(&self) -> u8 {
                match self {
                    $(Self::$name(_) => $name::PID,)+
                    Self::UnknownPacket(packet) => packet.pid,
                }
            }

            pub(crate) fn payload_bytes(&self) -> usize {
                match self {
                    $(Self::$name(packet) => packet.payload_bytes(),)+
                    Self::UnknownPacket(packet) => packet.payload.len(),
                }
            }

            pub(crate) fn check(&self, limits: &Limits) -> Result<(), Error> {
                match self {
                    $(Self::$name(packet) => packet.check(limits),)+
                    Self::UnknownPacket(packet) => packet.check(limits),
                }
            }

            pub(crate) fn write(&self, out: &mut Vec<u8>) -> Result<(), Error> {
                match self {
                    $(Self::$name(packet) => packet.write(out),)+
                    Self::UnknownPacket(packet) => {
                        out.extend_from_slice(&packet.payload);
                        Ok(())
                    }
                }
            }
        }

        $(impl From<$name> for Packet {
            fn from(packet: $name) -> Self {
                Self::$name(packet)
            }
        })+
    };
}

packets!(
    CoreTelemetry,
    ExtendedTelemetry,
    Image,
    Acknowledgment,
    MessageString,
    CompressedImage,
    VirtualStickCommand,
    ExecuteWaypointMission,
    CameraControl,
    EmergencyCommand
);

impl From<UnknownPacket> for Packet {
    fn from(packet: UnknownPacket) -> Self {
        Self::UnknownPacket(packet)
    }
}

/// Whether the document has a packet with this PID.
pub fn is_known(pid: u8) -> bool {
    PIDS.iter().any(|&(_, known)| known == pid)
}

pub(crate) fn too_many(field: &'static str, of_what: &str, most: u64, came: usize) -> Error {
    Error::Value {
        field,
        expected: format!("at most {most} {of_what}"),
        came: came.to_string(),
    }
}

fn at_most(field: &'static str, of_what: &str, most: u64, came: usize) -> Result<(), Error> {
    if came as u64 <= most {
        Ok(())
    } else {
        Err(too_many(field, of_what, most, came))
    }
}
