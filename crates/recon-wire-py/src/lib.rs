//! The Python skin of `recon-wire`.
mod convert;
mod deframer;
mod errors;
mod image;
mod limits;
#[cfg(target_os = "linux")]
mod mapped_memory;
mod packets;
mod records;
mod repr;
mod union;

use pyo3::prelude::*;
use std::borrow::Cow;

#[cfg(target_os = "linux")]
#[global_allocator]
static MEMORY: mapped_memory::MappedMemory = mapped_memory::MappedMemory;

/// hashA and hashB over `data` (ICD 3.3.1).
#[pyfunction]
#[pyo3(signature = (data, /))]
fn checksum(data: Cow<'_, [u8]>) -> (u8, u8) {
    let hash = recon_wire::checksum::Hash::of(&data);
    (hash.a, hash.b)
}

/// The frame of one packet. Raises WireError when `limits` or the wire cannot carry a value.
#[pyfunction]
#[pyo3(signature = (packet, /, limits=None))]
fn encode<'py>(
    packet: &Bound<'py, PyAny>,
    limits: Option<&limits::Limits>,
) -> PyResult<Bound<'py, pyo3::types::PyBytes>> {
    let limits = limits.map_or_else(Default::default, |limits| limits.0);
    let frame = recon_wire::encode(&union::from_python(packet)?, &limits).map_err(errors::raise)?;
    Ok(pyo3::types::PyBytes::new(packet.py(), &frame))
}

/// The packet of one whole frame. Raises WireError for anything else.
#[pyfunction]
#[pyo3(signature = (frame, /, limits=None))]
fn decode(
    py: Python<'_>,
    frame: Cow<'_, [u8]>,
    limits: Option<&limits::Limits>,
) -> PyResult<Py<PyAny>> {
    let limits = limits.map_or_else(Default::default, |limits| limits.0);
    union::to_python(
        py,
        recon_wire::decode(&frame, &limits).map_err(errors::raise)?,
    )
}

/// The compiled half of `recon.wire`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    union::add_packets(module)?;
    module.add_class::<limits::Limits>()?;
    module.add_class::<limits::Counters>()?;
    module.add_class::<deframer::Deframer>()?;
    module.add_function(wrap_pyfunction!(checksum, module)?)?;
    module.add_function(wrap_pyfunction!(encode, module)?)?;
    module.add_function(wrap_pyfunction!(decode, module)?)?;
    Ok(())
}
