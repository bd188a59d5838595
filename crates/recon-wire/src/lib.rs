//! The binary protocol between the Recon station and its companion apps.
//!
//! Bytes come in through [`Deframer::push`] and leave as [`Packet`] values; [`encode`] and [`decode`] turn
//! one packet into one frame and back. The layer is faithful: what was well formed encodes to the
//! same bytes again, whatever its values mean. No IO, no clock, no panic on any input.

mod arrivals;
mod body;
pub mod checksum;
mod deframer;
mod error;
pub mod field;
pub mod frame;
mod held;
mod limits;
pub mod packet;

pub use body::Body;
pub use deframer::{Arrival, Counters, Deframer};
pub use error::{Error, SizeRule};
pub use frame::{decode, encode, encode_into};
pub use limits::Limits;
pub use packet::Packet;
