//! A packet that the document does not have.
use super::{at_most, is_known};
use crate::error::Error;
use crate::limits::Limits;

/// A well-framed packet with a good hash whose PID is not in the document; nothing acts on it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct UnknownPacket {
    /// Its packet ID.
    pub pid: u8,
    /// Everything between the PID and the hash.
    pub payload: Vec<u8>,
}

impl UnknownPacket {
    pub(super) fn check(&self, limits: &Limits) -> Result<(), Error> {
        if is_known(self.pid) {
            let expected = "a PID that the document does not have".to_owned();
            return Err(Error::Value {
                field: "pid",
                expected,
                came: self.pid.to_string(),
            });
        }
        at_most(
            "payload",
            "bytes",
            limits.max_unknown_bytes.into(),
            self.payload.len(),
        )
    }
}
