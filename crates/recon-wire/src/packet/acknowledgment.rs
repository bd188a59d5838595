//! Acknowledgment, ICD 3.1.4.
use super::record::record;

record! {
    /// The app's answer to a command, sent before it acts; app to station.
    packet 3 Acknowledgment {
        /// 1 when the app will carry the command out, 0 when not.
        positive: u8,
        /// PID of the command.
        source_pid: u8,
    }
}
