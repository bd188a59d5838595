//! Round trips, chunking and corruption, over packets and bytes of any content.
mod common;

use common::{SMALL, deframe, frame, nasty_bytes, packet, parts};
use proptest::prelude::*;
use recon_wire::{Arrival, Deframer, Error, Limits, decode};

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..Default::default() })]

    #[test]
    fn decoding_what_was_encoded_gives_the_same_packet_and_bytes(packet in packet()) {
        let bytes = frame(&packet);
        let decoded = decode(&bytes, &SMALL).expect("a whole frame");
        prop_assert_eq!(&decoded, &packet);
        prop_assert_eq!(frame(&decoded), bytes);
    }

    #[test]
    fn decoding_never_panics_and_is_faithful(bytes in nasty_bytes(2000)) {
        if let Ok(packet) = decode(&bytes, &SMALL) {
            prop_assert_eq!(frame(&packet), bytes);
        }
    }

    #[test]
    fn a_well_hashed_frame_of_any_payload_decodes_faithfully_or_names_its_size(
        pid in any::<u8>(), payload in nasty_bytes(300),
    ) {
        let mut bytes = vec![0xda, 0xa7];
        bytes.extend_from_slice(&(payload.len() as u32 + 9).to_be_bytes());
        bytes.push(pid);
        bytes.extend_from_slice(&payload);
        bytes.extend_from_slice(&recon_wire::checksum::Hash::of(&bytes).to_bytes());
        match decode(&bytes, &SMALL) {
            Ok(packet) => prop_assert_eq!(frame(&packet), bytes),
            Err(Error::Size { came, .. }) => prop_assert_eq!(came, bytes.len() as u64),
            Err(other) => prop_assert!(matches!(other, Error::Short { .. }), "{}", other),
        }
    }

    #[test]
    fn splitting_changes_nothing(
        packets in prop::collection::vec(packet(), 0..6),
        noise in prop::collection::vec(nasty_bytes(400), 7),
        cuts in prop::collection::vec(any::<usize>(), 0..40),
    ) {
        let mut stream = noise[0].clone();
        for (packet, noise) in packets.iter().zip(&noise[1..]) {
            stream.extend(frame(packet));
            stream.extend(noise);
        }
        let whole = deframe([&stream[..]], SMALL);
        prop_assert_eq!(&deframe(parts(&stream, &cuts), SMALL), &whole);
        prop_assert_eq!(&deframe(stream.chunks(1), SMALL), &whole);
        prop_assert_eq!(&deframe(stream.chunks(7), SMALL), &whole);
    }

    #[test]
    fn packets_behind_harmless_noise_all_arrive(
        packets in prop::collection::vec(packet(), 1..6),
        noise in prop::collection::vec(prop::collection::vec(0u8..0xda, 0..300), 6),
        chunk in 1usize..5000,
    ) {
        let mut stream = Vec::new();
        for (packet, noise) in packets.iter().zip(&noise) {
            stream.extend(noise);
            stream.extend(frame(packet));
        }
        let (found, counters) = deframe(stream.chunks(chunk), SMALL);
        prop_assert_eq!(found, packets.clone());
        let skipped: usize = noise.iter().take(packets.len()).map(Vec::len).sum();
        prop_assert_eq!(counters.bytes_skipped, skipped as u64);
        prop_assert_eq!((counters.bad_hash, counters.bad_size), (0, 0));
    }

    #[test]
    fn one_flipped_bit_costs_one_packet_at_most(
        packets in prop::collection::vec(packet(), 3),
        flip in any::<prop::sample::Index>(), bit in 0u8..8, chunk in 1usize..5000,
    ) {
        let frames: Vec<_> = packets.iter().map(frame).collect();
        let mut stream = frames.concat();
        let first = frames[0].len();
        let hit = first + flip.index(frames[1].len());
        stream[hit] ^= 1 << bit;
        let (found, _) = deframe(stream.chunks(chunk), SMALL);
        prop_assert_eq!(&found[0], &packets[0]);
        prop_assert_eq!(found.last(), packets.last());
    }

    #[test]
    fn every_byte_is_delivered_skipped_or_pending(
        steps in prop::collection::vec((nasty_bytes(500), 0i64..3_000_000_000, any::<bool>()), 0..20),
    ) {
        let mut deframer = Deframer::new(SMALL);
        let (mut now_ns, mut fed, mut delivered) = (0, 0, 0);
        for (data, wait_ns, tick) in steps {
            now_ns += wait_ns;
            let mut sink = |packet, _| delivered += frame(&packet).len();
            if tick {
                deframer.tick(now_ns, &mut sink);
            }
            deframer.push(&data, now_ns, &mut sink);
            fed += data.len();
            let skipped = deframer.counters().bytes_skipped as usize;
            prop_assert_eq!(fed, delivered + skipped + deframer.pending_bytes());
        }
    }

    #[test]
    fn ticks_between_reads_change_nothing(
        steps in prop::collection::vec((nasty_bytes(300), 0i64..1_500_000_000), 0..20),
    ) {
        let (mut ticked, mut plain) = (Deframer::new(SMALL), Deframer::new(SMALL));
        let (mut with, mut without) = (Vec::new(), Vec::new());
        let mut now_ns = 0;
        for (data, wait_ns) in steps {
            now_ns += wait_ns;
            ticked.tick(now_ns, &mut |packet, _| with.push(packet));
            ticked.push(&data, now_ns, &mut |packet, _| with.push(packet));
            plain.push(&data, now_ns, &mut |packet, _| without.push(packet));
        }
        prop_assert_eq!(with, without);
        prop_assert_eq!(ticked.counters(), plain.counters());
    }

    #[test]
    fn a_limit_of_work_changes_nothing_but_the_calls(
        pieces in prop::collection::vec((packet(), nasty_bytes(400)), 0..6),
        cuts in prop::collection::vec(any::<usize>(), 0..9), work_per_call in 64u64..200_000,
    ) {
        let stream: Vec<u8> = pieces.iter().flat_map(|(p, noise)| [frame(p), noise.clone()].concat()).collect();
        let mut deframer = Deframer::new(Limits { work_per_call, ..SMALL });
        let mut found = Vec::new();
        let mut sink = |packet, _| found.push(packet);
        for part in parts(&stream, &cuts) {
            deframer.push(part, 0, &mut sink);
            while deframer.is_busy() {
                deframer.resume(&mut sink);
            }
        }
        deframer.finish(&mut sink);
        while deframer.is_busy() {
            deframer.resume(&mut sink);
        }
        let whole = deframe([&stream[..]], SMALL);
        prop_assert_eq!((found, deframer.counters().clone()), whole);
    }

    /// Behind a false header, in reads of any size, one read every 100 ms.
    #[test]
    fn each_packet_has_the_time_and_place_of_its_last_byte(
        packets in prop::collection::vec(packet(), 1..6),
        cuts in prop::collection::vec(any::<usize>(), 0..30), work_per_call in 64u64..2_000_000,
    ) {
        let frames: Vec<_> = packets.iter().map(frame).collect();
        let header = [&[0xda, 0xa7][..], &12_305u32.to_be_bytes(), &[2, 0, 0, 0, 0, 0, 64, 0, 64]].concat();
        let stream = [header.clone(), frames.concat()].concat();
        let (mut starts, mut at) = (Vec::new(), 0);
        let mut deframer = Deframer::new(Limits { work_per_call, ..SMALL });
        let mut found = Vec::new();
        let mut sink = |packet, arrival: Arrival| found.push((packet, arrival));
        for (read, part) in parts(&stream, &cuts).into_iter().enumerate() {
            starts.push(at);
            at += part.len();
            deframer.push(part, read as i64 * 100_000_000, &mut sink);
        }
        deframer.finish(&mut sink);
        while deframer.is_busy() {
            deframer.resume(&mut sink);
        }
        let mut end = header.len();
        for ((packet, bytes), (came, arrival)) in packets.iter().zip(&frames).zip(&found) {
            let start = end as u64;
            end += bytes.len();
            let read = starts.iter().rposition(|&start| start < end).expect("the first starts at 0");
            let at_ns = read as i64 * 100_000_000;
            prop_assert_eq!((came, *arrival), (packet, Arrival { at_ns, start, end: end as u64 }));
        }
        prop_assert_eq!(found.len(), packets.len());
    }
}

#[test]
fn default_limits_are_those_of_the_document() {
    let limits = Limits::default();
    assert_eq!(
        (limits.max_serial_bytes, limits.max_message_bytes),
        (256, 65_536)
    );
    assert_eq!((limits.max_image_rows, limits.max_image_cols), (2160, 3840));
    assert_eq!(
        (limits.max_jpeg_bytes, limits.max_unknown_bytes),
        (16 << 20, 65_536)
    );
    assert_eq!(limits.max_waypoints, 99);
}
