//! Bytes in, packets out: finds the packets of a damaged stream whatever the reads.
use crate::arrivals::Arrivals;
use crate::body::Body;
use crate::checksum::Hash;
use crate::field::Reader;
use crate::frame::{Claim, HEADER_BYTES, TRAILER_BYTES, claim, decode_payload, find_sync};
use crate::held::Held;
use crate::limits::Limits;
use crate::packet::{CompressedImage, Image, Packet, Payload, is_known};

/// A damaged frame above this size is searched in [`Held`], where hashing parts of it is cheap.
const SEARCHED_IN_PLACE: usize = 1024;
/// From this size on a frame's long tail keeps the buffer it came in.
const KEPT_IN_PLACE: usize = 4096;

/// What a deframer has seen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counters {
    /// Packets delivered, by PID.
    pub packets: [u64; 256],
    /// Frames of a possible size whose hash was another one.
    pub bad_hash: u64,
    /// Headers whose size disagrees with the PID or the payload's own lengths.
    pub bad_size: u64,
    /// Frames with a good hash whose payload is still no packet; the size check leaves none over.
    pub bad_payload: u64,
    /// Packets delivered whose PID the document does not have.
    pub unknown_pid: u64,
    /// Half packets given up: stalled, too old, or cut off by the end of the stream.
    pub abandoned: u64,
    /// Bytes that belong to no packet delivered.
    pub bytes_skipped: u64,
}

impl Default for Counters {
    fn default() -> Self {
        Self {
            packets: [0; 256],
            bad_hash: 0,
            bad_size: 0,
            bad_payload: 0,
            unknown_pid: 0,
            abandoned: 0,
            bytes_skipped: 0,
        }
    }
}

/// Turns the bytes of one direction of one connection into packets.
///
/// A frame that fails (size, hash, patience) is searched again from the byte after its sync, so no
/// intact packet is lost behind a false header. Packets and counters do not depend on how the bytes
/// were split. Time is an argument, in nanoseconds of any one clock.
#[derive(Debug, Default)]
pub struct Deframer {
    limits: Limits,
    counters: Counters,
    held: Held,
    /// Stream position of the first byte held, or of the next to come.
    position: u64,
    arrivals: Arrivals,
    last_byte_ns: i64,
}

impl Deframer {
    /// A deframer at the start of a stream.
    pub fn new(limits: Limits) -> Self {
        Self {
            limits,
            ..Self::default()
        }
    }

    /// What it has seen so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Bytes waiting for the rest of their packet.
    pub fn pending_bytes(&self) -> usize {
        self.held.live().len()
    }

    /// Takes in `data`, received at `now_ns`, and hands every packet it completes to `sink`, in order.
    pub fn push(&mut self, data: &[u8], now_ns: i64, sink: &mut impl FnMut(Packet)) {
        self.tick(now_ns, sink);
        if data.is_empty() {
            return;
        }
        self.last_byte_ns = now_ns;
        let end = self.position + (self.pending_bytes() + data.len()) as u64;
        self.arrivals.note(end, now_ns, self.limits.age_timeout_ns);
        let mut rest = data;
        while !rest.is_empty() {
            if self.held.is_empty() {
                rest = self.search(rest, sink);
            }
            rest = self.fill(rest, sink);
        }
        self.forget_arrivals();
    }

    /// Gives up half a packet that waited too long, and hands over what was hidden behind it.
    pub fn tick(&mut self, now_ns: i64, sink: &mut impl FnMut(Packet)) {
        if self.held.is_empty() {
            return;
        }
        if now_ns.saturating_sub(self.last_byte_ns) >= self.limits.stall_timeout_ns {
            return self.finish(sink);
        }
        while !self.held.is_empty() && self.first_byte_age_ns(now_ns) >= self.limits.age_timeout_ns
        {
            self.abandon(sink);
        }
        self.forget_arrivals();
    }

    /// Ends the stream: what is still held fails and is searched for whole packets.
    pub fn finish(&mut self, sink: &mut impl FnMut(Packet)) {
        while !self.held.is_empty() {
            self.abandon(sink);
        }
        self.forget_arrivals();
    }

    fn first_byte_age_ns(&mut self, now_ns: i64) -> i64 {
        self.arrivals
            .of(self.position)
            .map_or(0, |came_ns| now_ns.saturating_sub(came_ns))
    }

    fn forget_arrivals(&mut self) {
        if self.held.is_empty() {
            self.arrivals.clear();
        }
    }

    fn abandon(&mut self, sink: &mut impl FnMut(Packet)) {
        self.counters.abandoned += 1;
        self.skip_held(1);
        self.fill(&[], sink);
    }

    /// With nothing held: takes whole packets straight out of `data`. Half a packet at the end, or a
    /// large damaged frame, becomes held. Returns what is left of `data` after that.
    fn search<'a>(&mut self, mut data: &'a [u8], sink: &mut impl FnMut(Packet)) -> &'a [u8] {
        loop {
            data = self.skip(data, find_sync(data));
            if data.is_empty() {
                return data;
            }
            match claim(data, &self.limits) {
                Err(_) => {
                    self.counters.bad_size += 1;
                    data = self.skip(data, 1);
                }
                Ok(Claim::Wants(frame_bytes)) => return self.hold(data, frame_bytes),
                Ok(Claim::Frame { size, .. }) if size > data.len() => return self.hold(data, size),
                Ok(Claim::Frame { pid, size }) => {
                    let (frame, after) = data.split_at(size);
                    let (hashed, hash) = frame.split_at(size - TRAILER_BYTES);
                    if Hash::of(hashed).to_bytes() == hash {
                        self.deliver(
                            pid,
                            size,
                            decode_payload(pid, &hashed[HEADER_BYTES..]),
                            sink,
                        );
                        data = after;
                    } else if size > SEARCHED_IN_PLACE {
                        self.held.append(frame, size);
                        return after;
                    } else {
                        self.counters.bad_hash += 1;
                        data = self.skip(data, 1);
                    }
                }
            }
        }
    }

    fn hold<'a>(&mut self, data: &'a [u8], frame_bytes: usize) -> &'a [u8] {
        self.held.append(data, frame_bytes);
        &[]
    }

    /// While something is held: appends no more of `data` than the next decision needs, and decides.
    /// Returns what is left of `data` once nothing is held, or nothing.
    fn fill<'a>(&mut self, mut data: &'a [u8], sink: &mut impl FnMut(Packet)) -> &'a [u8] {
        loop {
            self.skip_held(find_sync(self.held.live()));
            if self.held.is_empty() {
                return data;
            }
            let live = self.held.live().len();
            let wanted = match claim(self.held.live(), &self.limits) {
                Err(_) => {
                    self.counters.bad_size += 1;
                    self.skip_held(1);
                    continue;
                }
                Ok(Claim::Wants(frame_bytes)) => frame_bytes,
                Ok(Claim::Frame { pid, size }) if size <= live => {
                    self.settle(pid, size, sink);
                    continue;
                }
                Ok(Claim::Frame { size, .. }) => size,
            };
            if data.is_empty() {
                return data;
            }
            let (part, after) = data.split_at(data.len().min(wanted - live));
            self.held.append(part, wanted);
            data = after;
        }
    }

    /// Judges the whole frame at the start of what is held.
    fn settle(&mut self, pid: u8, size: usize, sink: &mut impl FnMut(Packet)) {
        let expected = self.held.frame_hash(size).to_bytes();
        if self.held.live()[size - TRAILER_BYTES..size] != expected {
            self.counters.bad_hash += 1;
            return self.skip_held(1);
        }
        let has_long_tail = pid == Image::PID || pid == CompressedImage::PID;
        if has_long_tail
            && size >= KEPT_IN_PLACE
            && let Some((buffer, start)) = self.held.take_frame(size)
        {
            return self.deliver(pid, size, keep_in_place(pid, buffer, start, size), sink);
        }
        let payload = &self.held.live()[HEADER_BYTES..size - TRAILER_BYTES];
        let packet = decode_payload(pid, payload);
        self.held.advance(size);
        self.deliver(pid, size, packet, sink);
    }

    #[inline]
    fn deliver(
        &mut self,
        pid: u8,
        size: usize,
        packet: Result<Packet, crate::Error>,
        sink: &mut impl FnMut(Packet),
    ) {
        self.position += size as u64;
        match packet {
            Ok(packet) => {
                self.counters.packets[usize::from(pid)] += 1;
                self.counters.unknown_pid += u64::from(!is_known(pid));
                sink(packet);
            }
            Err(_) => {
                self.counters.bad_payload += 1;
                self.counters.bytes_skipped += size as u64;
            }
        }
    }

    #[inline]
    fn skip<'a>(&mut self, data: &'a [u8], count: usize) -> &'a [u8] {
        self.counters.bytes_skipped += count as u64;
        self.position += count as u64;
        &data[count..]
    }

    #[inline]
    fn skip_held(&mut self, count: usize) {
        self.counters.bytes_skipped += count as u64;
        self.position += count as u64;
        self.held.advance(count);
    }
}

/// The packet of a large frame, its pixels or file left in the buffer they came in.
fn keep_in_place(
    pid: u8,
    mut buffer: Vec<u8>,
    start: usize,
    size: usize,
) -> Result<Packet, crate::Error> {
    let payload = start + HEADER_BYTES;
    let end = start + size - TRAILER_BYTES;
    buffer.truncate(end);
    let head_bytes = if pid == Image::PID {
        Image::HEAD_BYTES
    } else {
        CompressedImage::HEAD_BYTES
    };
    let head = buffer[payload..payload + head_bytes].to_vec();
    let body = Body::within(buffer, payload + head_bytes..end);
    let mut head = Reader::new(&head);
    Ok(if pid == Image::PID {
        Image::around(&mut head, body)?.into()
    } else {
        CompressedImage::around(&mut head, body)?.into()
    })
}
