import type { VehicleView } from "../../protocol";
import { text } from "../../text/catalogue";
import { plainWords } from "../../text/names";
import {
  formatFraction,
  formatHeading,
  formatQuantity,
  groundSpeedMps,
  UNKNOWN,
  unknownReason,
} from "../../text/quantities";
import { formatLength, withLengthUnit } from "../../text/units";

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
    aged(text.facts.height, vehicle.height_above_takeoff_m, (m) => formatLength(m, 1)),
    aged(text.facts.altitude, vehicle.reported_altitude_m, (m) => formatLength(m, 1)),
    fact(text.facts.groundSpeed, groundSpeed(vehicle), velocity.age_s),
    fact(text.facts.climbRate, climb(velocity.down_mps), velocity.age_s),
    fact(text.facts.heading, formatHeading(attitude.yaw_deg), attitude.age_s),
    fact(text.facts.pitch, formatQuantity(attitude.pitch_deg, "°"), attitude.age_s),
    fact(text.facts.roll, formatQuantity(attitude.roll_deg, "°"), attitude.age_s),
    fact(text.facts.latitude, formatQuantity(position.latitude_deg, "°", 6), position.age_s),
    fact(text.facts.longitude, formatQuantity(position.longitude_deg, "°", 6), position.age_s),
    aged(text.facts.battery, vehicle.battery_fraction, formatFraction),
    aged(text.facts.batteryWarning, vehicle.battery_warning, plainWords),
    aged(text.facts.flightMode, vehicle.flight_mode, plainWords),
    flying(vehicle),
    ...vehicle.doubts.map((doubt) =>
      fact(text.facts.doubted, withLengthUnit(doubt.text), doubt.age_s),
    ),
    aged(text.facts.satellites, vehicle.gnss_satellite_count, String),
    aged(text.facts.gnssSignal, vehicle.gnss_signal_level, String),
    aged(text.facts.windLevel, vehicle.wind_level, String),
    aged(text.facts.missionId, vehicle.mission_id, (id) =>
      id === 0 ? text.facts.noMission : String(id),
    ),
    aged(text.facts.camera, vehicle.camera_state, plainWords),
    waypointAltitude(vehicle),
  ];
}

/** As believed; what is reported is added where it differs. */
function flying(vehicle: VehicleView): Fact {
  const { value, age_s } = vehicle.is_flying;
  const reported = vehicle.reported_is_flying.value;
  if (value === reported || reported === null) {
    return aged(text.facts.flying, vehicle.is_flying, yesOrNo);
  }
  const believed = value === null ? text.facts.uncertain : yesOrNo(value);
  const { reportsFlight, reportsGround } = text.facts;
  return fact(text.facts.flying, (reported ? reportsFlight : reportsGround)(believed), age_s);
}

function yesOrNo(is: boolean): string {
  return is ? text.facts.yes : text.facts.no;
}

function aged<T>(
  name: string,
  value: { readonly value: T | null; readonly age_s: number | null },
  format: (value: T) => string,
): Fact {
  const known = value.value === null ? UNKNOWN : format(value.value);
  return fact(name, known, value.age_s);
}

function fact(name: string, value: string, ageS: number | null): Fact {
  return { name, text: value, ageS, why: value === UNKNOWN ? unknownReason(ageS) : null };
}

function groundSpeed(vehicle: VehicleView): string {
  const { north_mps, east_mps } = vehicle.velocity_ned;
  return formatQuantity(groundSpeedMps(north_mps, east_mps), "m/s");
}

function climb(down_mps: number | null): string {
  return formatQuantity(down_mps === null ? null : -down_mps, "m/s");
}

function waypointAltitude({ waypoint_altitude: datum }: VehicleView): Fact {
  const { waypointAltitude: name, waypointAltitudes, waypointAltitudeUnset } = text.facts;
  if (datum === "unset") return { name, text: UNKNOWN, ageS: null, why: waypointAltitudeUnset };
  return { name, text: waypointAltitudes[datum], ageS: null, why: null };
}
