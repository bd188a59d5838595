//! The deframer as Python sees it.
use crate::limits::{Counters, Limits};
use crate::union::to_python;
use pyo3::prelude::*;
use recon_wire::Packet;
use std::borrow::Cow;

/// Turns the bytes of one direction of one connection into packets.
///
/// Times are nanoseconds of any one clock that does not run backwards.
#[pyclass(module = "recon.wire")]
pub struct Deframer(recon_wire::Deframer);

/// Collects what a deframer step delivers as Python objects.
fn collect(py: Python<'_>, step: impl FnOnce(&mut dyn FnMut(Packet))) -> PyResult<Vec<Py<PyAny>>> {
    let mut delivered = Ok(Vec::new());
    step(&mut |packet| {
        if let Ok(list) = &mut delivered {
            match to_python(py, packet) {
                Ok(object) => list.push(object),
                Err(error) => delivered = Err(error),
            }
        }
    });
    delivered
}

#[pymethods]
impl Deframer {
    #[new]
    #[pyo3(signature = (limits=None))]
    fn new(limits: Option<&Limits>) -> Self {
        let limits = limits.map_or_else(Default::default, |limits| limits.0);
        Self(recon_wire::Deframer::new(limits))
    }

    /// Takes in bytes received at `now_ns`; returns the packets they complete, in order.
    #[pyo3(signature = (data, now_ns=0))]
    fn feed(
        &mut self,
        py: Python<'_>,
        data: Cow<'_, [u8]>,
        now_ns: i64,
    ) -> PyResult<Vec<Py<PyAny>>> {
        collect(py, |mut sink| self.0.push(&data, now_ns, &mut sink))
    }

    /// Gives up half a packet that waited too long; returns what was hidden behind it.
    fn tick(&mut self, py: Python<'_>, now_ns: i64) -> PyResult<Vec<Py<PyAny>>> {
        collect(py, |mut sink| self.0.tick(now_ns, &mut sink))
    }

    /// Ends the stream; returns whole packets hidden in what was still held.
    fn finish(&mut self, py: Python<'_>) -> PyResult<Vec<Py<PyAny>>> {
        collect(py, |mut sink| self.0.finish(&mut sink))
    }

    /// What it has seen so far: a snapshot.
    #[getter]
    fn counters(&self) -> Counters {
        Counters(self.0.counters().clone())
    }

    /// Bytes waiting for the rest of their packet.
    #[getter]
    fn pending_bytes(&self) -> usize {
        self.0.pending_bytes()
    }
}
