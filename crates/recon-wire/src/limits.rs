//! How large a packet may be, how long half a packet may wait, and how much one call may do.

/// Largest sizes per packet, the patience for half a packet, and the work of one call.
///
/// Memory of a deframer follows the bytes that arrived, never a size that is only claimed, and stays
/// within about twice the largest packet these allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Limits {
    /// Bytes of `DroneSerial` in Extended Telemetry.
    pub max_serial_bytes: u32,
    /// Bytes of text in a Message String.
    pub max_message_bytes: u32,
    /// Bytes of the JPEG file in a Compressed Image.
    pub max_jpeg_bytes: u32,
    /// Rows of an Image.
    pub max_image_rows: u16,
    /// Columns of an Image.
    pub max_image_cols: u16,
    /// Waypoints of a mission.
    pub max_waypoints: u32,
    /// Payload bytes of a packet whose PID is not in the document.
    pub max_unknown_bytes: u32,
    /// Half a packet that gets no further byte for this long fails (ns).
    pub stall_timeout_ns: i64,
    /// Half a packet whose first byte is older than this fails (ns).
    pub age_timeout_ns: i64,
    /// Work of one call to a deframer, in bytes searched or hashed.
    pub work_per_call: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_serial_bytes: 256,
            max_message_bytes: 64 * 1024,
            max_jpeg_bytes: 16 * 1024 * 1024,
            max_image_rows: 2160,
            max_image_cols: 3840,
            max_waypoints: 99,
            max_unknown_bytes: 64 * 1024,
            stall_timeout_ns: 2_000_000_000,
            age_timeout_ns: 10_000_000_000,
            work_per_call: u64::MAX,
        }
    }
}
