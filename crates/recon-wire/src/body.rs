//! Bytes that stay in the buffer they arrived in.
use std::ops::{Deref, Range};

/// The long tail of a packet: pixels or a JPEG file. It may own a whole received frame of which it shows
/// a part, so that a large image is not copied a second time.
#[derive(Clone, Default)]
pub struct Body {
    buffer: Vec<u8>,
    shown: Range<usize>,
}

impl Body {
    /// The bytes `shown` of `buffer`; cut to what is there.
    pub(crate) fn within(buffer: Vec<u8>, shown: Range<usize>) -> Self {
        let end = shown.end.min(buffer.len());
        Self {
            shown: shown.start.min(end)..end,
            buffer,
        }
    }

    /// The buffer and which of its bytes are shown.
    pub fn into_parts(self) -> (Vec<u8>, Range<usize>) {
        (self.buffer, self.shown)
    }
}

impl Deref for Body {
    type Target = [u8];
    fn deref(&self) -> &[u8] {
        &self.buffer[self.shown.clone()]
    }
}

impl From<Vec<u8>> for Body {
    fn from(buffer: Vec<u8>) -> Self {
        Self {
            shown: 0..buffer.len(),
            buffer,
        }
    }
}

impl From<&[u8]> for Body {
    fn from(bytes: &[u8]) -> Self {
        bytes.to_vec().into()
    }
}

impl PartialEq for Body {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl Eq for Body {}

impl std::fmt::Debug for Body {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Body({} bytes)", self.len())
    }
}
