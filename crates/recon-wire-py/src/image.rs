//! The Image packet: its pixels are a NumPy array.
use crate::convert::FromNumber;
use crate::errors::raise;
use crate::repr;
use numpy::{IntoPyArray, PyArray3, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PySlice};
use recon_wire::Error;
use recon_wire::packet::{self, Payload};

/// One raw RGB image (PID 2, ICD 3.1.3). `pixels` is a read-only (rows, cols, 3) uint8 array.
#[pyclass(frozen, module = "recon.wire")]
pub struct Image {
    target_fps_hz: f32,
    pixels: Py<PyArray3<u8>>,
}

impl Image {
    /// The Python image around the buffer in which the pixels arrived: no copy.
    pub fn around(py: Python<'_>, image: packet::Image) -> PyResult<Self> {
        let target_fps_hz = image.target_fps_hz;
        let (rows, cols) = image.shape();
        let (buffer, shown) = image.into_pixels().into_parts();
        let whole = buffer.into_pyarray(py);
        make_read_only(whole.as_any())?;
        let slice = PySlice::new(py, shown.start as isize, shown.end as isize, 1);
        let pixels = whole
            .get_item(slice)?
            .call_method1("reshape", (rows, cols, 3))?;
        Ok(Self {
            target_fps_hz,
            pixels: pixels.cast_into::<PyArray3<u8>>()?.unbind(),
        })
    }

    /// The wire packet, its pixels copied.
    pub fn to_packet(&self, py: Python<'_>) -> PyResult<packet::Image> {
        let pixels = self.pixels.bind(py);
        let (rows, cols) = self.shape(py)?;
        let copied = pixels.to_vec()?;
        packet::Image::new(self.target_fps_hz, rows, cols, copied).map_err(raise)
    }

    fn shape(&self, py: Python<'_>) -> PyResult<(u16, u16)> {
        let shape = self.pixels.bind(py).shape();
        Ok((dimension("rows", shape[0])?, dimension("cols", shape[1])?))
    }
}

#[pymethods]
impl Image {
    #[classattr]
    const PID: u8 = packet::Image::PID;

    #[new]
    #[pyo3(signature = (*, target_fps_hz, pixels))]
    fn new(target_fps_hz: &Bound<'_, PyAny>, pixels: &Bound<'_, PyAny>) -> PyResult<Self> {
        let target_fps_hz = f32::from_number(target_fps_hz, "target_fps_hz")?;
        let given = pixels.cast::<PyArray3<u8>>().map_err(|_| misfit(pixels))?;
        let &[rows, cols, channels] = given.shape() else {
            return Err(misfit(pixels));
        };
        if channels != 3 {
            return Err(misfit(pixels));
        }
        dimension("rows", rows)?;
        dimension("cols", cols)?;
        // A copy of our own: what the caller does to the array later must not change the packet.
        let copied = given
            .call_method1("copy", ("C",))?
            .cast_into::<PyArray3<u8>>()?;
        make_read_only(copied.as_any())?;
        Ok(Self {
            target_fps_hz,
            pixels: copied.unbind(),
        })
    }

    #[getter]
    fn target_fps_hz(&self) -> f32 {
        self.target_fps_hz
    }

    #[getter]
    fn pixels<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<u8>> {
        self.pixels.bind(py).clone()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (rows, cols) = self.shape(py)?;
        let fps = repr::number(self.target_fps_hz);
        Ok(format!(
            "Image(target_fps_hz={fps}, pixels=<{rows} x {cols}>)"
        ))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> PyResult<bool> {
        let Ok(other) = other.cast::<Self>() else {
            return Ok(false);
        };
        let (py, other) = (other.py(), other.get());
        let (mine, others) = (
            self.pixels.bind(py).readonly(),
            other.pixels.bind(py).readonly(),
        );
        Ok(
            self.target_fps_hz.to_bits() == other.target_fps_hz.to_bits()
                && mine.shape() == others.shape()
                && mine.as_slice()? == others.as_slice()?,
        )
    }
}

fn make_read_only(array: &Bound<'_, PyAny>) -> PyResult<()> {
    let write = PyDict::new(array.py());
    write.set_item("write", false)?;
    array.call_method("setflags", (), Some(&write)).map(drop)
}

fn dimension(field: &'static str, came: usize) -> PyResult<u16> {
    u16::try_from(came).map_err(|_| {
        raise(Error::Value {
            field,
            expected: "0 to 65535".to_owned(),
            came: came.to_string(),
        })
    })
}

fn misfit(pixels: &Bound<'_, PyAny>) -> PyErr {
    let attribute = |name| {
        pixels
            .getattr(name)
            .map_or_else(|_| "no".to_owned(), |value| value.to_string())
    };
    raise(Error::Value {
        field: "pixels",
        expected: "an array of shape (rows, cols, 3) and type uint8".to_owned(),
        came: format!(
            "shape {} and type {}",
            attribute("shape"),
            attribute("dtype")
        ),
    })
}
