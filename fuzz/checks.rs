//! What must hold for any input. The fuzz targets search for inputs that break it; the tests of
//! `recon-wire` run the corpus through the same functions.
use recon_wire::checksum::Hash;
use recon_wire::frame::{Claim, SYNC, claim};
use recon_wire::{Counters, Deframer, Limits, Packet, decode, encode};

/// Small sizes, so that short inputs reach every limit.
const LIMITS: Limits = Limits {
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

/// A frame decodes to a packet that encodes to the same bytes, or to an error that can be told; both as
/// the input is, and as the payload of a well-formed frame.
pub fn packet(input: &[u8]) {
    faithful(input);
    let mut frame = vec![0xda, 0xa7];
    let payload_bytes = input.len().saturating_sub(1) as u32;
    frame.extend_from_slice(&(payload_bytes + 9).to_be_bytes());
    frame.push(input.first().copied().unwrap_or(0));
    frame.extend_from_slice(input.get(1..).unwrap_or(&[]));
    let hash = Hash::of(&frame);
    assert_eq!(hash, Hash::default().then_slowly(&frame));
    frame.extend_from_slice(&hash.to_bytes());
    faithful(&frame);
}

fn faithful(frame: &[u8]) {
    match decode(frame, &LIMITS) {
        Ok(packet) => assert_eq!(encode(&packet, &LIMITS).as_deref(), Ok(frame)),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// The first byte tells how many of the following bytes describe reads: each is a read of as many bytes
/// (0 is a tick after 0.7 s). Its top bit mends the hashes of the stream after them, which no search would
/// hit upon. The stream must give the same packets read whole, read so, read byte by byte, and read by an
/// oracle that sees it all; and with time passing no byte may be lost from the account.
pub fn deframer(input: &[u8]) {
    let Some((&first, rest)) = input.split_first() else {
        return;
    };
    let (reads, stream) = rest.split_at(rest.len().min(usize::from(first & 0x7f)));
    let mended = if first & 0x80 == 0 {
        stream.to_vec()
    } else {
        mend(stream)
    };
    let whole = run(&mended, &[], 0);
    assert_eq!(run_bounded(&mended, 1 + 8 * u64::from(first)), whole);
    assert_eq!(run(&mended, reads, 0), whole);
    assert_eq!(run(&mended, &[1; 4096], 0), whole);
    assert_eq!(oracle(&mended), whole.0);
    run(&mended, reads, 700_000_000);
}

/// The stream with good hashes in every second frame of a possible size, nested ones included.
fn mend(stream: &[u8]) -> Vec<u8> {
    let (mut mended, mut frames) = (stream.to_vec(), 0);
    for at in (0..stream.len()).rev() {
        if !mended[at..].starts_with(&SYNC) {
            continue;
        }
        let Ok(Claim::Frame { size, .. }) = claim(&mended[at..], &LIMITS) else {
            continue;
        };
        if let Some(frame) = mended[at..].get_mut(..size) {
            frames += 1;
            let (hashed, hash) = frame.split_at_mut(size - 2);
            if frames % 2 == 1 {
                hash.copy_from_slice(&Hash::of(hashed).to_bytes());
            }
        }
    }
    mended
}

/// Packets and counters of a stream that comes in these reads, the last of them taking what is left.
fn run(stream: &[u8], reads: &[u8], tick_ns: i64) -> (Vec<Packet>, Counters) {
    let mut deframer = Deframer::new(LIMITS);
    let (mut packets, mut delivered) = (Vec::new(), 0);
    let mut sink = |packet| {
        delivered += encode(&packet, &LIMITS).map_or(0, |frame| frame.len());
        packets.push(packet);
        delivered
    };
    let (mut now_ns, mut left, mut bytes_out) = (0, stream, 0);
    for &read in reads {
        let (part, rest) = left.split_at(left.len().min(read.into()));
        left = rest;
        if read == 0 {
            now_ns += tick_ns;
            deframer.tick(now_ns, &mut |packet, _| bytes_out = sink(packet));
        }
        deframer.push(part, now_ns, &mut |packet, _| bytes_out = sink(packet));
        account(stream.len() - left.len(), bytes_out, &deframer);
    }
    deframer.push(left, now_ns, &mut |packet, _| bytes_out = sink(packet));
    deframer.finish(&mut |packet, _| bytes_out = sink(packet));
    account(stream.len(), bytes_out, &deframer);
    assert_eq!(deframer.pending_bytes(), 0);
    (packets, deframer.counters().clone())
}

/// Packets and counters of a stream that comes at once, with a limit of work for each call.
fn run_bounded(stream: &[u8], work_per_call: u64) -> (Vec<Packet>, Counters) {
    let mut deframer = Deframer::new(Limits {
        work_per_call,
        ..LIMITS
    });
    let mut packets = Vec::new();
    let mut sink = |packet, _| packets.push(packet);
    deframer.push(stream, 0, &mut sink);
    while deframer.is_busy() {
        deframer.resume(&mut sink);
    }
    deframer.finish(&mut sink);
    while deframer.is_busy() {
        deframer.resume(&mut sink);
    }
    (packets, deframer.counters().clone())
}

/// Every byte is part of a packet delivered, skipped, or pending.
fn account(fed: usize, delivered: usize, deframer: &Deframer) {
    let skipped = deframer.counters().bytes_skipped as usize;
    assert_eq!(fed, delivered + skipped + deframer.pending_bytes());
}

/// The packets of a whole stream, found the slow way: at every place a decoder tries, bytes by bytes.
pub fn oracle(stream: &[u8]) -> Vec<Packet> {
    let (mut packets, mut at) = (Vec::new(), 0);
    while let Some(header) = stream.get(at..at + 6) {
        let size = u32::from_be_bytes([header[2], header[3], header[4], header[5]]) as usize;
        let frame = stream.get(at..at.saturating_add(size));
        match frame.map(|frame| decode(frame, &LIMITS)) {
            Some(Ok(packet)) => {
                packets.push(packet);
                at += size;
            }
            _ => at += 1,
        }
    }
    packets
}
