//! The error tree as Python sees it.
//!
//! ```text
//! WireError(ValueError)   expected, came
//! |-- ShortError   the bytes end before the packet does
//! |-- SyncError    not the start of a packet
//! |-- SizeError    a size that disagrees with the PID or the payload's own lengths
//! |-- HashError    a damaged packet
//! `-- FieldError   a value that the wire cannot carry
//! ```
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use recon_wire::Error;

create_exception!(
    recon.wire,
    WireError,
    PyValueError,
    "Bytes that are no packet, or a packet that cannot become bytes."
);
create_exception!(
    recon.wire,
    ShortError,
    WireError,
    "The bytes end before the packet does."
);
create_exception!(
    recon.wire,
    SyncError,
    WireError,
    "The bytes do not start with the sync field."
);
create_exception!(
    recon.wire,
    SizeError,
    WireError,
    "The size disagrees with the PID or the payload's own lengths."
);
create_exception!(
    recon.wire,
    HashError,
    WireError,
    "The packet's hash is another one."
);
create_exception!(
    recon.wire,
    FieldError,
    WireError,
    "A value that the wire cannot carry."
);

/// The Python exception of a wire error, with `expected` and `came` as text.
pub fn raise(error: Error) -> PyErr {
    let message = error.to_string();
    let raised = match error {
        Error::Short { .. } => ShortError::new_err(message),
        Error::Sync { .. } => SyncError::new_err(message),
        Error::Size { .. } => SizeError::new_err(message),
        Error::Hash { .. } => HashError::new_err(message),
        Error::Value { .. } => FieldError::new_err(message),
    };
    Python::attach(|py| {
        let value = raised.value(py);
        let set = value
            .setattr("expected", error.expected())
            .and_then(|()| value.setattr("came", error.came()));
        set.err().unwrap_or(raised)
    })
}

pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    let base = py.get_type::<WireError>();
    base.setattr("expected", "")?;
    base.setattr("came", "")?;
    module.add("WireError", base)?;
    module.add("ShortError", py.get_type::<ShortError>())?;
    module.add("SyncError", py.get_type::<SyncError>())?;
    module.add("SizeError", py.get_type::<SizeError>())?;
    module.add("HashError", py.get_type::<HashError>())?;
    module.add("FieldError", py.get_type::<FieldError>())
}
