//! What a hostile or broken peer may cost: memory, work per call, and the age of what it withheld.
mod common;

use common::deframe;
use recon_wire::packet::{Acknowledgment, Image};
use recon_wire::{Deframer, Limits, Packet, encode};

const MS: i64 = 1_000_000;
const ROWS: u16 = 2160;
const COLS: u16 = 3840;
const FRAME_BYTES: usize = 17 + 3 * ROWS as usize * COLS as usize;

fn ack() -> Vec<u8> {
    let packet = Acknowledgment {
        positive: 1,
        source_pid: 253,
    };
    encode(&packet.into(), &Limits::default()).expect("small")
}

/// The first bytes of an image of this size.
fn header(rows: u16, cols: u16) -> Vec<u8> {
    let size = 17 + 3 * u32::from(rows) * u32::from(cols);
    let size = size.to_be_bytes();
    let (rows, cols) = (rows.to_be_bytes(), cols.to_be_bytes());
    [&[0xda, 0xa7][..], &size, &[2, 0, 0, 0, 0], &rows, &cols].concat()
}

fn large_image() -> Vec<u8> {
    let pixels: Vec<u8> = (0..FRAME_BYTES - 17).map(|i| (i % 199) as u8).collect();
    let image = Image::new(1.0, ROWS, COLS, pixels).expect("as many bytes as it takes");
    encode(&image.into(), &Limits::default()).expect("within the limits")
}

#[test]
fn a_claimed_size_reserves_nothing() {
    let mut deframer = Deframer::default();
    deframer.push(&header(ROWS, COLS), 0, &mut |_, _| panic!("a header only"));
    assert_eq!(deframer.pending_bytes(), 15);
    assert!(
        deframer.buffered_bytes() < 1024,
        "{}",
        deframer.buffered_bytes()
    );
}

#[test]
fn memory_follows_what_came_and_is_given_back() {
    let (mut deframer, mut found) = (Deframer::default(), 0);
    for read in large_image().chunks(32_768) {
        deframer.push(read, 0, &mut |_, _| found += 1);
        let most = deframer.pending_bytes() * 21 / 10 + 65_536;
        assert!(
            deframer.buffered_bytes() <= most,
            "{}",
            deframer.buffered_bytes()
        );
    }
    assert_eq!((found, deframer.buffered_bytes()), (1, 0));
}

#[test]
fn what_a_failed_frame_took_is_given_back_while_its_end_waits() {
    let mut image = large_image();
    image[100] ^= 1;
    let mut deframer = Deframer::default();
    deframer.push(&[&image[..], &ack()[..5]].concat(), 0, &mut |_, _| {});
    assert_eq!(deframer.pending_bytes(), 5);
    assert!(
        deframer.buffered_bytes() <= 65_536,
        "{}",
        deframer.buffered_bytes()
    );
}

/// Packets, calls, and the most work of one call, of a stream in reads of 32 KiB.
fn bounded(stream: &[u8], work_per_call: u64) -> (Vec<Packet>, usize, u64) {
    let limits = Limits {
        work_per_call,
        ..Limits::default()
    };
    let mut deframer = Deframer::new(limits);
    let (mut found, mut calls, mut most, mut done) = (Vec::new(), 0, 0, 0);
    let mut count = |deframer: &Deframer| {
        calls += 1;
        most = most.max(deframer.work_done() - done);
        done = deframer.work_done();
    };
    let mut sink = |packet, _| found.push(packet);
    for read in stream.chunks(32_768) {
        deframer.push(read, 0, &mut sink);
        count(&deframer);
        while deframer.is_busy() {
            deframer.resume(&mut sink);
            count(&deframer);
        }
    }
    deframer.finish(&mut sink);
    count(&deframer);
    while deframer.is_busy() {
        deframer.resume(&mut sink);
        count(&deframer);
    }
    (found, calls, most)
}

/// Beyond its limit a call goes on to the end of one frame or one search at most.
const ONE_STEP: u64 = 3 * 65_536;

#[test]
fn a_call_searches_a_hostile_frame_within_its_limit_of_work() {
    let mut hostile = header(ROWS, COLS);
    while hostile.len() + 15 < FRAME_BYTES {
        let rows = ((FRAME_BYTES - hostile.len() - 17) / (3 * 3840)) as u16;
        hostile.extend(header(rows, 3840));
    }
    hostile.resize(FRAME_BYTES, 0);
    let stream = [hostile, ack()].concat();
    let (found, calls, most) = bounded(&stream, 4 << 20);
    let (expected, _) = deframe([&stream[..]], Limits::default());
    assert_eq!(found, expected);
    println!("hostile frame: {calls} calls, at most {most} work each");
    assert!(most <= (4 << 20) + ONE_STEP, "{most}");
}

#[test]
fn a_call_delivers_packets_hidden_in_a_large_frame_within_its_limit_of_work() {
    let mut hostile = header(ROWS, COLS);
    while hostile.len() + 11 < FRAME_BYTES {
        hostile.extend(ack());
    }
    let packets = (FRAME_BYTES - 15) / 11;
    hostile.resize(FRAME_BYTES, 0);
    let (found, calls, most) = bounded(&hostile, 4 << 20);
    assert!(found.len().abs_diff(packets) <= 1);
    assert!(calls >= packets / 64, "{calls}");
    assert!(most <= (4 << 20) + ONE_STEP, "{most}");
}

#[test]
fn a_withheld_packet_has_the_time_its_last_byte_came() {
    let mut deframer = Deframer::default();
    let mut found = Vec::new();
    let mut push = |data: &[u8], at_ms: i64| {
        deframer.push(data, at_ms * MS, &mut |_, arrival| {
            found.push(arrival.at_ns / MS)
        });
    };
    push(&[header(ROWS, COLS), ack()[..4].to_vec()].concat(), 0);
    push(&ack()[4..], 40);
    for at_ms in (1500..10_000).step_by(1500) {
        push(&[0], at_ms);
    }
    push(&ack(), 10_500);
    assert_eq!(found, [40, 10_500]);
}

#[test]
fn arrivals_never_run_backwards() {
    let mut deframer = Deframer::default();
    let mut found = Vec::new();
    let mut push = |data: &[u8], at_ms: i64| {
        deframer.push(data, at_ms * MS, &mut |_, arrival| {
            found.push(arrival.at_ns / MS)
        });
    };
    push(&ack()[..5], 0);
    push(&[&ack()[5..], &header(1, 20)[..], &ack()[..3]].concat(), 5);
    push(&ack()[3..], 8);
    push(&[0; 60], 9);
    assert_eq!(found, [5, 5]);
}

#[test]
fn time_in_which_it_was_not_read_is_no_wait() {
    let (mut deframer, mut found) = (Deframer::default(), 0);
    deframer.push(&ack()[..5], 0, &mut |_, _| {});
    deframer.excuse(3000 * MS);
    deframer.push(&ack()[5..], 3100 * MS, &mut |_, _| found += 1);
    assert_eq!(found, 1);
    deframer.push(&ack()[..5], 4000 * MS, &mut |_, _| {});
    deframer.push(&ack()[5..], 6100 * MS, &mut |_, _| found += 1);
    assert_eq!((found, deframer.counters().abandoned), (1, 1));
}

#[test]
fn an_excused_time_counts_for_the_age_too() {
    let (mut deframer, mut found) = (Deframer::default(), 0);
    deframer.push(&header(1, 3), 0, &mut |_, _| {});
    for at_ms in (1000..9000).step_by(1000) {
        deframer.push(&[0], at_ms * MS, &mut |_, _| {});
    }
    deframer.excuse(3000 * MS);
    deframer.push(&[0], 12_000 * MS, &mut |_, _| {});
    deframer.push(&[0], 12_900 * MS, &mut |_, _| found += 1);
    assert_eq!(deframer.counters().abandoned, 0);
    deframer.push(&[0], 13_000 * MS, &mut |_, _| {});
    assert_eq!(deframer.counters().abandoned, 1);
    assert_eq!(found, 0);
}

#[test]
fn the_bytes_of_a_damaged_or_unfinished_frame_are_counted_apart() {
    let mut image = header(100, 100);
    image.resize(30_017, 7);
    let stream = [&b"garbage"[..], &image, &ack()].concat();
    let (_, counters) = deframe([&stream[..]], Limits::default());
    assert_eq!(
        (counters.bytes_skipped, counters.bytes_damaged),
        (30_024, 30_017)
    );

    let mut deframer = Deframer::default();
    deframer.push(&image[..10_000], 0, &mut |_, _| {});
    deframer.push(&image[10_000..], 2600 * MS, &mut |_, _| {});
    deframer.push(b"garbage", 2600 * MS, &mut |_, _| {});
    let counters = deframer.counters();
    assert_eq!(
        (counters.bytes_skipped, counters.bytes_damaged),
        (30_024, 30_017)
    );
}

#[test]
fn a_discarded_half_packet_is_damage_to_its_end() {
    let (mut deframer, mut found) = (Deframer::default(), 0);
    deframer.push(&[&header(100, 100), &ack()[..]].concat(), 0, &mut |_, _| {
        found += 1
    });
    deframer.discard();
    assert_eq!(
        (
            deframer.pending_bytes(),
            deframer.buffered_bytes() <= 65_536
        ),
        (0, true)
    );
    deframer.push(&[7; 30_017 - 15 - 11], 0, &mut |_, _| found += 1);
    deframer.push(&ack(), 0, &mut |_, _| found += 1);
    let counters = deframer.counters();
    assert_eq!((found, counters.abandoned), (1, 1));
    assert_eq!(
        (counters.bytes_skipped, counters.bytes_damaged),
        (30_017, 30_017)
    );
}
