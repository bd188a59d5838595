//! The deframer as Python sees it.
use crate::limits::{Counters, Limits};
use crate::union::to_python;
use pyo3::prelude::*;
use recon_wire::{Arrival, Packet};
use std::borrow::Cow;

/// Turns the bytes of one direction of one connection into packets.
///
/// Times are nanoseconds of any one clock that does not run backwards. A call ends at the limits'
/// `work_per_call`; `resume` goes on while `is_busy`.
#[pyclass(module = "recon.wire")]
#[derive(Clone)]
pub struct Deframer {
    inner: recon_wire::Deframer,
    arrivals_ns: Vec<i64>,
    spans: Vec<(u64, u64)>,
}

impl Deframer {
    /// Collects what a step delivers as Python objects, and when each arrived.
    fn collect(
        &mut self,
        py: Python<'_>,
        step: impl FnOnce(&mut recon_wire::Deframer, &mut dyn FnMut(Packet, Arrival)),
    ) -> PyResult<Vec<Py<PyAny>>> {
        let mut delivered = Ok(Vec::new());
        let (arrivals_ns, spans) = (&mut self.arrivals_ns, &mut self.spans);
        arrivals_ns.clear();
        spans.clear();
        step(&mut self.inner, &mut |packet, arrival| {
            if let Ok(list) = &mut delivered {
                match to_python(py, packet) {
                    Ok(object) => {
                        list.push(object);
                        arrivals_ns.push(arrival.at_ns);
                        spans.push((arrival.start, arrival.end));
                    }
                    Err(error) => delivered = Err(error),
                }
            }
        });
        delivered
    }
}

#[pymethods]
impl Deframer {
    #[new]
    #[pyo3(signature = (limits=None))]
    fn new(limits: Option<&Limits>) -> Self {
        let limits = limits.map_or_else(Default::default, |limits| limits.0);
        Self {
            inner: recon_wire::Deframer::new(limits),
            arrivals_ns: Vec::new(),
            spans: Vec::new(),
        }
    }

    /// A deframer in the same state: from here on each goes on with the bytes that it is given.
    fn __copy__(&self) -> Self {
        self.clone()
    }

    /// Takes in bytes received at `now_ns`; returns the packets they complete, in order.
    #[pyo3(signature = (data, now_ns=0))]
    fn feed(
        &mut self,
        py: Python<'_>,
        data: Cow<'_, [u8]>,
        now_ns: i64,
    ) -> PyResult<Vec<Py<PyAny>>> {
        self.collect(py, |inner, mut sink| inner.push(&data, now_ns, &mut sink))
    }

    /// Gives up half a packet that waited too long; returns what was hidden behind it.
    fn tick(&mut self, py: Python<'_>, now_ns: i64) -> PyResult<Vec<Py<PyAny>>> {
        self.collect(py, |inner, mut sink| inner.tick(now_ns, &mut sink))
    }

    /// Ends the stream; returns whole packets hidden in what was still held.
    fn finish(&mut self, py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
        self.collect(py, |inner, mut sink| inner.finish(&mut sink))
    }

    /// Goes on with the work that the latest call left.
    fn resume(&mut self, py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
        self.collect(py, |inner, mut sink| inner.resume(&mut sink))
    }

    /// Drops what is pending unsearched, for the memory it takes.
    fn discard(&mut self) {
        self.inner.discard();
    }

    /// Leaves a time in which the connection was not read out of every wait.
    fn excuse(&mut self, duration_ns: i64) {
        self.inner.excuse(duration_ns);
    }

    /// When the last byte of each packet of the latest call arrived, in order.
    #[getter]
    fn arrivals_ns(&self) -> Vec<i64> {
        self.arrivals_ns.clone()
    }

    /// Bytes of the stream before each packet of the latest call, and up to its end, in order.
    #[getter]
    fn spans(&self) -> Vec<(u64, u64)> {
        self.spans.clone()
    }

    /// What it has seen so far: a snapshot.
    #[getter]
    fn counters(&self) -> Counters {
        Counters(self.inner.counters().clone())
    }

    /// Bytes waiting for the rest of their packet.
    #[getter]
    fn pending_bytes(&self) -> usize {
        self.inner.pending_bytes()
    }

    /// Memory taken by what is pending.
    #[getter]
    fn buffered_bytes(&self) -> usize {
        self.inner.buffered_bytes()
    }

    /// Whether the latest call ended at its limit of work, with more to do.
    #[getter]
    fn is_busy(&self) -> bool {
        self.inner.is_busy()
    }

    /// Work done so far, in bytes searched or hashed.
    #[getter]
    fn work_done(&self) -> u64 {
        self.inner.work_done()
    }
}
