//! Extended Telemetry, ICD 3.1.2.
use super::record::record;
use super::{Payload, at_most};
use crate::error::Error;
use crate::field::{Reader, put_string};
use crate::limits::Limits;

record! {
    /// The fields of Extended Telemetry before the serial.
    ExtendedStatus {
        /// Satellites in use.
        gnss_satellite_count: u16,
        /// GNSS signal level; -1 means none.
        gnss_signal_level: i8,
        /// 1 at the greatest height allowed.
        max_height_reached: u8,
        /// 1 at the greatest distance allowed.
        max_distance_reached: u8,
        /// Charge left.
        battery_percent: u8,
        /// 0 fine, 1 low, 2 seriously low.
        battery_warning: u8,
        /// Wind warning level; -1 means unknown.
        wind_level: i8,
        /// 0 no camera, 1 camera with its feed off, 2 with its feed on.
        camera_state: u8,
        /// Flight mode, table 3; 255 for any other.
        flight_mode: u8,
        /// Number of the mission being flown, 0 when none.
        mission_id: u16,
    }
}

/// Slower telemetry and the identity of the vehicle, at about 2 Hz; app to station.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ExtendedTelemetry {
    /// Everything but the serial.
    pub status: ExtendedStatus,
    /// Serial of the drone: UTF-8 by rule, here as it came.
    pub serial: Vec<u8>,
}

impl Payload for ExtendedTelemetry {
    const PID: u8 = 1;

    fn payload_bytes(&self) -> usize {
        ExtendedStatus::SIZE + 4 + self.serial.len()
    }

    fn check(&self, limits: &Limits) -> Result<(), Error> {
        at_most(
            "serial",
            "bytes",
            limits.max_serial_bytes.into(),
            self.serial.len(),
        )
    }

    fn write(&self, out: &mut Vec<u8>) -> Result<(), Error> {
        out.extend_from_slice(&self.status.to_wire());
        put_string(out, &self.serial, "serial")
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, Error> {
        let status = ExtendedStatus::from_wire(reader)?;
        Ok(Self {
            status,
            serial: reader.string("serial")?.to_vec(),
        })
    }
}
