//! How a packet prints.
use std::fmt::Debug;

/// A number as Python would write it.
pub fn number(value: impl Debug) -> String {
    format!("{value:?}").replace("NaN", "nan")
}

/// Bytes as a Python literal, harmless on a terminal.
pub fn bytes(value: &[u8]) -> String {
    format!("b\"{}\"", value.escape_ascii())
}
