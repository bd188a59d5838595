//! When the bytes held arrived.
use std::collections::VecDeque;

/// Marks per patience: an age is known to this fraction of the longest wait.
const RESOLUTION: i64 = 1024;

/// Until which stream position bytes had come at what time, and the time excused before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark {
    end: u64,
    at_ns: i64,
    excused_ns: i64,
}

/// Arrival times along a stream.
///
/// Bytes that come shortly after a mark are counted to it, so that a byte at a time needs no more memory
/// than a megabyte at a time. So a byte seems older than it is by a thousandth of the patience at most,
/// and never newer.
#[derive(Clone, Debug, Default)]
pub(crate) struct Arrivals {
    marks: VecDeque<Mark>,
}

impl Arrivals {
    /// Bytes up to stream position `end` have come by `now_ns`.
    pub fn note(&mut self, end: u64, now_ns: i64, excused_ns: i64, patience_ns: i64) {
        match self.marks.back_mut() {
            Some(last)
                if now_ns.saturating_sub(last.at_ns) <= patience_ns / RESOLUTION
                    && last.excused_ns == excused_ns =>
            {
                last.end = end;
            }
            _ => self.marks.push_back(Mark {
                end,
                at_ns: now_ns,
                excused_ns,
            }),
        }
    }

    /// When the byte at `position` came; forgets everything before it.
    pub fn of(&mut self, position: u64) -> Option<i64> {
        while self.marks.front().is_some_and(|mark| mark.end <= position) {
            self.marks.pop_front();
        }
        self.marks.front().map(|mark| mark.at_ns)
    }

    /// The position before which every byte came at a mark that is old.
    pub fn older(&self, is_old: impl Fn(&Mark) -> bool) -> u64 {
        let old = self.marks.iter().take_while(|mark| is_old(mark));
        old.last().map_or(0, |mark| mark.end)
    }

    pub fn clear(&mut self) {
        self.marks.clear();
    }
}

impl Mark {
    /// How long bytes of this mark have waited by `now_ns`, without the time excused since.
    pub fn waited_ns(&self, now_ns: i64, excused_ns: i64) -> i64 {
        let passed_ns = now_ns.saturating_sub(self.at_ns);
        passed_ns.saturating_sub(excused_ns.saturating_sub(self.excused_ns))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_byte_has_the_time_it_came() {
        let mut arrivals = Arrivals::default();
        arrivals.note(10, 0, 0, 640);
        arrivals.note(20, 100, 0, 640);
        arrivals.note(30, 200, 0, 640);
        assert_eq!(
            [0, 9, 10, 19, 29, 30].map(|at| arrivals.of(at)),
            [Some(0), Some(0), Some(100), Some(100), Some(200), None]
        );
    }

    #[test]
    fn bytes_one_by_one_need_few_marks() {
        let mut arrivals = Arrivals::default();
        for now in 0..10_000 {
            arrivals.note(now as u64 + 1, now, 0, 10_000);
        }
        assert!(arrivals.marks.len() <= RESOLUTION as usize + 1);
        let came = arrivals.of(5000).expect("noted");
        assert!((5000 - 10_000 / RESOLUTION..=5000).contains(&came));
    }
}
