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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_byte_has_the_time_it_came() {
        let mut arrivals = Arrivals::default();
        arrivals.note(10, 0, 640);
        arrivals.note(20, 100, 640);
        arrivals.note(30, 200, 640);
        assert_eq!(
            [0, 9, 10, 19, 29, 30].map(|at| arrivals.of(at)),
            [Some(0), Some(0), Some(100), Some(100), Some(200), None]
        );
    }

    #[test]
    fn bytes_one_by_one_need_few_marks() {
        let mut arrivals = Arrivals::default();
        for now in 0..10_000 {
            arrivals.note(now as u64 + 1, now, 10_000);
        }
        assert!(arrivals.marks.len() <= RESOLUTION as usize + 1);
        let came = arrivals.of(5000).expect("noted");
        assert!((5000 - 10_000 / RESOLUTION..=5000).contains(&came));
    }
}
