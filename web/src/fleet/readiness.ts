import type { AlarmView, Severity, StationState, VehicleView } from "../protocol";
import type { Connection } from "../source/stationSource";
import { alarmText, plainWords } from "../text/names";
import { formatAge, formatFraction } from "../text/quantities";
import { severityRank, worstSeverity } from "./severity";
import { simulation, vehicleCondition } from "./vehicleStatus";

export type StateWord =
  | "Communication lost"
  | "Landing"
  | "Flying"
  | "Not ready"
  | "Warnings"
  | "Ready";

/** One thing that stands behind the state word. */
export interface Reason {
  readonly severity: Severity;
  /** The vehicle it is about; null when it is about the station. */
  readonly vehicleName: string | null;
  readonly text: string;
}

/** The state of the whole, with everything that makes it so, worst first. */
export interface Readiness {
  readonly word: StateWord;
  readonly severity: Severity | null;
  readonly reasons: readonly Reason[];
}

/** The one word on top of the page, and why. */
export function readiness(
  state: StationState | null,
  connection: Connection,
  behindS: number,
): Readiness {
  if (state === null) return withoutState(connection);
  const reasons = [
    ...streamReasons(connection, behindS),
    ...alarmReasons(state),
    ...state.vehicles.flatMap((vehicle) => vehicleReasons(vehicle, state.alarms, behindS)),
    ...fleetReasons(state),
  ].sort((a, b) => severityRank(a.severity) - severityRank(b.severity));
  const severity = worstSeverity(reasons.map((reason) => reason.severity));
  return { word: stateWord(state, connection, behindS, severity), severity, reasons };
}

function withoutState(connection: Connection): Readiness {
  const text =
    connection.kind === "lost" ? connection.reason : "Waiting for the first news of the station.";
  const word = connection.kind === "lost" ? "Communication lost" : "Not ready";
  const severity = connection.kind === "lost" ? "critical" : "info";
  return { word, severity, reasons: [{ severity, vehicleName: null, text }] };
}

function stateWord(
  state: StationState,
  connection: Connection,
  behindS: number,
  severity: Severity | null,
): StateWord {
  const conditions = state.vehicles.map((vehicle) => vehicleCondition(vehicle, behindS));
  const isLost = conditions.some(
    (condition) => condition.word === "No contact" && condition.severity === "critical",
  );
  if (connection.kind === "lost" || isLost) return "Communication lost";
  if (conditions.some((condition) => condition.word === "Landing")) return "Landing";
  if (state.vehicles.some((vehicle) => vehicle.is_flying.value === true)) return "Flying";
  if (state.vehicles.length === 0 || severity === "critical" || severity === "error") {
    return "Not ready";
  }
  return severity === "warning" ? "Warnings" : "Ready";
}

function streamReasons(connection: Connection, behindS: number): Reason[] {
  if (connection.kind !== "lost") return [];
  const text = `${connection.reason} Last news ${formatAge(behindS)} ago.`;
  return [{ severity: "critical", vehicleName: null, text }];
}

function alarmReasons(state: StationState): Reason[] {
  return state.alarms
    .filter((alarm) => alarm.is_active)
    .map((alarm) => ({
      severity: alarm.severity,
      text: alarmText(alarm),
      vehicleName: alarm.vehicle_name === "" ? null : alarm.vehicle_name,
    }));
}

/** What the page sees for itself; what the station raised an alarm for is not said twice. */
function vehicleReasons(
  vehicle: VehicleView,
  alarms: readonly AlarmView[],
  behindS: number,
): Reason[] {
  const raised = alarms
    .filter((alarm) => alarm.is_active && isAbout(alarm, vehicle))
    .map((alarm) => alarm.rule);
  return conditionsOf(vehicle, behindS)
    .filter(({ rule }) => !raised.includes(rule))
    .map(({ severity, text }) => ({ severity, text, vehicleName: vehicle.name }));
}

function isAbout(alarm: AlarmView, vehicle: VehicleView): boolean {
  if (vehicle.serial !== null) return alarm.serial === vehicle.serial;
  return alarm.serial === null && alarm.link_id === vehicle.link_id;
}

/** A condition under the name of the station's rule for it. */
interface Condition {
  readonly rule: string;
  readonly severity: Severity;
  readonly text: string;
}

function conditionsOf(vehicle: VehicleView, behindS: number): Condition[] {
  const found: Condition[] = [];
  const say = (rule: string, severity: Severity, text: string) =>
    found.push({ rule, severity, text });
  const { word, severity } = vehicleCondition(vehicle, behindS);
  if (word === "No contact") {
    const ageS = vehicle.telemetry_age_s;
    const since = ageS === null ? "yet" : `for ${formatAge(ageS + behindS)}`;
    say("link_lost", severity ?? "warning", `No telemetry ${since}.`);
    return found;
  }
  if (vehicle.serial === null) {
    say("unidentified", "warning", "Its app has not said which aircraft it is.");
  }
  if (vehicle.conflict_link_ids.length > 0) {
    say("serial_conflict", "error", "A second link claims to be this vehicle.");
  }
  if (vehicle.position.latitude_deg === null) {
    say("position", "warning", "Its position is not known.");
  }
  if (hasBatteryWarning(vehicle)) {
    say("battery", "warning", `The aircraft warns of its battery: ${batteryText(vehicle)}.`);
  }
  return found;
}

/** Whether the aircraft itself warns; its own thresholds know the pack and the way home. */
export function hasBatteryWarning(vehicle: Pick<VehicleView, "battery_warning">): boolean {
  const word = vehicle.battery_warning.value;
  return word !== null && plainWords(word) !== "none";
}

function batteryText(vehicle: VehicleView): string {
  const left = formatFraction(vehicle.battery_fraction.value);
  return `${plainWords(vehicle.battery_warning.value ?? "")}, ${left} left`;
}

function fleetReasons(state: StationState): Reason[] {
  if (simulation(state.vehicles) === "mixed") {
    const text = "Real and simulated vehicles are connected together.";
    return [{ severity: "warning", vehicleName: null, text }];
  }
  const none: Reason = {
    severity: "warning",
    vehicleName: null,
    text: "No vehicle has connected. Open a companion app and point it at the station's address.",
  };
  return state.vehicles.length === 0 ? [none] : [];
}
