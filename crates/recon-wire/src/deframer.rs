//! Bytes in, packets out: finds the packets of a damaged stream whatever the reads.
use crate::arrivals::Arrivals;
use crate::body::Body;
use crate::checksum::Hash;
use crate::field::Reader;
use crate::frame::{Claim, HEADER_BYTES, SYNC, TRAILER_BYTES, claim, decode_payload, find_sync};
use crate::held::Held;
use crate::limits::Limits;
use crate::packet::{CompressedImage, Image, Packet, Payload, is_known};

/// A damaged frame above this size is searched in [`Held`], where hashing parts of it is cheap.
const SEARCHED_IN_PLACE: usize = 1024;
/// From this size on a frame's long tail keeps the buffer it came in.
const KEPT_IN_PLACE: usize = 4096;
/// Held bytes searched for a sync before the work of a call is checked again.
const SEARCHED_AT_ONCE: usize = 64 * 1024;
/// Work of judging one header, and of handing over one packet, in bytes searched or hashed.
const CLAIM_WORK: u64 = 64;
const PACKET_WORK: u64 = 64 * 1024;

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
    /// Those of them that lie in a frame of a possible size that was damaged or never completed.
    pub bytes_damaged: u64,
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
            bytes_damaged: 0,
        }
    }
}

/// When and where in the stream a packet came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// When its last byte arrived.
    pub at_ns: i64,
    /// Bytes of the stream before it.
    pub start: u64,
    /// Bytes of the stream up to its end.
    pub end: u64,
}

/// Turns the bytes of one direction of one connection into packets.
///
/// A frame that fails (size, hash, patience) is searched again from the byte after its sync, so no
/// intact packet is lost behind a false header. Packets and counters do not depend on how the bytes
/// were split. Time is an argument, in nanoseconds of any one clock; each packet is delivered with the
/// time its last byte arrived, however long a false header withheld it.
///
/// One call does no more than [`Limits::work_per_call`]; [`Deframer::resume`] goes on while
/// [`Deframer::is_busy`].
#[derive(Clone, Debug, Default)]
pub struct Deframer {
    limits: Limits,
    counters: Counters,
    held: Held,
    /// Stream position of the first byte held, or of the next to come.
    position: u64,
    arrivals: Arrivals,
    last_byte_ns: i64,
    /// Where the bytes of the latest push begin.
    push_start: u64,
    /// Arrival of the latest packet delivered.
    delivered_ns: Option<i64>,
    /// Half a packet that begins before this position has failed.
    give_up_before: u64,
    /// Skipped bytes before this position belong to a damaged frame.
    damaged_before: u64,
    excused_ns: i64,
    excused_at_last_byte_ns: i64,
    work: u64,
    work_allowed: u64,
    is_busy: bool,
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

    /// Memory taken by what is pending.
    pub fn buffered_bytes(&self) -> usize {
        self.held.capacity_bytes()
    }

    /// Whether the latest call ended at its limit of work, with more to do.
    pub fn is_busy(&self) -> bool {
        self.is_busy
    }

    /// Work done so far: a byte searched or hashed is 1, a claim judged 64, a packet delivered 65,536.
    pub fn work_done(&self) -> u64 {
        self.work
    }

    /// Takes in `data`, received at `now_ns`, and hands every packet it completes to `sink`, in order,
    /// with the time its last byte arrived and its end in the stream.
    pub fn push(&mut self, data: &[u8], now_ns: i64, sink: &mut impl FnMut(Packet, Arrival)) {
        self.tick(now_ns, sink);
        if data.is_empty() {
            return;
        }
        self.note_arrival(data.len(), now_ns);
        let mut rest = data;
        while !rest.is_empty() {
            if self.held.is_empty() {
                rest = self.search(rest, sink);
            }
            rest = self.fill(rest, sink);
        }
        self.end_call();
    }

    /// Gives up half a packet that waited too long, and hands over what was hidden behind it.
    pub fn tick(&mut self, now_ns: i64, sink: &mut impl FnMut(Packet, Arrival)) {
        if !self.is_busy && !self.held.is_empty() {
            self.give_up_before = self.give_up_before.max(self.overdue_before(now_ns));
        }
        self.resume(sink);
    }

    /// Ends the stream: what is still held fails and is searched for whole packets.
    pub fn finish(&mut self, sink: &mut impl FnMut(Packet, Arrival)) {
        self.give_up_before = self.end();
        self.resume(sink);
    }

    /// Goes on with the work that the latest call left.
    pub fn resume(&mut self, sink: &mut impl FnMut(Packet, Arrival)) {
        self.is_busy = false;
        self.work_allowed = self.work.saturating_add(self.limits.work_per_call);
        if !self.held.is_empty() {
            self.fill(&[], sink);
            self.end_call();
        }
    }

    /// Leaves `duration_ns` out of every wait: the connection was not read in that time.
    pub fn excuse(&mut self, duration_ns: i64) {
        self.excused_ns = self.excused_ns.saturating_add(duration_ns.max(0));
    }

    /// Drops what is pending unsearched, for the memory it takes.
    pub fn discard(&mut self) {
        let pending = self.pending_bytes();
        if pending > 0 {
            self.abandon();
            self.skip_held(pending - 1);
            self.is_busy = false;
            self.arrivals.clear();
        }
    }

    fn end(&self) -> u64 {
        self.position + self.pending_bytes() as u64
    }

    fn note_arrival(&mut self, len: usize, now_ns: i64) {
        self.last_byte_ns = now_ns;
        self.excused_at_last_byte_ns = self.excused_ns;
        self.push_start = self.end();
        let end = self.push_start + len as u64;
        self.arrivals
            .note(end, now_ns, self.excused_ns, self.limits.age_timeout_ns);
    }

    /// The stream position before which half a packet has waited too long by `now_ns`.
    fn overdue_before(&self, now_ns: i64) -> u64 {
        let excused_ns = self.excused_ns - self.excused_at_last_byte_ns;
        let still_ns = now_ns.saturating_sub(self.last_byte_ns);
        if still_ns.saturating_sub(excused_ns) >= self.limits.stall_timeout_ns {
            return self.end();
        }
        let most_ns = self.limits.age_timeout_ns;
        self.arrivals
            .older(|mark| mark.waited_ns(now_ns, self.excused_ns) >= most_ns)
    }

    fn end_call(&mut self) {
        self.held.compact();
        if self.held.is_empty() {
            self.arrivals.clear();
        }
    }

    /// Whether this call has done its work; then `data` is held for the next one.
    #[inline]
    fn is_spent(&mut self, data: &[u8]) -> bool {
        if self.work < self.work_allowed {
            return false;
        }
        self.held.append(data, data.len());
        self.is_busy = !self.held.is_empty();
        true
    }

    /// With nothing held: takes whole packets straight out of `data`. Half a packet at the end, or a
    /// large damaged frame, becomes held. Returns what is left of `data` after that.
    fn search<'a>(
        &mut self,
        mut data: &'a [u8],
        sink: &mut impl FnMut(Packet, Arrival),
    ) -> &'a [u8] {
        loop {
            let skipped = find_sync(data);
            self.work += skipped as u64;
            data = self.skip(data, skipped);
            if data.is_empty() || self.is_spent(data) {
                return &[];
            }
            self.work += CLAIM_WORK;
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
                    self.work += size as u64;
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
                        self.note_damage(size);
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
    fn fill<'a>(&mut self, mut data: &'a [u8], sink: &mut impl FnMut(Packet, Arrival)) -> &'a [u8] {
        loop {
            let is_at_sync = self.skip_to_sync();
            if self.held.is_empty() {
                return data;
            }
            if self.is_spent(data) {
                return &[];
            }
            if !is_at_sync {
                continue;
            }
            self.work += CLAIM_WORK;
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
            if !data.is_empty() {
                let (part, after) = data.split_at(data.len().min(wanted - live));
                self.held.append(part, wanted);
                data = after;
            } else if self.position < self.give_up_before {
                self.abandon();
            } else {
                return data;
            }
        }
    }

    /// Skips held bytes up to the next sync, or as many as are searched at once; returns whether a
    /// sync, or what may be its first half, now comes first.
    fn skip_to_sync(&mut self) -> bool {
        let live = self.held.live();
        let skipped = find_sync(&live[..live.len().min(SEARCHED_AT_ONCE)]);
        self.work += skipped as u64;
        self.skip_held(skipped);
        let live = self.held.live();
        live.len() == 1 || live.starts_with(&SYNC)
    }

    fn abandon(&mut self) {
        self.counters.abandoned += 1;
        if let Ok(Claim::Frame { size, .. }) = claim(self.held.live(), &self.limits) {
            self.damaged_before = self.damaged_before.max(self.position + size as u64);
        }
        self.skip_held(1);
    }

    /// Judges the whole frame at the start of what is held.
    fn settle(&mut self, pid: u8, size: usize, sink: &mut impl FnMut(Packet, Arrival)) {
        self.work += self.held.bytes_hashed_for(size) as u64;
        let expected = self.held.frame_hash(size).to_bytes();
        if self.held.live()[size - TRAILER_BYTES..size] != expected {
            self.note_damage(size);
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
        sink: &mut impl FnMut(Packet, Arrival),
    ) {
        self.work += PACKET_WORK;
        self.position += size as u64;
        match packet {
            Ok(packet) => {
                self.counters.packets[usize::from(pid)] += 1;
                self.counters.unknown_pid += u64::from(!is_known(pid));
                let arrival = Arrival {
                    at_ns: self.arrived_ns(self.position - 1),
                    start: self.position - size as u64,
                    end: self.position,
                };
                sink(packet, arrival);
            }
            Err(_) => {
                self.counters.bad_payload += 1;
                self.counters.bytes_skipped += size as u64;
            }
        }
    }

    /// When the byte at `position` came; never before that of an earlier packet, which marks could say.
    #[inline]
    fn arrived_ns(&mut self, position: u64) -> i64 {
        let came_ns = if position >= self.push_start {
            self.last_byte_ns
        } else {
            self.arrivals.of(position).unwrap_or(self.last_byte_ns)
        };
        let newest_ns = self.delivered_ns.map_or(came_ns, |last| last.max(came_ns));
        self.delivered_ns = Some(newest_ns);
        newest_ns
    }

    /// Counts a frame that failed its hash at the current position.
    fn note_damage(&mut self, size: usize) {
        self.counters.bad_hash += 1;
        self.damaged_before = self.damaged_before.max(self.position + size as u64);
    }

    #[inline]
    fn skip<'a>(&mut self, data: &'a [u8], count: usize) -> &'a [u8] {
        self.count_skipped(count as u64);
        &data[count..]
    }

    #[inline]
    fn skip_held(&mut self, count: usize) {
        self.count_skipped(count as u64);
        self.held.advance(count);
    }

    #[inline]
    fn count_skipped(&mut self, count: u64) {
        self.counters.bytes_skipped += count;
        self.counters.bytes_damaged += count.min(self.damaged_before.saturating_sub(self.position));
        self.position += count;
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
