//! The packet hash (ICD 3.3.1): for every byte `A += b; B += A`, both modulo 256, both from 0.
//!
//! Over a run of n vectors of 32 bytes, with v_k the k-th vector (from 0) and l a byte's place in it,
//! `A = sum v_k` and a byte weighs `32 (n - k) - l` in B. With the running lane sums
//! `V += v; T += V` after every vector this is `B = 32 sum(T) - sum(l V_l)`: two additions per
//! vector, all modulo 256. Two runs join by `B = B1 + len2 * A1 + B2`, so the hash of any range follows from
//! the hashes of two prefixes ([`Hash::of_range`]).

#[cfg(target_arch = "x86_64")]
mod avx2;

/// Bytes that are summed side by side.
pub(crate) const LANES: usize = 32;

/// The hash of a run of bytes: the two bytes that end a packet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hash {
    /// hashA: sum of the bytes.
    pub a: u8,
    /// hashB: sum of all the values hashA went through.
    pub b: u8,
}

impl Hash {
    /// Hash of `bytes`.
    pub fn of(bytes: &[u8]) -> Self {
        Self::default().then(bytes)
    }

    /// Hash of what was hashed so far followed by `bytes`.
    #[must_use]
    #[inline]
    pub fn then(self, bytes: &[u8]) -> Self {
        let (vectors, tail) = bytes.as_chunks::<LANES>();
        let whole = if vectors.is_empty() {
            self
        } else {
            self.joined(vectors_hash(vectors), bytes.len() - tail.len())
        };
        whole.then_slowly(tail)
    }

    /// [`Hash::then`] one byte at a time, as the document writes it: the oracle of the fast way.
    #[must_use]
    #[inline]
    pub fn then_slowly(mut self, bytes: &[u8]) -> Self {
        for &byte in bytes {
            self.a = self.a.wrapping_add(byte);
            self.b = self.b.wrapping_add(self.a);
        }
        self
    }

    /// Hash of the `len` bytes between two prefixes of one stream, given the prefixes' hashes.
    pub fn of_range(before: Self, through: Self, len: usize) -> Self {
        Self {
            a: through.a.wrapping_sub(before.a),
            b: through
                .b
                .wrapping_sub(before.b)
                .wrapping_sub((len as u8).wrapping_mul(before.a)),
        }
    }

    /// The two bytes in wire order.
    pub fn to_bytes(self) -> [u8; 2] {
        [self.a, self.b]
    }

    fn joined(self, next: Self, next_len: usize) -> Self {
        Self {
            a: self.a.wrapping_add(next.a),
            b: self
                .b
                .wrapping_add((next_len as u8).wrapping_mul(self.a))
                .wrapping_add(next.b),
        }
    }
}

/// Hash of whole vectors, by the widest instructions this machine has.
#[inline]
fn vectors_hash(vectors: &[[u8; LANES]]) -> Hash {
    #[cfg(target_arch = "x86_64")]
    if let Some(hash) = avx2::vectors_hash(vectors) {
        return hash;
    }
    portable_vectors_hash(vectors)
}

/// [`vectors_hash`] in plain Rust; also the text that the AVX2 build compiles.
#[inline(always)]
pub(crate) fn portable_vectors_hash(vectors: &[[u8; LANES]]) -> Hash {
    let mut sum = [0u8; LANES];
    let mut running = [0u8; LANES];
    for vector in vectors {
        for lane in 0..LANES {
            sum[lane] = sum[lane].wrapping_add(vector[lane]);
            running[lane] = running[lane].wrapping_add(sum[lane]);
        }
    }
    let (mut a, mut t, mut placed) = (0u32, 0u32, 0u32);
    for lane in 0..LANES {
        a += u32::from(sum[lane]);
        t += u32::from(running[lane]);
        placed += lane as u32 * u32::from(sum[lane]);
    }
    Hash {
        a: a as u8,
        b: (32 * t).wrapping_sub(placed) as u8,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_documents_examples() {
        assert_eq!(
            Hash::of(&[0xda, 0xa7, 0, 0, 0, 0x0b, 3, 1, 0xfd]).to_bytes(),
            [0x8d, 0x16]
        );
        assert_eq!(
            Hash::of(&[0xda, 0xa7, 0, 0, 0, 0x0a, 255, 0]).to_bytes(),
            [0x8a, 0x7d]
        );
        assert_eq!(Hash::of(&[]), Hash::default());
    }

    #[test]
    fn zeros_and_a_wrapping_sum_collide_as_documented() {
        assert_eq!(Hash::of(&[0, 0, 0]), Hash::of(&[1, 254, 1]));
    }

    #[test]
    fn every_short_length_of_the_highest_byte() {
        let bytes = [0xffu8; 1100];
        for len in 0..bytes.len() {
            assert_eq!(
                Hash::of(&bytes[..len]),
                Hash::default().then_slowly(&bytes[..len])
            );
        }
    }

    proptest! {
        #[test]
        fn fast_equals_slow(bytes in prop::collection::vec(any::<u8>(), 0..3000), cut in 0usize..3000) {
            let slow = Hash::default().then_slowly(&bytes);
            prop_assert_eq!(Hash::of(&bytes), slow);
            let (left, right) = bytes.split_at(cut.min(bytes.len()));
            prop_assert_eq!(Hash::of(left).then(right), slow);
            let vectors = bytes.as_chunks::<LANES>().0;
            let whole = Hash::default().then_slowly(vectors.as_flattened());
            prop_assert_eq!(portable_vectors_hash(vectors), whole);
            prop_assert_eq!(Hash::of_range(Hash::of(left), slow, right.len()), Hash::of(right));
        }
    }
}
