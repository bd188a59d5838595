//! The bytes of half a packet, with the means to hash any part of them cheaply.
use crate::checksum::Hash;
use crate::frame::TRAILER_BYTES;

/// Distance between two remembered prefix hashes.
const STEP: usize = 256;
/// Up to here a frame is hashed from its bytes, above from the remembered prefixes.
const HASHED_DIRECTLY: usize = 4 * STEP;
/// An emptied buffer larger than this is given back.
const KEPT_CAPACITY: usize = 256 * 1024;

/// Bytes held until the packet they begin is whole.
///
/// Every 256 bytes the hash of all before is remembered, computed while the bytes are in cache anyway.
/// So an image is hashed on its way in, and testing one frame after another inside it costs no
/// more than a few hundred bytes each: a stream full of false headers is searched in linear time.
#[derive(Debug, Default)]
pub(crate) struct Held {
    bytes: Vec<u8>,
    start: usize,
    /// `prefixes[i]` is the hash of the first `256 i` bytes (and of what compaction dropped before).
    prefixes: Vec<Hash>,
}

impl Held {
    /// The bytes not yet taken.
    #[inline]
    pub fn live(&self) -> &[u8] {
        &self.bytes[self.start..]
    }

    #[inline]
    pub fn is_empty(&self) -> bool {
        self.start == self.bytes.len()
    }

    /// Appends `data`, as part of a frame that takes `frame_bytes` in all from the first live byte.
    pub fn append(&mut self, data: &[u8], frame_bytes: usize) {
        self.compact();
        self.reserve(frame_bytes);
        self.bytes.extend_from_slice(data);
        self.remember_prefixes();
    }

    /// Drops the first `count` live bytes.
    pub fn advance(&mut self, count: usize) {
        self.start += count.min(self.bytes.len() - self.start);
        if self.is_empty() {
            self.clear();
        }
    }

    /// Hash over the frame of `size` bytes at the start, without its last two.
    pub fn frame_hash(&self, size: usize) -> Hash {
        let hashed = size - TRAILER_BYTES;
        if size <= HASHED_DIRECTLY {
            return Hash::of(&self.live()[..hashed]);
        }
        let (before, through) = (self.prefix(self.start), self.prefix(self.start + hashed));
        Hash::of_range(before, through, hashed)
    }

    /// Hands the buffer over when it ends with the frame of `size` bytes at the start; else `None`.
    ///
    /// Returns the buffer and where in it the frame starts.
    pub fn take_frame(&mut self, size: usize) -> Option<(Vec<u8>, usize)> {
        if self.start + size != self.bytes.len() {
            return None;
        }
        let taken = (std::mem::take(&mut self.bytes), self.start);
        self.clear();
        Some(taken)
    }

    fn clear(&mut self) {
        self.start = 0;
        self.prefixes.clear();
        self.bytes.clear();
        if self.bytes.capacity() > KEPT_CAPACITY {
            self.bytes = Vec::new();
        }
    }

    /// Moves the live bytes to the front once as many were taken: each byte taken pays for one moved.
    fn compact(&mut self) {
        let steps = self.start / STEP;
        if steps == 0 || self.start < self.bytes.len() - self.start {
            return;
        }
        self.bytes.drain(..steps * STEP);
        self.prefixes.drain(..steps);
        self.start -= steps * STEP;
    }

    /// Makes room at once for a frame whose size was found good. A first frame gets exactly its size;
    /// later ones, found behind failed ones, double the buffer so that growing stays linear.
    fn reserve(&mut self, frame_bytes: usize) {
        let more = (self.start + frame_bytes).saturating_sub(self.bytes.len());
        if self.bytes.len() < STEP {
            self.bytes.reserve_exact(more);
        } else {
            self.bytes.reserve(more);
        }
    }

    fn remember_prefixes(&mut self) {
        if self.prefixes.is_empty() {
            self.prefixes.push(Hash::default());
        }
        let known = self.prefixes.len() - 1;
        let mut hash = self.prefixes[known];
        for block in self.bytes[known * STEP..].chunks_exact(STEP) {
            hash = hash.then(block);
            self.prefixes.push(hash);
        }
    }

    /// Hash of the first `end` bytes.
    fn prefix(&self, end: usize) -> Hash {
        let step = end / STEP;
        self.prefixes[step].then(&self.bytes[step * STEP..end])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn noise(len: usize) -> Vec<u8> {
        (0..len).map(|i| (i * 7 + i / 251 * 13) as u8).collect()
    }

    proptest! {
        #[test]
        fn a_frame_hashes_as_its_bytes_do_wherever_it_lies(
            reads in prop::collection::vec((0usize..3000, 0usize..3000), 1..12), size in 2usize..9000,
        ) {
            let source = noise(40_000);
            let (mut held, mut end, mut start) = (Held::default(), 0, 0);
            for (more, fewer) in reads {
                held.append(&source[end..end + more], more);
                end += more;
                start += fewer.min(held.live().len());
                held.advance(fewer);
                prop_assert_eq!(held.live(), &source[start..end]);
                if size <= held.live().len() {
                    prop_assert_eq!(held.frame_hash(size), Hash::of(&source[start..start + size - 2]));
                }
            }
        }
    }

    /// A hostile stream keeps a large frame half full while frame after frame fails.
    #[test]
    fn the_buffer_stays_within_four_times_the_largest_frame() {
        const FRAME: usize = 100_000;
        let (source, mut held) = (noise(13), Held::default());
        held.append(&noise(FRAME), FRAME);
        for _ in 0..100_000 {
            held.advance(13);
            held.append(&source, FRAME);
            assert!(
                held.bytes.capacity() <= 4 * FRAME,
                "{}",
                held.bytes.capacity()
            );
        }
        assert_eq!(held.live().len(), FRAME);
    }

    #[test]
    fn an_emptied_large_buffer_is_given_back() {
        let mut held = Held::default();
        held.append(&noise(1000), 10_000_000);
        held.advance(1000);
        assert_eq!((held.bytes.capacity(), held.prefixes.len()), (0, 0));
    }

    #[test]
    fn only_a_frame_at_the_end_takes_the_buffer_along() {
        let mut held = Held::default();
        held.append(&noise(600), 600);
        held.advance(100);
        assert_eq!(held.take_frame(400), None);
        assert_eq!(held.take_frame(500), Some((noise(600), 100)));
        assert!(held.is_empty());
    }
}
