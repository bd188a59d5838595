//! The errors of the wire. Each states what was expected and what was found.
//!
//! ```text
//! Error
//! |-- Short    bytes end before the field does
//! |-- Sync     a frame that does not start with the sync field
//! |-- Size     a size field that disagrees with the PID or with the payload's own lengths
//! |-- Hash     the two hash bytes are not those of the frame
//! `-- Value    a value that the wire cannot carry (encoding only)
//! ```
use std::fmt;

/// Why bytes are not a packet, or a packet cannot become bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Error {
    /// The bytes end before `field` does.
    Short {
        /// What was being read.
        field: &'static str,
        /// Bytes it takes.
        expected: usize,
        /// Bytes that were left.
        came: usize,
    },
    /// The first two bytes are not the sync field.
    Sync {
        /// The two bytes as a big-endian number.
        came: u16,
    },
    /// The size field is impossible for this PID and payload.
    Size {
        /// The packet's PID.
        pid: u8,
        /// What the size had to satisfy.
        expected: SizeRule,
        /// The size field, or the number of bytes given.
        came: u64,
    },
    /// The hash of the frame is another one.
    Hash {
        /// Hash computed over sync through payload: hashA, hashB.
        expected: [u8; 2],
        /// Hash found in the frame.
        came: [u8; 2],
    },
    /// A value that does not fit on the wire.
    Value {
        /// The field.
        field: &'static str,
        /// What it may be.
        expected: String,
        /// What it was.
        came: String,
    },
}

/// What a size field has to satisfy (bytes of the whole packet).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SizeRule {
    /// Exactly this many bytes.
    Exactly(u64),
    /// From the first to the second number of bytes, both included.
    Between(u64, u64),
    /// 11 bytes and 40 more for each of 1 to this many waypoints.
    Waypoints(u64),
    /// At most this many rows and columns; the sizes that came.
    Image {
        /// Most rows and columns allowed.
        most: (u16, u16),
        /// Rows and columns that came.
        came: (u16, u16),
    },
    /// At most this many bytes of text; the count that came.
    Text {
        /// Most bytes allowed.
        most: u64,
        /// Bytes claimed.
        came: u64,
    },
}

impl fmt::Display for SizeRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exactly(size) => write!(f, "{size} bytes"),
            Self::Between(least, most) => write!(f, "{least} to {most} bytes"),
            Self::Waypoints(most) => write!(f, "11 + 40 N bytes with N from 1 to {most}"),
            Self::Image { most, came } => write!(
                f,
                "an image of at most {} rows x {} columns (it claims {} x {})",
                most.0, most.1, came.0, came.1
            ),
            Self::Text { most, came } => {
                write!(f, "at most {most} bytes of text (it claims {came})")
            }
        }
    }
}

impl Error {
    /// What was expected, in words.
    pub fn expected(&self) -> String {
        match self {
            Self::Short { expected, .. } => format!("{expected} bytes"),
            Self::Sync { .. } => "0xDAA7".to_owned(),
            Self::Size { expected, .. } => expected.to_string(),
            Self::Hash { expected, .. } => format!("{:02x} {:02x}", expected[0], expected[1]),
            Self::Value { expected, .. } => expected.clone(),
        }
    }

    /// What came instead, in words.
    pub fn came(&self) -> String {
        match self {
            Self::Short { came, .. } => format!("{came} bytes"),
            Self::Sync { came } => format!("0x{came:04X}"),
            Self::Size { came, .. } => format!("{came} bytes"),
            Self::Hash { came, .. } => format!("{:02x} {:02x}", came[0], came[1]),
            Self::Value { came, .. } => came.clone(),
        }
    }

    /// Short name of the kind, as `vectors/bad/*.json` spell it.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Short { .. } => "short",
            Self::Sync { .. } => "sync",
            Self::Size { .. } => "size",
            Self::Hash { .. } => "hash",
            Self::Value { .. } => "value",
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (expected, came) = (self.expected(), self.came());
        match self {
            Self::Short { field, .. } => write!(
                f,
                "the bytes end inside {field}: expected {expected}, came {came}; wait for the rest or discard them"
            ),
            Self::Sync { .. } => write!(
                f,
                "not the start of a packet: expected sync {expected}, came {came}; search for the next sync"
            ),
            Self::Size { pid, .. } => write!(
                f,
                "wrong size for PID {pid}: expected {expected}, came {came}; search for the next sync"
            ),
            Self::Hash { .. } => write!(
                f,
                "damaged packet: expected hash {expected}, came {came}; discard it"
            ),
            Self::Value { field, .. } => {
                write!(
                    f,
                    "{field} does not fit on the wire: expected {expected}, came {came}"
                )
            }
        }
    }
}

impl std::error::Error for Error {}
