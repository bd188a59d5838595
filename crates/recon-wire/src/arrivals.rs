//! When the bytes held arrived.
use std::collections::VecDeque;

/// Marks per patience: an age is known to this fraction of the longest wait.
const RESOLUTION: i64 = 64;

/// Arrival times along a stream: every mark tells until which position bytes had come at what time.
///
/// Bytes that come shortly after a mark are counted to it, so that a byte at a time needs no more memory
/// than a megabyte at a time.
#[derive(Debug, Default)]
pub(crate) struct Arrivals {
    marks: VecDeque<(u64, i64)>,
}

impl Arrivals {
    /// Bytes up to stream position `end` have come by `now_ns`.
    pub fn note(&mut self, end: u64, now_ns: i64, patience_ns: i64) {
        match self.marks.back_mut() {
            Some((last, at_ns)) if now_ns.saturating_sub(*at_ns) <= patience_ns / RESOLUTION => {
                *last = end
            }
            _ => self.marks.push_back((end, now_ns)),
        }
    }

    /// When the byte at `position` came; forgets everything before it.
    pub fn of(&mut self, position: u64) -> Option<i64> {
        while self.marks.front().is_some_and(|&(end, _)| end <= position) {
            self.marks.pop_front();
        }
        self.marks.front().map(|&(_, at_ns)| at_ns)
    }

    pub fn clear(&mut self) {
        self.marks.clear();
    }
}
