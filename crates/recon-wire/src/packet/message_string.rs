//! Message String, later revisions of the ICD.
use super::{Payload, at_most};
use crate::error::Error;
use crate::field::{Field, Reader, put_string};
use crate::limits::Limits;

/// A line of text for the operator or the log; app to station.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct MessageString {
    /// 0 debug, 1 info, 2 warning, 3 error.
    pub kind: u8,
    /// UTF-8 by rule, here as it came.
    pub text: Vec<u8>,
}

impl Payload for MessageString {
    const PID: u8 = 4;

    fn payload_bytes(&self) -> usize {
        5 + self.text.len()
    }

    fn check(&self, limits: &Limits) -> Result<(), Error> {
        at_most(
            "text",
            "bytes",
            limits.max_message_bytes.into(),
            self.text.len(),
        )
    }

    fn write(&self, out: &mut Vec<u8>) -> Result<(), Error> {
        out.push(self.kind);
        put_string(out, &self.text, "text")
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, Error> {
        let kind = u8::read(reader, "type")?;
        Ok(Self {
            kind,
            text: reader.string("text")?.to_vec(),
        })
    }
}
