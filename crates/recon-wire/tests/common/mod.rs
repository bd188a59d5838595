//! What the tests share: a simple reader of streams, and packets of any content.
#![allow(dead_code)]
use proptest::prelude::*;
use recon_wire::packet::*;
use recon_wire::{Counters, Deframer, Limits, Packet, encode};

/// Small limits, so that properties reach them.
pub const SMALL: Limits = Limits {
    max_serial_bytes: 40,
    max_message_bytes: 300,
    max_jpeg_bytes: 9000,
    max_image_rows: 64,
    max_image_cols: 64,
    max_waypoints: 9,
    max_unknown_bytes: 3000,
    stall_timeout_ns: 2_000_000_000,
    age_timeout_ns: 10_000_000_000,
    work_per_call: u64::MAX,
};

/// All packets and the counters of a stream that comes in `parts` and then ends.
pub fn deframe<'a>(
    parts: impl IntoIterator<Item = &'a [u8]>,
    limits: Limits,
) -> (Vec<Packet>, Counters) {
    let mut deframer = Deframer::new(limits);
    let mut packets = Vec::new();
    for part in parts {
        deframer.push(part, 0, &mut |packet, _| packets.push(packet));
    }
    deframer.finish(&mut |packet, _| packets.push(packet));
    assert_eq!(deframer.pending_bytes(), 0);
    (packets, deframer.counters().clone())
}

/// `stream` cut at `cuts` (any numbers).
pub fn parts<'a>(stream: &'a [u8], cuts: &[usize]) -> Vec<&'a [u8]> {
    let mut places: Vec<usize> = cuts.iter().map(|cut| cut % (stream.len() + 1)).collect();
    places.extend([0, stream.len()]);
    places.sort_unstable();
    places
        .windows(2)
        .map(|pair| &stream[pair[0]..pair[1]])
        .collect()
}

/// Frame of a packet under the small limits.
pub fn frame(packet: &Packet) -> Vec<u8> {
    encode(packet, &SMALL).expect("within the small limits")
}

fn f32s() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits)
}

fn f64s() -> impl Strategy<Value = f64> {
    any::<u64>().prop_map(f64::from_bits)
}

/// Bytes with many syncs and headers in them.
pub fn nasty_bytes(most: usize) -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        3 => any::<u8>().prop_map(|byte| vec![byte]),
        1 => Just(vec![0xda]),
        1 => Just(vec![0xda, 0xa7]),
        1 => (0u32..400, any::<u8>()).prop_map(|(size, pid)| {
            let mut header = vec![0xda, 0xa7];
            header.extend_from_slice(&size.to_be_bytes());
            header.push(pid);
            header
        }),
        1 => Just(vec![0xda, 0xa7, 0, 0, 0, 0x0b, 3, 1, 253, 0x8d, 0x16]),
    ];
    prop::collection::vec(piece, 0..most.div_ceil(3)).prop_map(move |pieces| {
        let mut bytes = pieces.concat();
        bytes.truncate(most);
        bytes
    })
}

fn core_telemetry() -> impl Strategy<Value = Packet> {
    (
        any::<u8>(),
        prop::array::uniform7(f64s()),
        prop::array::uniform3(f32s()),
    )
        .prop_map(|(is_flying, wide, velocity)| {
            CoreTelemetry {
                is_flying,
                latitude_deg: wide[0],
                longitude_deg: wide[1],
                altitude_m: wide[2],
                height_above_takeoff_m: wide[3],
                velocity_north_mps: velocity[0],
                velocity_east_mps: velocity[1],
                velocity_down_mps: velocity[2],
                yaw_deg: wide[4],
                pitch_deg: wide[5],
                roll_deg: wide[6],
            }
            .into()
        })
}

fn extended_telemetry() -> impl Strategy<Value = Packet> {
    (
        prop::array::uniform8(any::<u8>()),
        any::<u16>(),
        any::<u16>(),
        nasty_bytes(40),
    )
        .prop_map(|(small, gnss_satellite_count, mission_id, serial)| {
            let status = ExtendedStatus {
                gnss_satellite_count,
                gnss_signal_level: small[0] as i8,
                max_height_reached: small[1],
                max_distance_reached: small[2],
                battery_percent: small[3],
                battery_warning: small[4],
                wind_level: small[5] as i8,
                camera_state: small[6],
                flight_mode: small[7],
                mission_id,
            };
            ExtendedTelemetry { status, serial }.into()
        })
}

fn image() -> impl Strategy<Value = Packet> {
    (f32s(), 0u16..48, 0u16..48, nasty_bytes(48 * 48 * 3)).prop_map(
        |(fps, rows, cols, mut pixels)| {
            pixels.resize(usize::from(rows) * usize::from(cols) * 3, 0xda);
            Image::new(fps, rows, cols, pixels)
                .expect("as many bytes as it takes")
                .into()
        },
    )
}

fn mission() -> impl Strategy<Value = Packet> {
    let waypoint = (prop::array::uniform3(f64s()), prop::array::uniform4(f32s())).prop_map(
        |(place, action)| Waypoint {
            latitude_deg: place[0],
            longitude_deg: place[1],
            altitude_m: place[2],
            corner_radius_m: action[0],
            speed_mps: action[1],
            loiter_time_s: action[2],
            gimbal_pitch_deg: action[3],
        },
    );
    (
        any::<u8>(),
        any::<u8>(),
        prop::collection::vec(waypoint, 1..=9),
    )
        .prop_map(|(land_at_end, curved_flight, waypoints)| {
            ExecuteWaypointMission {
                land_at_end,
                curved_flight,
                waypoints,
            }
            .into()
        })
}

fn stick() -> impl Strategy<Value = Packet> {
    (any::<u8>(), prop::array::uniform5(f32s())).prop_map(|(mode, values)| {
        VirtualStickCommand {
            mode,
            yaw_deg: values[0],
            velocity_x_mps: values[1],
            velocity_y_mps: values[2],
            height_above_takeoff_m: values[3],
            timeout_s: values[4],
        }
        .into()
    })
}

/// Any packet with any bits in its fields.
pub fn packet() -> impl Strategy<Value = Packet> {
    prop_oneof![
        core_telemetry(),
        extended_telemetry(),
        image(),
        mission(),
        stick(),
        (any::<u8>(), any::<u8>()).prop_map(|(positive, source_pid)| Acknowledgment {
            positive,
            source_pid
        }
        .into()),
        (any::<u8>(), nasty_bytes(300))
            .prop_map(|(kind, text)| MessageString { kind, text }.into()),
        (f32s(), nasty_bytes(9000)).prop_map(|(target_fps_hz, jpeg)| {
            CompressedImage {
                target_fps_hz,
                jpeg: jpeg.into(),
            }
            .into()
        }),
        any::<u8>().prop_map(|action| EmergencyCommand { action }.into()),
        (any::<u8>(), f32s()).prop_map(|(action, target_fps_hz)| CameraControl {
            action,
            target_fps_hz
        }
        .into()),
        (6u8..252, nasty_bytes(3000))
            .prop_map(|(pid, payload)| UnknownPacket { pid, payload }.into()),
    ]
}
