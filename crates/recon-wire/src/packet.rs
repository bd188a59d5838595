//! The packets, one file each, and the way between a packet and its frame.
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

use crate::checksum::Hash;
use crate::error::{Error, SizeRule};
use crate::field::Reader;
use crate::frame::{Claim, HEADER_BYTES, OVERHEAD_BYTES, SYNC, TRAILER_BYTES, claim};
use crate::limits::Limits;

/// What every packet of the document can do.
pub trait Payload: Sized {
    /// Its packet ID.
    const PID: u8;
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

        impl Packet {
            /// Its packet ID.
            pub fn pid(&self) -> u8 {
                match self {
                    $(Self::$name(_) => $name::PID,)+
                    Self::UnknownPacket(packet) => packet.pid,
                }
            }

            fn payload_bytes(&self) -> usize {
                match self {
                    $(Self::$name(packet) => packet.payload_bytes(),)+
                    Self::UnknownPacket(packet) => packet.payload.len(),
                }
            }

            fn check(&self, limits: &Limits) -> Result<(), Error> {
                match self {
                    $(Self::$name(packet) => packet.check(limits),)+
                    Self::UnknownPacket(packet) => packet.check(limits),
                }
            }

            fn write(&self, out: &mut Vec<u8>) -> Result<(), Error> {
                match self {
                    $(Self::$name(packet) => packet.write(out),)+
                    Self::UnknownPacket(packet) => {
                        out.extend_from_slice(&packet.payload);
                        Ok(())
                    }
                }
            }
        }

        /// Decodes the payload of a frame whose size and hash were found good.
        #[inline]
        pub(crate) fn decode_payload(pid: u8, payload: &[u8]) -> Result<Packet, Error> {
            let mut reader = Reader::new(payload);
            let packet = match pid {
                $($name::PID => Packet::$name($name::read(&mut reader)?),)+
                _ => Packet::UnknownPacket(UnknownPacket { pid, payload: reader.remaining().to_vec() }),
            };
            if reader.is_empty() {
                return Ok(packet);
            }
            let size = (OVERHEAD_BYTES + payload.len()) as u64;
            let expected = SizeRule::Exactly(size - reader.remaining().len() as u64);
            Err(Error::Size { pid, expected, came: size })
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

/// The frame of a packet. Fails when `limits` (or the wire) cannot carry a value.
pub fn encode(packet: &Packet, limits: &Limits) -> Result<Vec<u8>, Error> {
    let mut out = Vec::new();
    encode_into(packet, limits, &mut out)?;
    Ok(out)
}

/// Appends the frame of a packet to `out`, which stays as it was when this fails.
pub fn encode_into(packet: &Packet, limits: &Limits, out: &mut Vec<u8>) -> Result<(), Error> {
    packet.check(limits)?;
    let size = OVERHEAD_BYTES + packet.payload_bytes();
    let wire_size =
        u32::try_from(size).map_err(|_| too_many("the packet", "bytes", u32::MAX.into(), size))?;
    let start = out.len();
    out.reserve(size);
    out.extend_from_slice(&SYNC);
    out.extend_from_slice(&wire_size.to_be_bytes());
    out.push(packet.pid());
    if let Err(error) = packet.write(out) {
        out.truncate(start);
        return Err(error);
    }
    let hash = Hash::of(&out[start..]);
    out.extend_from_slice(&hash.to_bytes());
    Ok(())
}

/// The packet of one whole frame.
pub fn decode(frame: &[u8], limits: &Limits) -> Result<Packet, Error> {
    if let Some(&start) = frame.first_chunk::<2>()
        && start != SYNC
    {
        return Err(Error::Sync {
            came: u16::from_be_bytes(start),
        });
    }
    let (pid, size) = match claim(frame, limits)? {
        Claim::Wants(expected) => {
            return Err(Error::Short {
                field: "a packet",
                expected,
                came: frame.len(),
            });
        }
        Claim::Frame { pid, size } => (pid, size),
    };
    if frame.len() < size {
        return Err(Error::Short {
            field: "a packet",
            expected: size,
            came: frame.len(),
        });
    }
    if frame.len() > size {
        let (expected, came) = (SizeRule::Exactly(size as u64), frame.len() as u64);
        return Err(Error::Size {
            pid,
            expected,
            came,
        });
    }
    let (hashed, came) = frame.split_at(size - TRAILER_BYTES);
    let expected = Hash::of(hashed).to_bytes();
    if came != expected {
        return Err(Error::Hash {
            expected,
            came: [came[0], came[1]],
        });
    }
    decode_payload(pid, &hashed[HEADER_BYTES..])
}

/// Whether the document has a packet with this PID.
pub fn is_known(pid: u8) -> bool {
    PIDS.iter().any(|&(_, known)| known == pid)
}

fn too_many(field: &'static str, of_what: &str, most: u64, came: usize) -> Error {
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
