//! Speed of the wire: criterion's figures, then each floor asserted against a baseline of the same run.
use criterion::{Criterion, Throughput};
use recon_wire::checksum::Hash;
use recon_wire::packet::{CoreTelemetry, ExecuteWaypointMission, Image, Waypoint};
use recon_wire::{Deframer, Limits, Packet, encode, encode_into};
use std::hint::black_box;
use std::time::{Duration, Instant};

const READ_BYTES: usize = 64 * 1024;

fn noise(len: usize) -> Vec<u8> {
    let mut state = 1u64;
    let mut bytes = vec![0; len];
    for byte in &mut bytes {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        *byte = (state >> 56) as u8;
    }
    bytes
}

fn frame(packet: impl Into<Packet>) -> Vec<u8> {
    encode(&packet.into(), &Limits::default()).expect("within the limits")
}

/// About 8 MB of telemetry.
fn telemetry_stream() -> Vec<u8> {
    let frames = (0..100_000).map(|i| {
        let height = f64::from(i) / 1000.0;
        frame(CoreTelemetry {
            is_flying: 1,
            latitude_deg: 44.97,
            longitude_deg: -93.23,
            altitude_m: 280.0 + height,
            height_above_takeoff_m: height,
            velocity_north_mps: 3.5,
            velocity_east_mps: -1.25,
            velocity_down_mps: 0.1,
            yaw_deg: 92.5,
            pitch_deg: -4.0,
            roll_deg: 1.5,
        })
    });
    frames.collect::<Vec<_>>().concat()
}

fn image_stream() -> Vec<u8> {
    frame(Image::new(5.0, 1080, 1920, noise(1920 * 1080 * 3)).expect("as many bytes")).repeat(4)
}

fn longest_mission() -> Packet {
    let waypoint = Waypoint {
        latitude_deg: 44.97,
        longitude_deg: -93.23,
        altitude_m: 310.0,
        corner_radius_m: 0.2,
        speed_mps: 5.0,
        loiter_time_s: f32::NAN,
        gimbal_pitch_deg: f32::NAN,
    };
    ExecuteWaypointMission {
        land_at_end: 0,
        curved_flight: 0,
        waypoints: vec![waypoint; 99],
    }
    .into()
}

/// Feeds a stream in reads of 64 KiB; counts the packets.
fn deframe(deframer: &mut Deframer, stream: &[u8]) -> usize {
    let mut count = 0;
    for read in stream.chunks(READ_BYTES) {
        deframer.push(read, 0, &mut |packet, _| {
            black_box(&packet);
            count += 1;
        });
    }
    count
}

fn copy(to: &mut [u8], from: &[u8]) {
    to.copy_from_slice(black_box(from));
    black_box(to);
}

fn figures(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("wire");
    group
        .sample_size(20)
        .measurement_time(Duration::from_secs(1))
        .warm_up_time(Duration::from_millis(300));
    let data = noise(6_000_000);
    group.throughput(Throughput::Bytes(data.len() as u64));
    group.bench_function("checksum of 6 MB", |bench| {
        bench.iter(|| Hash::of(black_box(&data)))
    });
    let mut deframer = Deframer::default();
    for (name, stream) in [
        ("core telemetry", telemetry_stream()),
        ("1920x1080 images", image_stream()),
    ] {
        group.throughput(Throughput::Bytes(stream.len() as u64));
        group.bench_function(name, |bench| bench.iter(|| deframe(&mut deframer, &stream)));
    }
    let (mission, mut out) = (longest_mission(), Vec::with_capacity(4096));
    group.throughput(Throughput::Bytes(3971));
    group.bench_function("encode 99 waypoints", |bench| {
        bench.iter(|| encode_again(&mission, &mut out))
    });
    group.finish();
}

fn encode_again(packet: &Packet, out: &mut Vec<u8>) {
    out.clear();
    encode_into(black_box(packet), &Limits::default(), out).expect("within the limits");
    black_box(out);
}

/// Shortest time of each of two steps that take turns, so that both meet the same noise of the machine.
fn shortest_s(rounds: usize, mut first: impl FnMut(), mut second: impl FnMut()) -> (f64, f64) {
    let mut shortest = (f64::INFINITY, f64::INFINITY);
    for _ in 0..rounds {
        let start = Instant::now();
        first();
        let middle = Instant::now();
        second();
        shortest.0 = shortest.0.min((middle - start).as_secs_f64());
        shortest.1 = shortest.1.min(middle.elapsed().as_secs_f64());
    }
    shortest
}

struct Floors {
    missed: Vec<String>,
}

impl Floors {
    fn at_least(&mut self, what: &str, value: f64, floor: f64, unit: &str) {
        let line = format!("{what}: {value:.2} {unit} (at least {floor})");
        println!("{line}");
        if value < floor {
            self.missed.push(line);
        }
    }
}

/// The least work that touches every byte: how fast this machine can read at all.
fn read(bytes: &[u8]) -> u64 {
    let words = bytes.as_chunks::<8>().0.iter();
    words.fold(0, |sum, &word| sum.wrapping_add(u64::from_ne_bytes(word)))
}

/// The checksum of 6 MB is at least 12 times the byte loop, or as fast as the machine reads memory: where
/// the second holds, no program can do better. What fits the cache shows the computing itself.
fn checksum_floors(floors: &mut Floors) {
    for (what, len) in [("6 MB", 6_000_000), ("512 KiB, in cache", 512 * 1024)] {
        let (data, mut to) = (noise(len), vec![0; len]);
        let fast = || {
            black_box(Hash::of(black_box(&data)));
        };
        let byte_loop = || {
            black_box(Hash::default().then_slowly(black_box(&data)));
        };
        let (first_s, loop_s) = shortest_s(40, fast, byte_loop);
        let (second_s, copy_s) = shortest_s(60, fast, || copy(&mut to, &data));
        let (third_s, read_s) = shortest_s(60, fast, || {
            black_box(read(black_box(&data)));
        });
        let fast_s = first_s.min(second_s).min(third_s);
        let gbps = |seconds| len as f64 / seconds / 1e9;
        println!(
            "checksum of {what}: {:.1} GB/s; byte loop {:.2}, memcpy {:.1}, bare reading {:.1} GB/s",
            gbps(fast_s),
            gbps(loop_s),
            gbps(copy_s),
            gbps(read_s)
        );
        let times = loop_s / fast_s;
        println!(
            "  = {times:.1} x byte loop (12), {:.2} x bare reading",
            read_s / fast_s
        );
        let reached = (times / 12.0).max(read_s / fast_s / 0.9);
        floors.at_least(
            "  of 12 x byte loop, or of 0.9 x bare reading",
            reached,
            1.0,
            "x",
        );
        floors.at_least("  of memcpy", copy_s / fast_s, 0.8, "x");
    }
}

fn stream_floor(floors: &mut Floors, what: &str, stream: &[u8], packets: usize, floor_gbps: f64) {
    let mut to = vec![0; stream.len()];
    let mut deframer = Deframer::default();
    let (wire_s, copy_s) = shortest_s(
        30,
        || assert_eq!(deframe(&mut deframer, stream), packets),
        || copy(&mut to, stream),
    );
    println!("{what}: {:.3} of memcpy", copy_s / wire_s);
    floors.at_least(what, stream.len() as f64 / wire_s / 1e9, floor_gbps, "GB/s");
}

fn mission_floor(floors: &mut Floors) {
    const TIMES: usize = 2000;
    let (mission, mut out, mut to) = (longest_mission(), Vec::with_capacity(4096), vec![0; 3971]);
    let from = noise(3971);
    let (encode_s, copy_s) = shortest_s(
        30,
        || (0..TIMES).for_each(|_| encode_again(&mission, &mut out)),
        || (0..TIMES).for_each(|_| copy(&mut to, &from)),
    );
    let encode_us = encode_s / TIMES as f64 * 1e6;
    println!(
        "99 waypoints: {encode_us:.3} us, {:.1} x memcpy",
        encode_s / copy_s
    );
    floors.at_least("99 waypoints per second", 1.0 / encode_us, 0.5, "million");
}

/// A stream of false headers, each claiming a large image: searched no slower than this.
fn hostile_floor(floors: &mut Floors) {
    let mut stream = Vec::new();
    while stream.len() < 8_000_000 {
        let rows = (((8_000_100 - stream.len()) / 11_520) as u16).min(2160);
        stream.extend_from_slice(&[0xda, 0xa7]);
        stream.extend_from_slice(&(17 + 11_520 * u32::from(rows)).to_be_bytes());
        stream.extend_from_slice(&[2, 0, 0, 0, 0]);
        stream.extend_from_slice(&rows.to_be_bytes());
        stream.extend_from_slice(&3840u16.to_be_bytes());
    }
    let (hostile_s, loop_s) = shortest_s(
        5,
        || {
            let mut deframer = Deframer::default();
            deframe(&mut deframer, &stream);
            deframer.finish(&mut |packet, _| {
                black_box(packet);
            });
        },
        || {
            black_box(Hash::default().then_slowly(black_box(&stream)));
        },
    );
    println!("false headers: {:.3} of the byte loop", loop_s / hostile_s);
    floors.at_least(
        "false headers every 15 bytes",
        stream.len() as f64 / hostile_s / 1e9,
        0.5,
        "GB/s",
    );
}

fn assert_floors() {
    let mut floors = Floors { missed: Vec::new() };
    checksum_floors(&mut floors);
    stream_floor(
        &mut floors,
        "core telemetry",
        &telemetry_stream(),
        100_000,
        1.5,
    );
    stream_floor(&mut floors, "1920x1080 images", &image_stream(), 4, 4.0);
    mission_floor(&mut floors);
    hostile_floor(&mut floors);
    assert!(floors.missed.is_empty(), "too slow: {:#?}", floors.missed);
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    figures(&mut criterion);
    criterion.final_summary();
    assert_floors();
}
