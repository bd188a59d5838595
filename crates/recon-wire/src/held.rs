//! The bytes of half a packet, with the means to hash any part of them cheaply.
use crate::checksum::Hash;
use crate::frame::TRAILER_BYTES;

/// Distance between two remembered prefix hashes.
const STEP: usize = 256;
/// Up to here a frame is hashed from its bytes, above from the remembered prefixes.
const HASHED_DIRECTLY: usize = 4 * STEP;
/// An emptied buffer larger than this is given back.
const KEPT_CAPACITY: usize = 64 * 1024;

/// Bytes held until the packet they begin is whole.
///
/// Every 256 bytes the hash of all before is remembered, computed while the bytes are in cache anyway.
/// So an image is hashed on its way in, and testing one frame after another inside it costs no
/// more than a few hundred bytes each: a stream full of false headers is searched in linear time.
#[derive(Clone, Debug, Default)]
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
        self.reserve(data.len(), frame_bytes);
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

    /// Memory taken.
    pub fn capacity_bytes(&self) -> usize {
        self.bytes.capacity() + self.prefixes.capacity() * size_of::<Hash>()
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

    /// How many bytes [`Held::frame_hash`] reads at most.
    pub fn bytes_hashed_for(&self, size: usize) -> usize {
        if size <= HASHED_DIRECTLY {
            size
        } else {
            2 * STEP
        }
    }

    /// Hands the buffer over when little but the frame of `size` bytes at the start is in it; else `None`.
    ///
    /// Returns the buffer and where in it the frame starts. What followed the frame stays held.
    pub fn take_frame(&mut self, size: usize) -> Option<(Vec<u8>, usize)> {
        let end = self.start + size;
        if self.start > size || self.bytes.len() - end > size / 2 {
            return None;
        }
        let rest = self.bytes.split_off(end);
        let taken = (std::mem::take(&mut self.bytes), self.start);
        self.clear();
        if !rest.is_empty() {
            self.append(&rest, rest.len());
        }
        Some(taken)
    }

    fn clear(&mut self) {
        self.start = 0;
        self.prefixes.clear();
        self.bytes.clear();
        if self.capacity_bytes() > KEPT_CAPACITY {
            self.prefixes = Vec::new();
            self.bytes = Vec::new();
        }
    }

    /// Moves the live bytes to the front once as many were taken, and gives back what they do not need:
    /// each byte taken pays for one moved.
    pub fn compact(&mut self) {
        let steps = self.start / STEP;
        if steps == 0 || self.start < self.bytes.len() - self.start {
            return;
        }
        self.bytes.drain(..steps * STEP);
        self.prefixes.drain(..steps);
        self.start -= steps * STEP;
        if self.capacity_bytes() > KEPT_CAPACITY.max(4 * self.bytes.len()) {
            self.bytes.shrink_to(2 * self.bytes.len());
            self.prefixes.shrink_to(2 * self.prefixes.len());
        }
    }

    /// Makes room for `more` bytes, of a frame that takes `frame_bytes` in all. The room follows what has
    /// come, not what a header claims: it doubles up to the frame's end, so that growing stays linear.
    fn reserve(&mut self, more: usize, frame_bytes: usize) {
        let needed = self.bytes.len() + more;
        if needed > self.bytes.capacity() {
            let wanted = needed.max((2 * needed).min(self.start + frame_bytes));
            self.bytes.reserve_exact(wanted - self.bytes.len());
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
        held.append(&noise(100_000), 10_000_000);
        assert!(held.capacity_bytes() < 250_000, "{}", held.capacity_bytes());
        held.advance(100_000);
        assert_eq!(held.capacity_bytes(), 0);
    }

    #[test]
    fn a_buffer_shrinks_with_what_is_left_in_it() {
        let mut held = Held::default();
        held.append(&noise(1_000_000), 1_000_000);
        held.advance(990_000);
        held.compact();
        assert_eq!(held.live(), &noise(1_000_000)[990_000..]);
        assert!(held.capacity_bytes() < 100_000, "{}", held.capacity_bytes());
    }

    #[test]
    fn a_frame_takes_the_buffer_along_unless_much_follows() {
        let mut held = Held::default();
        held.append(&noise(600), 600);
        held.advance(100);
        assert_eq!(held.take_frame(300), None);
        assert_eq!(
            held.take_frame(400),
            Some((noise(600)[..500].to_vec(), 100))
        );
        assert_eq!(held.live(), &noise(600)[500..]);
        assert_eq!(held.frame_hash(100), Hash::of(&noise(600)[500..598]));
    }
}
