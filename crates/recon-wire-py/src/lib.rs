//! The Python skin of `recon-wire`.
use pyo3::prelude::*;

/// The compiled half of `recon.wire`.
#[pymodule]
fn _native(_module: &Bound<'_, PyModule>) -> PyResult<()> {
    Ok(())
}
