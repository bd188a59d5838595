//! Execute Waypoint Mission, ICD 3.2.3.
use super::record::record;
use super::{Payload, at_most};
use crate::error::Error;
use crate::field::{Field, Reader};
use crate::limits::Limits;

record! {
    /// One waypoint of a mission.
    Waypoint {
        /// WGS84 latitude.
        latitude_deg: f64,
        /// WGS84 longitude.
        longitude_deg: f64,
        /// WGS84 altitude, or height above takeoff: which one the app means is a setting of the vehicle.
        altitude_m: f64,
        /// Radius of the arc that cuts this corner; ignored unless the mission is curved.
        corner_radius_m: f32,
        /// Speed from here to the next waypoint.
        speed_mps: f32,
        /// Time to stay here; NaN for no such action.
        loiter_time_s: f32,
        /// Pitch the gimbal turns to here; NaN for no such action.
        gimbal_pitch_deg: f32,
    }
}

/// Fly these waypoints, in place of what is being flown; station to app.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ExecuteWaypointMission {
    /// 0 hover after the last waypoint, 1 land there.
    pub land_at_end: u8,
    /// 0 stop at each waypoint, 1 cut the corners.
    pub curved_flight: u8,
    /// One or more.
    pub waypoints: Vec<Waypoint>,
}

impl Payload for ExecuteWaypointMission {
    const PID: u8 = 253;

    fn payload_bytes(&self) -> usize {
        2 + Waypoint::SIZE * self.waypoints.len()
    }

    fn check(&self, limits: &Limits) -> Result<(), Error> {
        if self.waypoints.is_empty() {
            let (expected, came) = ("at least 1 waypoint".to_owned(), "0".to_owned());
            return Err(Error::Value {
                field: "waypoints",
                expected,
                came,
            });
        }
        at_most(
            "waypoints",
            "waypoints",
            limits.max_waypoints.into(),
            self.waypoints.len(),
        )
    }

    fn write(&self, out: &mut Vec<u8>) -> Result<(), Error> {
        out.extend_from_slice(&[self.land_at_end, self.curved_flight]);
        for waypoint in &self.waypoints {
            out.extend_from_slice(&waypoint.to_wire());
        }
        Ok(())
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, Error> {
        let land_at_end = u8::read(reader, "land_at_end")?;
        let curved_flight = u8::read(reader, "curved_flight")?;
        let mut waypoints = Vec::with_capacity(reader.left() / Waypoint::SIZE);
        while !reader.is_empty() {
            waypoints.push(Waypoint::from_wire(reader)?);
        }
        Ok(Self {
            land_at_end,
            curved_flight,
            waypoints,
        })
    }
}
