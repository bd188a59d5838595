//! Wire errors as the exceptions of `recon.wire.errors`.
use pyo3::import_exception;
use pyo3::prelude::*;
use recon_wire::Error;

import_exception!(recon.wire.errors, ShortError);
import_exception!(recon.wire.errors, SyncError);
import_exception!(recon.wire.errors, SizeError);
import_exception!(recon.wire.errors, HashError);
import_exception!(recon.wire.errors, FieldError);

/// The Python exception of a wire error, with `expected` and `came` as text.
pub fn raise(error: Error) -> PyErr {
    let fields = (error.to_string(), error.expected(), error.came());
    match error {
        Error::Short { .. } => ShortError::new_err(fields),
        Error::Sync { .. } => SyncError::new_err(fields),
        Error::Size { .. } => SizeError::new_err(fields),
        Error::Hash { .. } => HashError::new_err(fields),
        Error::Value { .. } => FieldError::new_err(fields),
    }
}
