//! Python numbers into wire numbers, refused with a sentence when they do not fit.
use crate::errors::raise;
use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;
use recon_wire::Error;

/// A wire number taken from a Python one.
pub trait FromNumber: Sized {
    /// The value for `field`; FieldError when out of range, TypeError when it is no number.
    fn from_number(value: &Bound<'_, PyAny>, field: &'static str) -> PyResult<Self>;
}

fn misfit(field: &'static str, expected: String, value: &Bound<'_, PyAny>) -> PyErr {
    let came = value.to_string();
    raise(Error::Value {
        field,
        expected,
        came,
    })
}

macro_rules! integer {
    ($($type:ty),+) => {$(
        impl FromNumber for $type {
            fn from_number(value: &Bound<'_, PyAny>, field: &'static str) -> PyResult<Self> {
                value.extract::<$type>().map_err(|error| {
                    if error.is_instance_of::<PyOverflowError>(value.py()) {
                        misfit(field, format!("{} to {}", <$type>::MIN, <$type>::MAX), value)
                    } else {
                        error
                    }
                })
            }
        }
    )+};
}

integer!(u8, i8, u16, u32, i64, u64);

impl FromNumber for f64 {
    fn from_number(value: &Bound<'_, PyAny>, _field: &'static str) -> PyResult<Self> {
        value.extract()
    }
}

impl FromNumber for f32 {
    fn from_number(value: &Bound<'_, PyAny>, field: &'static str) -> PyResult<Self> {
        let wide: f64 = value.extract()?;
        let narrow = wide as f32;
        if wide.is_finite() && narrow.is_infinite() {
            return Err(misfit(
                field,
                format!("at most {:e} in size", f32::MAX),
                value,
            ));
        }
        Ok(narrow)
    }
}
