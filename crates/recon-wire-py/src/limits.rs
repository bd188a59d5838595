//! Limits and counters as Python sees them.
use crate::convert::FromNumber;
use pyo3::prelude::*;
use pyo3::types::PyDict;

macro_rules! limits_class {
    ($($field:ident: $type:ty),+) => {
        /// Largest sizes per packet, the patience for half a packet, and the work of one call.
        #[pyclass(frozen, eq, hash, module = "recon.wire")]
        #[derive(PartialEq, Eq, Hash)]
        pub struct Limits(pub recon_wire::Limits);

        #[pymethods]
        impl Limits {
            #[new]
            #[pyo3(signature = (*, $($field=None),+))]
            #[allow(clippy::too_many_arguments)]
            fn new($($field: Option<&Bound<'_, PyAny>>),+) -> PyResult<Self> {
                let mut limits = recon_wire::Limits::default();
                $(
                    if let Some(value) = $field {
                        limits.$field = <$type>::from_number(value, stringify!($field))?;
                    }
                )+
                Ok(Self(limits))
            }

            $(
                #[getter]
                fn $field(&self) -> $type {
                    self.0.$field
                }
            )+

            fn __repr__(&self) -> String {
                let fields = [$(format!("{}={}", stringify!($field), self.0.$field)),+];
                format!("Limits({})", fields.join(", "))
            }
        }
    };
}

limits_class!(
    max_serial_bytes: u32, max_message_bytes: u32, max_jpeg_bytes: u32, max_image_rows: u16,
    max_image_cols: u16, max_waypoints: u32, max_unknown_bytes: u32, stall_timeout_ns: i64,
    age_timeout_ns: i64, work_per_call: u64
);

/// What a deframer has seen, at the moment it was asked.
#[pyclass(frozen, eq, module = "recon.wire")]
#[derive(PartialEq, Eq)]
pub struct Counters(pub recon_wire::Counters);

#[pymethods]
impl Counters {
    /// Packets delivered, by PID; only PIDs that came.
    #[getter]
    fn packets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let by_pid = PyDict::new(py);
        for (pid, &count) in self
            .0
            .packets
            .iter()
            .enumerate()
            .filter(|&(_, &count)| count > 0)
        {
            by_pid.set_item(pid, count)?;
        }
        Ok(by_pid)
    }

    #[getter]
    fn bad_hash(&self) -> u64 {
        self.0.bad_hash
    }

    #[getter]
    fn bad_size(&self) -> u64 {
        self.0.bad_size
    }

    #[getter]
    fn bad_payload(&self) -> u64 {
        self.0.bad_payload
    }

    #[getter]
    fn unknown_pid(&self) -> u64 {
        self.0.unknown_pid
    }

    #[getter]
    fn abandoned(&self) -> u64 {
        self.0.abandoned
    }

    #[getter]
    fn bytes_skipped(&self) -> u64 {
        self.0.bytes_skipped
    }

    #[getter]
    fn bytes_damaged(&self) -> u64 {
        self.0.bytes_damaged
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let counters = &self.0;
        Ok(format!(
            "Counters(packets={}, bad_hash={}, bad_size={}, bad_payload={}, unknown_pid={}, abandoned={}, bytes_skipped={}, bytes_damaged={})",
            self.packets(py)?,
            counters.bad_hash,
            counters.bad_size,
            counters.bad_payload,
            counters.unknown_pid,
            counters.abandoned,
            counters.bytes_skipped,
            counters.bytes_damaged
        ))
    }
}
