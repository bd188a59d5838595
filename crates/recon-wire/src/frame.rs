//! The frame around every payload (ICD 3): encoding, decoding, and the sizes each PID may have.
//!
//! `sync u16, size u32, PID u8, payload, hashA u8, hashB u8`; `size` counts all of it.
use crate::checksum::Hash;
use crate::error::{Error, SizeRule};
use crate::field::Reader;
use crate::limits::Limits;
use crate::packet::{
    CompressedImage, ExecuteWaypointMission, ExtendedTelemetry, Image, MessageString, Packet,
    Payload, fixed_bytes, too_many,
};

/// The sync field, 55975.
pub const SYNC: [u8; 2] = [0xda, 0xa7];
/// Bytes before the payload.
pub const HEADER_BYTES: usize = 7;
/// Bytes after the payload.
pub const TRAILER_BYTES: usize = 2;
/// Bytes around the payload.
pub const OVERHEAD_BYTES: usize = HEADER_BYTES + TRAILER_BYTES;

/// What the first bytes of a frame claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Claim {
    /// Too few bytes to judge the size; this many are wanted, counted from the sync.
    Wants(usize),
    /// The frame's PID and its size in bytes, which agrees with the lengths inside the payload.
    Frame {
        /// PID field.
        pid: u8,
        /// Bytes of the whole frame.
        size: usize,
    },
}

/// Judges the size field of a frame of which `bytes` are the first so far, sync first.
///
/// Fails as soon as the bytes show that the claim is impossible, before anything is allocated.
#[inline]
pub fn claim(bytes: &[u8], limits: &Limits) -> Result<Claim, Error> {
    let Some((&[_, _, s0, s1, s2, s3, pid], payload)) = bytes.split_first_chunk::<HEADER_BYTES>()
    else {
        return Ok(Claim::Wants(HEADER_BYTES));
    };
    let size = u32::from_be_bytes([s0, s1, s2, s3]);
    let expected = match rule(pid, payload, limits) {
        Ok(expected) => expected,
        Err(wanted) => return claim_before_lengths(pid, size, wanted, limits),
    };
    if !allows(expected, size.into()) {
        return Err(Error::Size {
            pid,
            expected,
            came: size.into(),
        });
    }
    Ok(Claim::Frame {
        pid,
        size: size as usize,
    })
}

/// The size is in, the payload's own lengths are not: refuse what no length could justify.
fn claim_before_lengths(
    pid: u8,
    size: u32,
    wanted: usize,
    limits: &Limits,
) -> Result<Claim, Error> {
    let (least, most) = match pid {
        ExtendedTelemetry::PID => (25, 25 + u64::from(limits.max_serial_bytes)),
        MessageString::PID => (14, 14 + u64::from(limits.max_message_bytes)),
        _ => (
            17,
            17 + 3 * u64::from(limits.max_image_rows) * u64::from(limits.max_image_cols),
        ),
    };
    let expected = SizeRule::Between(least, most);
    if allows(expected, size.into()) {
        Ok(Claim::Wants(wanted))
    } else {
        Err(Error::Size {
            pid,
            expected,
            came: size.into(),
        })
    }
}

/// What `size` must satisfy, or how many bytes of the frame are wanted before that is known.
#[inline]
fn rule(pid: u8, payload: &[u8], limits: &Limits) -> Result<SizeRule, usize> {
    if let Some(payload_bytes) = fixed_bytes(pid) {
        return Ok(SizeRule::Exactly((OVERHEAD_BYTES + payload_bytes) as u64));
    }
    Ok(match pid {
        ExtendedTelemetry::PID => {
            let claimed = u32::from_be_bytes(array_at(payload, 12)?).into();
            text_rule(25, claimed, limits.max_serial_bytes)
        }
        Image::PID => {
            let rows = u16::from_be_bytes(array_at(payload, 4)?);
            let cols = u16::from_be_bytes(array_at(payload, 6)?);
            image_rule((rows, cols), (limits.max_image_rows, limits.max_image_cols))
        }
        MessageString::PID => {
            let claimed = u32::from_be_bytes(array_at(payload, 1)?).into();
            text_rule(14, claimed, limits.max_message_bytes)
        }
        CompressedImage::PID => SizeRule::Between(13, 13 + u64::from(limits.max_jpeg_bytes)),
        ExecuteWaypointMission::PID => SizeRule::Waypoints(limits.max_waypoints.into()),
        _ => SizeRule::Between(9, 9 + u64::from(limits.max_unknown_bytes)),
    })
}

/// The bytes at `offset` of the payload, or how many bytes of the frame that takes.
fn array_at<const N: usize>(payload: &[u8], offset: usize) -> Result<[u8; N], usize> {
    payload
        .get(offset..)
        .and_then(|rest| rest.first_chunk())
        .copied()
        .ok_or(HEADER_BYTES + offset + N)
}

fn text_rule(empty_size: u64, claimed: u64, most: u32) -> SizeRule {
    let most = most.into();
    if claimed <= most {
        SizeRule::Exactly(empty_size + claimed)
    } else {
        SizeRule::Text {
            most,
            came: claimed,
        }
    }
}

fn image_rule(came: (u16, u16), most: (u16, u16)) -> SizeRule {
    if came.0 <= most.0 && came.1 <= most.1 {
        SizeRule::Exactly(17 + 3 * u64::from(came.0) * u64::from(came.1))
    } else {
        SizeRule::Image { most, came }
    }
}

#[inline]
fn allows(rule: SizeRule, size: u64) -> bool {
    match rule {
        SizeRule::Exactly(expected) => size == expected,
        SizeRule::Between(least, most) => (least..=most).contains(&size),
        SizeRule::Waypoints(most) => {
            size >= 51 && (size - 11).is_multiple_of(40) && (size - 11) / 40 <= most
        }
        SizeRule::Image { .. } | SizeRule::Text { .. } => false,
    }
}

/// Where the first sync in `bytes` begins: a whole one, or a last byte that may be its first half; the
/// length of `bytes` without one.
#[inline]
pub(crate) fn find_sync(bytes: &[u8]) -> usize {
    if bytes.starts_with(&SYNC) {
        return 0;
    }
    for at in memchr::memchr_iter(SYNC[0], bytes) {
        if bytes.get(at + 1).is_none_or(|&next| next == SYNC[1]) {
            return at;
        }
    }
    bytes.len()
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

/// Decodes the payload of a frame whose size and hash were found good.
#[inline]
pub(crate) fn decode_payload(pid: u8, payload: &[u8]) -> Result<Packet, Error> {
    let mut reader = Reader::new(payload);
    let packet = Packet::read(pid, &mut reader)?;
    if reader.is_empty() {
        return Ok(packet);
    }
    let size = (OVERHEAD_BYTES + payload.len()) as u64;
    let expected = SizeRule::Exactly(size - reader.remaining().len() as u64);
    Err(Error::Size {
        pid,
        expected,
        came: size,
    })
}
