//! Half packets and time, false headers and work.
mod common;

use common::deframe;
use recon_wire::checksum::Hash;
use recon_wire::packet::{Acknowledgment, CompressedImage, EmergencyCommand};
use recon_wire::{Deframer, Error, Limits, Packet, SizeRule, decode, encode};

const MS: i64 = 1_000_000;

fn ack() -> (Packet, Vec<u8>) {
    let packet = Acknowledgment {
        positive: 1,
        source_pid: 253,
    }
    .into();
    let frame = encode(&packet, &Limits::default()).expect("small");
    (packet, frame)
}

/// The first bytes of an image that claims 25 MB.
fn false_header() -> Vec<u8> {
    let mut header = vec![0xda, 0xa7];
    header.extend_from_slice(&(17 + 3 * 2160 * 3840u32).to_be_bytes());
    header.extend_from_slice(&[2, 0, 0, 0, 0, 0x08, 0x70, 0x0f, 0x00]);
    header
}

/// Pushes at the given times (ms) and returns what came at each, then what a tick at `tick_ms` gives.
fn run(pushes: &[(i64, &[u8])], tick_ms: i64) -> (Vec<usize>, usize) {
    let mut deframer = Deframer::default();
    let mut counts = Vec::new();
    for &(at_ms, data) in pushes {
        let mut count = 0;
        deframer.push(data, at_ms * MS, &mut |_, _| count += 1);
        counts.push(count);
    }
    let mut count = 0;
    deframer.tick(tick_ms * MS, &mut |_, _| count += 1);
    (counts, count)
}

#[test]
fn a_stalled_half_packet_gives_up_what_it_hides_after_two_seconds() {
    let hiding = [false_header(), ack().1].concat();
    assert_eq!(run(&[(0, &hiding)], 1999), (vec![0], 0));
    assert_eq!(run(&[(0, &hiding)], 2000), (vec![0], 1));
}

#[test]
fn progress_resets_the_stall_but_not_the_age() {
    let (header, frame) = (false_header().repeat(3), ack().1);
    let mut pushes: Vec<(i64, &[u8])> = vec![(0, &header)];
    pushes.extend((1..=9).map(|second| (second * 1000, &frame[..])));
    assert_eq!(run(&pushes, 9999).1, 0);
    assert_eq!(run(&pushes, 10_000).1, 9);
}

#[test]
fn half_a_good_packet_behind_an_old_header_keeps_its_own_time() {
    let (packet, frame) = ack();
    let mut deframer = Deframer::default();
    let mut found = Vec::new();
    let mut push = |data: &[u8], at_ms: i64| {
        deframer.push(data, at_ms * MS, &mut |packet, _| found.push(packet));
    };
    push(&false_header(), 0);
    for at_ms in (1000..9900).step_by(500) {
        push(&[0], at_ms);
    }
    push(&frame[..6], 9900);
    push(&frame[6..], 10_100);
    assert_eq!(found, [packet]);
}

#[test]
fn half_a_packet_behind_found_ones_keeps_its_own_time() {
    let (packet, frame) = ack();
    let mut deframer = Deframer::default();
    let mut found = Vec::new();
    let mut push = |data: &[u8], at_ms: i64| {
        deframer.push(data, at_ms * MS, &mut |packet, _| found.push(packet));
    };
    push(&[false_header(), frame.repeat(20)].concat(), 0);
    for at_ms in (1000..9900).step_by(500) {
        push(&frame, at_ms);
    }
    push(&frame[..6], 9900);
    push(&[], 10_000);
    push(&frame[6..], 11_000);
    assert_eq!(found, vec![packet; 39]);
}

#[test]
fn late_bytes_after_a_stall_find_the_half_packet_gone() {
    let (_, frame) = ack();
    let (first, rest) = frame.split_at(5);
    assert_eq!(
        run(&[(0, first), (2500, rest), (2600, &frame)], 2700),
        (vec![0, 0, 1], 0)
    );
}

#[test]
fn a_clock_that_runs_backwards_loses_nothing() {
    let (_, frame) = ack();
    let (first, rest) = frame.split_at(5);
    assert_eq!(
        run(&[(5000, first), (0, rest), (-5000, &frame)], 5000).0,
        [0, 1, 1]
    );
}

/// Bytes in which every 13th starts a header of an image that claims almost all that follows.
fn headers_everywhere(len: usize) -> Vec<u8> {
    let mut stream = Vec::with_capacity(len);
    while stream.len() + 15 < len {
        let rows = ((len - stream.len() - 17) / (3 * 3840)).min(2160) as u16;
        let size = 17 + 3 * 3840 * u32::from(rows);
        stream.extend_from_slice(&[0xda, 0xa7]);
        stream.extend_from_slice(&size.to_be_bytes());
        stream.extend_from_slice(&[2, 0, 0, 0, 0]);
        stream.extend_from_slice(&rows.to_be_bytes());
        stream.extend_from_slice(&3840u16.to_be_bytes());
    }
    stream
}

/// Work grows with the stream, not with its square: hashing each of the 200,000 claims from its bytes
/// would read 300 GB here, and the test would not come to its end. (One claim in 65,536 has a hash that fits
/// by chance and is delivered: a good hash never means plausible.)
#[test]
fn false_headers_in_a_large_image_cost_linear_work() {
    let hostile = headers_everywhere(3_000_000);
    let (_, frame) = ack();
    let stream = [hostile, frame].concat();
    for chunk in [stream.len(), 65_536] {
        let (found, counters) = deframe(stream.chunks(chunk), Limits::default());
        assert_eq!(found.last(), Some(&ack().0));
        assert!(counters.bad_hash > 10_000, "{counters:?}");
    }
}

#[test]
fn a_large_file_stays_in_the_buffer_it_came_in() {
    let jpeg: Vec<u8> = (0..100_000u32).map(|i| (i % 251) as u8).collect();
    let packet: Packet = CompressedImage {
        target_fps_hz: 1.0,
        jpeg: jpeg.into(),
    }
    .into();
    let frame = encode(&packet, &Limits::default()).expect("below 16 MiB");
    let stream = [frame, ack().1].concat();
    let (found, _) = deframe(stream.chunks(4096), Limits::default());
    assert_eq!(found, [packet, ack().0]);
    let Some(Packet::CompressedImage(image)) = found.into_iter().next() else {
        panic!("no file")
    };
    let (buffer, shown) = image.jpeg.into_parts();
    assert_eq!(
        (shown.start, shown.end, buffer.len()),
        (11, 100_011, 100_011)
    );
}

#[test]
fn memory_follows_the_bytes_not_the_claim_of_four_gigabytes() {
    let mut claim =
        encode(&EmergencyCommand { action: 0 }.into(), &Limits::default()).expect("small");
    claim[2..6].copy_from_slice(&[0xff; 4]);
    let mut deframer = Deframer::default();
    deframer.push(&claim, 0, &mut |packet, _| panic!("{packet:?}"));
    assert_eq!(
        (deframer.pending_bytes(), deframer.counters().bad_size),
        (0, 1)
    );
}

#[test]
fn a_frame_with_more_behind_it_is_no_frame() {
    let (_, mut frame) = ack();
    frame.push(0);
    let expected = Error::Size {
        pid: 3,
        expected: SizeRule::Exactly(11),
        came: 12,
    };
    assert_eq!(decode(&frame, &Limits::default()), Err(expected));
}

#[test]
fn the_hash_of_a_frame_covers_the_sync() {
    let (_, frame) = ack();
    assert_eq!(Hash::of(&frame[..9]).to_bytes(), frame[9..]);
}
