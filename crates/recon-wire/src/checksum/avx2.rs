//! The checksum's inner loop compiled for AVX2. The only file of the crate with `unsafe` in it.
#![allow(unsafe_code)]

use super::{Hash, LANES};
use std::arch::x86_64::*;

/// Hash of whole vectors, or `None` where the machine has no AVX2.
#[inline]
pub(super) fn vectors_hash(vectors: &[[u8; LANES]]) -> Option<Hash> {
    if !std::arch::is_x86_feature_detected!("avx2") {
        return None;
    }
    // SAFETY: the function below asks for nothing but AVX2, which was just found on this machine.
    Some(unsafe { with_avx2(vectors) })
}

#[target_feature(enable = "avx2")]
fn with_avx2(vectors: &[[u8; LANES]]) -> Hash {
    let mut sum = _mm256_setzero_si256();
    let mut running = _mm256_setzero_si256();
    for vector in vectors {
        // SAFETY: `vector` is 32 readable bytes; the load needs no alignment.
        let bytes = unsafe { _mm256_loadu_si256(vector.as_ptr().cast()) };
        sum = _mm256_add_epi8(sum, bytes);
        running = _mm256_add_epi8(running, sum);
    }
    let place = _mm256_setr_epi8(
        0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24,
        25, 26, 27, 28, 29, 30, 31,
    );
    // At most 2 * 255 * 31 in each 16-bit sum: no saturation.
    let placed = _mm256_madd_epi16(_mm256_maddubs_epi16(sum, place), _mm256_set1_epi16(1));
    let zero = _mm256_setzero_si256();
    let a = _mm256_sad_epu8(sum, zero);
    let t = _mm256_sad_epu8(running, zero);
    // 64-bit lanes: A in `a`, and 32 T - placed in `b`; the carry of a 32-bit half is cut off below.
    let b = _mm256_sub_epi32(_mm256_slli_epi32::<5>(t), placed);
    let b = _mm256_add_epi32(b, _mm256_srli_epi64::<32>(b));
    Hash {
        a: total(a),
        b: total(b),
    }
}

/// Sum of the lowest bytes of the four 64-bit lanes, modulo 256.
#[target_feature(enable = "avx2")]
fn total(lanes: __m256i) -> u8 {
    let half = _mm_add_epi32(
        _mm256_castsi256_si128(lanes),
        _mm256_extracti128_si256::<1>(lanes),
    );
    let both = _mm_add_epi32(half, _mm_unpackhi_epi64(half, half));
    _mm_cvtsi128_si32(both) as u8
}
