//! Emergency Command, ICD 3.2.1.
use super::record::record;

record! {
    /// Stop the mission and do this at once; station to app.
    packet 255 EmergencyCommand {
        /// 0 hover, 1 land now, 2 return home and land.
        action: u8,
    }
}
