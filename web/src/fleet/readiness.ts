import type { AlarmView, Connection, Severity, StationState, VehicleView } from "../protocol";
import { text } from "../text/catalogue";
import { alarmText, plainWords } from "../text/names";
import { formatAge, formatFraction } from "../text/quantities";
import { causeName } from "./alarmGroups";
import { severityRank, worstSeverity } from "./severity";
import { isFlyingNow, simulation, vehicleStatus } from "./vehicleStatus";

export type ReadinessLabel =
  | "Station lost"
  | "Contact lost"
  | "Landing"
  | "Flying"
  | "Not ready"
  | "Warnings"
  | "Ready";

/** One reason for the readiness label. */
export interface Reason {
  readonly severity: Severity;
  /** The vehicle concerned; null for the station. */
  readonly vehicleName: string | null;
  readonly text: string;
  /** The station's rule for it; absent for what only the page finds. */
  readonly rule?: string;
}

/** The state of station and fleet, with all reasons, worst first. */
export interface Readiness {
  readonly label: ReadinessLabel;
  /** How many vehicles the label is about, such as `4 of 5`; empty without vehicles. */
  readonly count: string;
  readonly severity: Severity | null;
  /** What a grave severity is about, where the label does not say it; null if it does. */
  readonly cause: string | null;
  readonly reasons: readonly Reason[];
}

/** The label at the top of the page, and its reasons. */
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
  const label = readinessLabel(state, connection, behindS, severity);
  const cause = causeOf(label, severity, reasons);
  return { label, count: countOf(label, state, behindS), severity, cause, reasons };
}

/** Labels that are red only because of something else. */
const SAY_NO_CAUSE: readonly ReadinessLabel[] = ["Landing", "Flying", "Not ready"];

function causeOf(
  label: ReadinessLabel,
  severity: Severity | null,
  [worst]: readonly Reason[],
): string | null {
  const isGrave = severity === "critical" || severity === "error";
  if (!isGrave || !SAY_NO_CAUSE.includes(label)) return null;
  return worst?.rule === undefined ? null : causeName(worst.rule);
}

function withoutState(connection: Connection): Readiness {
  const why = connection.kind === "lost" ? `${connection.reason}.` : text.readiness.waiting;
  const label = connection.kind === "lost" ? "Station lost" : "Not ready";
  const severity = connection.kind === "lost" ? "critical" : "info";
  return {
    label,
    count: "",
    severity,
    cause: null,
    reasons: [{ severity, vehicleName: null, text: why }],
  };
}

function countOf(label: ReadinessLabel, { vehicles }: StationState, behindS: number): string {
  if (vehicles.length === 0 || label === "Station lost") return "";
  const isCounted = COUNTED[label] ?? ((one) => isFlyingNow(one, behindS));
  const counted = vehicles.filter((one) => isCounted(one, behindS));
  return text.readiness.countOf(counted.length, vehicles.length);
}

/** What the count beside a label counts, where it is not the flying vehicles. */
const COUNTED: Partial<Record<ReadinessLabel, (one: VehicleView, behindS: number) => boolean>> = {
  "Contact lost": (one, behindS) => vehicleStatus(one, behindS).activity === "Contact lost",
  Landing: (one, behindS) => vehicleStatus(one, behindS).activity === "Landing",
  Ready: (one, behindS) => vehicleStatus(one, behindS).severity === null,
};

function readinessLabel(
  state: StationState,
  connection: Connection,
  behindS: number,
  severity: Severity | null,
): ReadinessLabel {
  const statuses = state.vehicles.map((vehicle) => vehicleStatus(vehicle, behindS));
  const isLost = statuses.some(
    ({ activity, severity }) => activity === "Contact lost" && severity === "critical",
  );
  if (connection.kind === "lost") return "Station lost";
  if (isLost) return "Contact lost";
  if (statuses.some(({ activity }) => activity === "Landing")) return "Landing";
  if (state.vehicles.some((vehicle) => isFlyingNow(vehicle, behindS))) return "Flying";
  if (state.vehicles.length === 0 || severity === "critical" || severity === "error") {
    return "Not ready";
  }
  return severity === "warning" ? "Warnings" : "Ready";
}

function streamReasons(connection: Connection, behindS: number): Reason[] {
  if (connection.kind !== "lost") return [];
  const lastData = text.readiness.lastData(connection.reason, formatAge(behindS));
  return [{ severity: "critical", vehicleName: null, text: lastData }];
}

function alarmReasons(state: StationState): Reason[] {
  return state.alarms
    .filter((alarm) => alarm.is_active)
    .map((alarm) => ({
      severity: alarm.severity,
      rule: alarm.rule,
      text: alarmText(alarm),
      vehicleName: alarm.vehicle_name === "" ? null : alarm.vehicle_name,
    }));
}

/** Conditions detected by the page itself, without those the station has raised an alarm for. */
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
    .map((found) => ({ ...found, vehicleName: vehicle.name }));
}

function isAbout(alarm: AlarmView, vehicle: VehicleView): boolean {
  if (vehicle.serial !== null) return alarm.serial === vehicle.serial;
  return alarm.serial === null && alarm.link_id === vehicle.link_id;
}

/** A condition, with the name of the station's alarm rule for it. */
interface Condition {
  readonly rule: string;
  readonly severity: Severity;
  readonly text: string;
}

function conditionsOf(vehicle: VehicleView, behindS: number): Condition[] {
  const found: Condition[] = [];
  const add = (rule: string, severity: Severity, words: string) =>
    found.push({ rule, severity, text: words });
  const { activity, severity } = vehicleStatus(vehicle, behindS);
  if (activity === "Contact lost") {
    const ageS = vehicle.telemetry_age_s;
    const { noTelemetry, noTelemetryYet } = text.readiness;
    const lost = ageS === null ? noTelemetryYet : noTelemetry(formatAge(ageS + behindS));
    add("link_lost", severity ?? "warning", lost);
    return found;
  }
  if (vehicle.serial === null) {
    add("unidentified", "warning", text.readiness.noSerial);
  }
  if (vehicle.conflict_link_ids.length > 0) {
    add("serial_conflict", "error", text.readiness.serialConflict);
  }
  if (vehicle.position.latitude_deg === null) {
    add("position", "warning", text.readiness.noPosition);
  }
  if (hasBatteryWarning(vehicle)) {
    add("battery", "warning", batteryText(vehicle));
  }
  return found;
}

/** Whether the aircraft reports a battery warning; its thresholds account for the pack and the route home. */
export function hasBatteryWarning(vehicle: Pick<VehicleView, "battery_warning">): boolean {
  const warning = vehicle.battery_warning.value;
  return warning !== null && plainWords(warning) !== "none";
}

function batteryText(vehicle: VehicleView): string {
  const left = formatFraction(vehicle.battery_fraction.value);
  return text.readiness.battery(plainWords(vehicle.battery_warning.value ?? ""), left);
}

function fleetReasons(state: StationState): Reason[] {
  if (simulation(state.vehicles) === "mixed") {
    return [{ severity: "warning", vehicleName: null, text: text.readiness.isMixed }];
  }
  const none: Reason = {
    severity: "warning",
    vehicleName: null,
    text: text.readiness.noVehicle,
  };
  return state.vehicles.length === 0 ? [none] : [];
}
