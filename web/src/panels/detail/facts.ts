import type { VehicleView } from "../../protocol";
import { plainWords } from "../../text/names";
import {
  formatFraction,
  formatHeading,
  formatQuantity,
  groundSpeedMps,
  UNKNOWN,
  unknownReason,
} from "../../text/quantities";
import { formatLength } from "../../text/units";

/** One line of a vehicle's telemetry. */
export interface Fact {
  readonly name: string;
  readonly text: string;
  /** Age in the station's message, seconds; null if never received or without age. */
  readonly ageS: number | null;
  /** Why the value is unknown; null if it is known. */
  readonly why: string | null;
}

/** All telemetry of a vehicle, with datum and unit. */
export function factsOf(vehicle: VehicleView): Fact[] {
  const { position, attitude, velocity_ned: velocity } = vehicle;
  return [
    aged("Height above takeoff", vehicle.height_above_takeoff_m, (m) => formatLength(m, 1)),
    aged("Altitude (WGS84, as reported)", vehicle.reported_altitude_m, (m) => formatLength(m, 1)),
    fact("Speed over ground", groundSpeed(vehicle), velocity.age_s),
    fact("Climb rate", climb(velocity.down_mps), velocity.age_s),
    fact("Heading", formatHeading(attitude.yaw_deg), attitude.age_s),
    fact("Pitch (nose up)", formatQuantity(attitude.pitch_deg, "°"), attitude.age_s),
    fact("Roll (right down)", formatQuantity(attitude.roll_deg, "°"), attitude.age_s),
    fact("Latitude", formatQuantity(position.latitude_deg, "°", 6), position.age_s),
    fact("Longitude", formatQuantity(position.longitude_deg, "°", 6), position.age_s),
    aged("Battery", vehicle.battery_fraction, formatFraction),
    aged("Battery warning", vehicle.battery_warning, plainWords),
    aged("Flight mode", vehicle.flight_mode, plainWords),
    flying(vehicle),
    ...vehicle.doubts.map((doubt) => fact("Telemetry doubted", doubt.text, doubt.age_s)),
    aged("Satellites", vehicle.gnss_satellite_count, String),
    aged("GNSS signal (0 to 10)", vehicle.gnss_signal_level, String),
    aged("Wind level", vehicle.wind_level, String),
    aged("Mission id", vehicle.mission_id, (id) => (id === 0 ? "none" : String(id))),
    aged("Camera", vehicle.camera_state, plainWords),
    waypointAltitude(vehicle),
  ];
}

/** As believed; what is reported is added where it differs. */
function flying(vehicle: VehicleView): Fact {
  const { value, age_s } = vehicle.is_flying;
  const reported = vehicle.reported_is_flying.value;
  if (value === reported || reported === null) {
    return aged("Flying", vehicle.is_flying, (isFlying) => (isFlying ? "yes" : "no"));
  }
  const believed = value === null ? "uncertain" : value ? "yes" : "no";
  const reports = reported ? "reports in flight" : "reports on the ground";
  return fact("Flying", `${believed} (${reports})`, age_s);
}

function aged<T>(
  name: string,
  value: { readonly value: T | null; readonly age_s: number | null },
  format: (value: T) => string,
): Fact {
  const text = value.value === null ? UNKNOWN : format(value.value);
  return fact(name, text, value.age_s);
}

function fact(name: string, text: string, ageS: number | null): Fact {
  return { name, text, ageS, why: text === UNKNOWN ? unknownReason(ageS) : null };
}

function groundSpeed(vehicle: VehicleView): string {
  const { north_mps, east_mps } = vehicle.velocity_ned;
  return formatQuantity(groundSpeedMps(north_mps, east_mps), "m/s");
}

function climb(down_mps: number | null): string {
  return formatQuantity(down_mps === null ? null : -down_mps, "m/s");
}

const WAYPOINT_ALTITUDES: Readonly<Record<VehicleView["waypoint_altitude"], string>> = {
  takeoff: "above takeoff",
  wgs84: "WGS84",
  unset: UNKNOWN,
};

function waypointAltitude(vehicle: VehicleView): Fact {
  const isUnset = vehicle.waypoint_altitude === "unset";
  return {
    name: "Waypoint altitude",
    text: WAYPOINT_ALTITUDES[vehicle.waypoint_altitude],
    ageS: null,
    why: isUnset ? "not set in the site file: missions are refused" : null,
  };
}
