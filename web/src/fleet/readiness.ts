import type { Severity, StationState, VehicleView } from "../protocol";
import type { Connection } from "../source/stationSource";
import { formatAge } from "../words/age";
import { plainWords } from "../words/names";
import { formatFraction } from "../words/quantity";
import { severityRank, worstSeverity } from "./severity";
import { simulation } from "./simulation";
import { vehicleCondition } from "./vehicleWord";

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
    ...state.vehicles.flatMap((vehicle) => vehicleReasons(vehicle, behindS)),
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
    .map(({ severity, text, vehicle_name }) => ({
      severity,
      text,
      vehicleName: vehicle_name === "" ? null : vehicle_name,
    }));
}

function vehicleReasons(vehicle: VehicleView, behindS: number): Reason[] {
  const found: Reason[] = [];
  const say = (severity: Severity, text: string) =>
    found.push({ severity, vehicleName: vehicle.name, text });
  const condition = vehicleCondition(vehicle, behindS);
  if (condition.word === "No contact") {
    const ageS = vehicle.telemetry_age_s;
    const since =
      ageS === null ? "No telemetry yet." : `No telemetry for ${formatAge(ageS + behindS)}.`;
    say(condition.severity ?? "warning", since);
    return found;
  }
  if (vehicle.serial === null) say("warning", "Its app has not said which aircraft it is.");
  if (vehicle.conflict_link_ids.length > 0)
    say("error", "A second link claims to be this vehicle.");
  if (vehicle.position.latitude_deg === null) say("warning", "Its position is not known.");
  if (hasBatteryWarning(vehicle)) {
    say("warning", `The aircraft warns of its battery: ${batteryText(vehicle)}.`);
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
