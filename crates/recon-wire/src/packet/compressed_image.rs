//! Compressed Image, later revisions of the ICD.
use super::{Payload, at_most};
use crate::body::Body;
use crate::error::Error;
use crate::field::{Field, Reader, put};
use crate::limits::Limits;

/// One image of the video feed as a JPEG file; app to station.
#[derive(Clone, Debug)]
pub struct CompressedImage {
    /// Images per second the app aims at.
    pub target_fps_hz: f32,
    /// The bytes of the file.
    pub jpeg: Body,
}

impl PartialEq for CompressedImage {
    fn eq(&self, other: &Self) -> bool {
        self.target_fps_hz.bits() == other.target_fps_hz.bits() && self.jpeg == other.jpeg
    }
}

impl Eq for CompressedImage {}

impl std::hash::Hash for CompressedImage {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        (self.target_fps_hz.bits(), &*self.jpeg).hash(state);
    }
}

impl CompressedImage {
    /// Payload bytes before the file.
    pub(crate) const HEAD_BYTES: usize = 4;

    /// The packet around a file that stays where it is.
    pub(crate) fn around(head: &mut Reader<'_>, jpeg: Body) -> Result<Self, Error> {
        Ok(Self {
            target_fps_hz: f32::read(head, "target_fps")?,
            jpeg,
        })
    }
}

impl Payload for CompressedImage {
    const PID: u8 = 5;

    fn payload_bytes(&self) -> usize {
        Self::HEAD_BYTES + self.jpeg.len()
    }

    fn check(&self, limits: &Limits) -> Result<(), Error> {
        at_most(
            "jpeg",
            "bytes",
            limits.max_jpeg_bytes.into(),
            self.jpeg.len(),
        )
    }

    fn write(&self, out: &mut Vec<u8>) -> Result<(), Error> {
        put(out, self.target_fps_hz);
        out.extend_from_slice(&self.jpeg);
        Ok(())
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, Error> {
        let target_fps_hz = f32::read(reader, "target_fps")?;
        Ok(Self {
            target_fps_hz,
            jpeg: reader.remaining().into(),
        })
    }
}
