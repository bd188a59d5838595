//! Image, ICD 3.1.3.
use super::{Payload, at_most};
use crate::body::Body;
use crate::error::Error;
use crate::field::{Field, Reader, put};
use crate::limits::Limits;

/// One raw RGB image of the video feed; app to station.
#[derive(Clone, Debug)]
pub struct Image {
    /// Images per second the app aims at.
    pub target_fps_hz: f32,
    rows: u16,
    cols: u16,
    pixels: Body,
}

impl Image {
    /// Payload bytes before the pixels.
    pub(crate) const HEAD_BYTES: usize = 8;

    /// An image of `rows` x `cols` pixels: red, green, blue, row by row. Fails unless `pixels` has as many bytes.
    pub fn new(
        target_fps_hz: f32,
        rows: u16,
        cols: u16,
        pixels: impl Into<Body>,
    ) -> Result<Self, Error> {
        let pixels = pixels.into();
        let expected = bytes_of(rows, cols);
        if pixels.len() != expected {
            let (expected, came) = (
                format!("{expected} bytes"),
                format!("{} bytes", pixels.len()),
            );
            return Err(Error::Value {
                field: "pixels",
                expected,
                came,
            });
        }
        Ok(Self {
            target_fps_hz,
            rows,
            cols,
            pixels,
        })
    }

    /// Rows and columns.
    pub fn shape(&self) -> (u16, u16) {
        (self.rows, self.cols)
    }

    /// Red, green and blue of each pixel, row by row from the upper left.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The pixels, in the buffer they arrived in.
    pub fn into_pixels(self) -> Body {
        self.pixels
    }

    /// The packet around pixels that stay where they are.
    pub(crate) fn around(head: &mut Reader<'_>, pixels: Body) -> Result<Self, Error> {
        let target_fps_hz = f32::read(head, "target_fps")?;
        let (rows, cols) = (u16::read(head, "rows")?, u16::read(head, "cols")?);
        Self::new(target_fps_hz, rows, cols, pixels)
    }
}

/// Bytes of the pixels; at most 65535 * 65535 * 3, which a `usize` of 64 bits holds.
fn bytes_of(rows: u16, cols: u16) -> usize {
    (usize::from(rows) * usize::from(cols)).saturating_mul(3)
}

impl PartialEq for Image {
    fn eq(&self, other: &Self) -> bool {
        self.target_fps_hz.bits() == other.target_fps_hz.bits()
            && self.shape() == other.shape()
            && self.pixels == other.pixels
    }
}

impl Eq for Image {}

impl Payload for Image {
    const PID: u8 = 2;

    fn payload_bytes(&self) -> usize {
        Self::HEAD_BYTES + self.pixels.len()
    }

    fn check(&self, limits: &Limits) -> Result<(), Error> {
        at_most(
            "rows",
            "rows",
            limits.max_image_rows.into(),
            self.rows.into(),
        )?;
        at_most(
            "cols",
            "columns",
            limits.max_image_cols.into(),
            self.cols.into(),
        )
    }

    fn write(&self, out: &mut Vec<u8>) -> Result<(), Error> {
        put(out, self.target_fps_hz);
        put(out, self.rows);
        put(out, self.cols);
        out.extend_from_slice(&self.pixels);
        Ok(())
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, Error> {
        let mut head = Reader::new(reader.bytes(Self::HEAD_BYTES, "Image")?);
        Self::around(&mut head, reader.remaining().into())
    }
}
