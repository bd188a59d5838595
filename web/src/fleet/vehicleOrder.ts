import { type Accessor, createSignal } from "solid-js";
import type { VehicleView } from "../protocol";
import { text } from "../text/catalogue";
import { vehicleLabel } from "../text/names";
import { hasBatteryWarning } from "./readiness";
import { severityRank } from "./severity";
import { vehicleKey, vehicleStatus } from "./vehicleStatus";

/** How the list of vehicles is sorted and grouped, and which are shown. */
export type SortName = "number" | "name" | "battery" | "trouble";
export type GroupName = "none" | "activity" | "role";
export type FilterName = "all" | "flying" | "trouble" | "selected";

/** What the operator chose for the list. */
export interface ListChoice {
  readonly search: string;
  readonly sort: SortName;
  readonly group: GroupName;
  readonly filter: FilterName;
}

export const FIRST_CHOICE: ListChoice = {
  search: "",
  sort: "number",
  group: "none",
  filter: "all",
};

export interface VehicleGroup<T> {
  /** Empty without groups. */
  readonly title: string;
  readonly vehicles: readonly T[];
}

/** The vehicle that a search means: of that number, else the first found; null for an empty search. */
export function firstFound<T extends VehicleView>(
  groups: readonly VehicleGroup<T>[],
  search: string,
): T | null {
  const found = search.trim() === "" ? [] : groups.flatMap(({ vehicles }) => vehicles);
  return found.find(({ number }) => String(number) === search.trim()) ?? found[0] ?? null;
}

/** Whether contact was lost in flight: such vehicles are listed first, however the list is sorted. */
function isLost(vehicle: VehicleView, behindS: number): boolean {
  const { activity, severity } = vehicleStatus(vehicle, behindS);
  return activity === "Contact lost" && severity === "critical";
}

/** The vehicles as listed; `behindS` is the age of the newest state. */
export function listVehicles<T extends VehicleView>(
  vehicles: readonly T[],
  choice: ListChoice,
  isSelected: (key: number) => boolean,
  behindS: number,
): VehicleGroup<T>[] {
  const shown = vehicles
    .filter((one) => isFound(one, choice.search) && passes(one, choice.filter, isSelected, behindS))
    .sort(
      (a, b) =>
        Number(isLost(b, behindS)) - Number(isLost(a, behindS)) ||
        compare(a, b, choice.sort, behindS) ||
        rank(a) - rank(b),
    );
  const titles = new Map<string, T[]>();
  for (const one of shown) {
    const title = groupTitle(one, choice.group, behindS);
    titles.set(title, [...(titles.get(title) ?? []), one]);
  }
  return [...titles].map(([title, members]) => ({ title, vehicles: members }));
}

function isFound(vehicle: VehicleView, search: string): boolean {
  const words = search.trim().toLowerCase();
  const all = `${vehicleLabel(vehicle)} ${vehicle.serial ?? ""} ${vehicle.model}`.toLowerCase();
  return words === "" || String(vehicle.number) === words || all.includes(words);
}

function passes(
  vehicle: VehicleView,
  filter: FilterName,
  isSelected: (key: number) => boolean,
  behindS: number,
): boolean {
  switch (filter) {
    case "all":
      return true;
    case "flying":
      return vehicle.is_flying.value !== false;
    case "trouble":
      return trouble(vehicle, behindS) < NO_TROUBLE;
    case "selected":
      return isSelected(vehicleKey(vehicle));
  }
}

const NO_TROUBLE = 10;

/** 0 for the worst; `NO_TROUBLE` without any. */
function trouble(vehicle: VehicleView, behindS: number): number {
  const { severity } = vehicleStatus(vehicle, behindS);
  if (severity !== null) return severityRank(severity);
  return hasBatteryWarning(vehicle) ? severityRank("warning") : NO_TROUBLE;
}

function compare(a: VehicleView, b: VehicleView, sort: SortName, behindS: number): number {
  switch (sort) {
    case "number":
      return 0;
    case "name":
      return a.name.localeCompare(b.name, "en", { numeric: true });
    case "battery":
      return (a.battery_fraction.value ?? -1) - (b.battery_fraction.value ?? -1);
    case "trouble":
      return trouble(a, behindS) - trouble(b, behindS);
  }
}

/** By number; unidentified vehicles last. */
function rank(vehicle: VehicleView): number {
  const key = vehicleKey(vehicle);
  return key > 0 ? key : Number.MAX_SAFE_INTEGER / 2 - key;
}

function groupTitle(vehicle: VehicleView, group: GroupName, behindS: number): string {
  if (group === "none") return "";
  if (group === "activity") return text.activity.names[vehicleStatus(vehicle, behindS).activity];
  return vehicle.is_imager ? text.vehicles.imagers : text.vehicles.surveyors;
}

/** Whether two lists show the same vehicles in the same places. */
export function isSameList<T>(
  a: readonly VehicleGroup<T>[],
  b: readonly VehicleGroup<T>[],
): boolean {
  return (
    a.length === b.length &&
    a.every(({ title, vehicles }, index) => {
      const other = b[index];
      return (
        other !== undefined &&
        other.title === title &&
        other.vehicles.length === vehicles.length &&
        vehicles.every((vehicle, at) => vehicle === other.vehicles[at])
      );
    })
  );
}

/** The choice as a signal. */
export function createListChoice(): readonly [
  Accessor<ListChoice>,
  (next: Partial<ListChoice>) => void,
] {
  const [choice, setChoice] = createSignal(FIRST_CHOICE);
  return [choice, (next) => setChoice({ ...choice(), ...next })];
}
