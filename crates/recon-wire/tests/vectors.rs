//! The golden packets of `vectors/`: decoding gives their fields, encoding gives their bytes.
mod common;

use common::deframe;
use recon_wire::field::Field;
use recon_wire::packet::*;
use recon_wire::{Limits, Packet, decode, encode};
use serde_json::{Map, Value, json};
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../vectors")
}

/// Every vector of a folder: name, bytes, description.
fn vectors(folder: &Path) -> Vec<(String, Vec<u8>, Value)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("the folder of vectors") {
        let path = entry.expect("readable").path();
        if path.extension().is_some_and(|extension| extension == "bin") {
            let text = fs::read_to_string(path.with_extension("json")).expect("its description");
            let description = serde_json::from_str(&text).expect("JSON");
            found.push((
                path.display().to_string(),
                fs::read(&path).expect("readable"),
                description,
            ));
        }
    }
    found
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A field as the vectors write it: integers as numbers, floats as the hex of their bits.
trait Shown {
    fn shown(self) -> Value;
}

macro_rules! shown {
    ($($integer:ty),+) => {$(impl Shown for $integer { fn shown(self) -> Value { self.into() } })+};
}
shown!(u8, i8, u16);

impl Shown for f32 {
    fn shown(self) -> Value {
        hex(&self.to_wire()).into()
    }
}

impl Shown for f64 {
    fn shown(self) -> Value {
        hex(&self.to_wire()).into()
    }
}

macro_rules! fields {
    ($packet:expr, $($field:ident),+) => {{
        let mut fields = Map::new();
        $(fields.insert(stringify!($field).to_owned(), $packet.$field.shown());)+
        fields
    }};
}

fn waypoint(point: &Waypoint) -> Map<String, Value> {
    fields!(
        point,
        latitude_deg,
        longitude_deg,
        altitude_m,
        corner_radius_m,
        speed_mps,
        loiter_time_s,
        gimbal_pitch_deg
    )
}

/// Fields of a packet as its vector writes them; of pixels and files all but their SHA-256.
fn describe(packet: &Packet) -> Map<String, Value> {
    match packet {
        Packet::CoreTelemetry(p) => fields!(
            p,
            is_flying,
            latitude_deg,
            longitude_deg,
            altitude_m,
            height_above_takeoff_m,
            velocity_north_mps,
            velocity_east_mps,
            velocity_down_mps,
            yaw_deg,
            pitch_deg,
            roll_deg
        ),
        Packet::ExtendedTelemetry(p) => {
            let mut fields = fields!(
                p.status,
                gnss_satellite_count,
                gnss_signal_level,
                max_height_reached,
                max_distance_reached,
                battery_percent,
                battery_warning,
                wind_level,
                camera_state,
                flight_mode,
                mission_id
            );
            fields.insert("serial".to_owned(), hex(&p.serial).into());
            fields
        }
        Packet::Image(p) => {
            let mut fields = fields!(p, target_fps_hz);
            fields.insert("rows".to_owned(), p.shape().0.into());
            fields.insert("cols".to_owned(), p.shape().1.into());
            fields
        }
        Packet::Acknowledgment(p) => fields!(p, positive, source_pid),
        Packet::MessageString(p) => {
            let text = json!({"type": p.kind, "text": hex(&p.text)});
            text.as_object().expect("an object").clone()
        }
        Packet::CompressedImage(p) => fields!(p, target_fps_hz),
        Packet::VirtualStickCommand(p) => {
            fields!(
                p,
                mode,
                yaw_deg,
                velocity_x_mps,
                velocity_y_mps,
                height_above_takeoff_m,
                timeout_s
            )
        }
        Packet::ExecuteWaypointMission(p) => {
            let mut fields = fields!(p, land_at_end, curved_flight);
            fields.insert(
                "waypoints".to_owned(),
                p.waypoints.iter().map(waypoint).collect(),
            );
            fields
        }
        Packet::CameraControl(p) => fields!(p, action, target_fps_hz),
        Packet::EmergencyCommand(p) => fields!(p, action),
        Packet::UnknownPacket(p) => {
            let mut fields = Map::new();
            fields.insert("payload".to_owned(), hex(&p.payload).into());
            fields
        }
    }
}

/// Pixels or file of a packet, which must be the frame's last bytes before the hash.
fn long_tail(packet: &Packet) -> Option<&[u8]> {
    match packet {
        Packet::Image(image) => Some(image.pixels()),
        Packet::CompressedImage(image) => Some(&image.jpeg),
        _ => None,
    }
}

fn folder_name(name: &str) -> String {
    let mut folder = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !folder.is_empty() {
            folder.push('_');
        }
        folder.extend(letter.to_lowercase());
    }
    folder
}

#[test]
fn every_golden_packet_decodes_to_its_fields_and_encodes_to_its_bytes() {
    let names = PIDS.iter().map(|&(name, _)| name).chain(["UnknownPacket"]);
    for folder in names.map(folder_name) {
        let vectors = vectors(&root().join(&folder));
        assert!(vectors.len() >= 6, "{folder} has {} cases", vectors.len());
        for (name, bytes, description) in vectors {
            let packet = decode(&bytes, &Limits::default())
                .unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(description["pid"], packet.pid(), "{name}");
            let mut expected = description["fields"].as_object().expect("fields").clone();
            expected.retain(|key, _| !key.ends_with("_sha256"));
            assert_eq!(
                Value::from(describe(&packet)),
                Value::from(expected),
                "{name}"
            );
            if let Some(tail) = long_tail(&packet) {
                assert_eq!(
                    tail,
                    &bytes[bytes.len() - 2 - tail.len()..bytes.len() - 2],
                    "{name}"
                );
            }
            assert_eq!(
                encode(&packet, &Limits::default()).as_ref(),
                Ok(&bytes),
                "{name}"
            );
            let (found, _) = deframe(bytes.chunks(1000), Limits::default());
            assert_eq!(found, [packet], "{name}");
        }
    }
}

#[test]
fn every_bad_stream_gives_what_its_description_states() {
    let vectors = vectors(&root().join("bad"));
    assert!(vectors.len() > 30);
    for (name, bytes, description) in vectors {
        if let Some(kind) = description["decode"].as_str() {
            let error = decode(&bytes, &Limits::default()).expect_err(&name);
            assert_eq!(error.kind(), kind, "{name}: {error}");
        }
        for chunk in [1, 7, 1000, usize::MAX] {
            let (found, counters) = deframe(bytes.chunks(chunk), Limits::default());
            let frames: Vec<Value> = found
                .iter()
                .map(|packet| hex(&encode(packet, &Limits::default()).expect("came whole")).into())
                .collect();
            assert_eq!(
                description["frames"],
                Value::from(frames),
                "{name} by {chunk}"
            );
            let shown = json!({
                "bad_hash": counters.bad_hash, "bad_size": counters.bad_size, "abandoned": counters.abandoned,
                "unknown_pid": counters.unknown_pid, "bytes_skipped": counters.bytes_skipped,
            });
            for (counter, expected) in description["counters"].as_object().expect("counters") {
                assert_eq!(&shown[counter], expected, "{name} by {chunk}: {counter}");
            }
        }
    }
}
