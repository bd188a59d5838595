import { createEffect, createMemo, on } from "solid-js";
import { type Calibration, createCalibration } from "../site/calibration";
import { createSiteDraft, type SiteDraft } from "../site/siteDraft";
import { createVehicleTable, type VehicleTable } from "../site/vehicleTable";
import type { StationPart } from "./station";

/** What changes the site. */
export interface SiteEditingPart {
  readonly siteDraft: SiteDraft;
  readonly vehicleTable: VehicleTable;
  readonly calibration: Calibration;
}

export function createSiteEditingPart({ source, clock, fleet }: StationPart): SiteEditingPart {
  const altitude_m = () => fleet.site?.ground_altitude_m ?? null;
  const siteDraft = createSiteDraft(source.site, clock, altitude_m);
  const vehicleTable = createVehicleTable(source.site, clock);
  const calibration = createCalibration(source.site, clock);
  createEffect(
    on([vehicleTable.saves, calibration.saves], () => void siteDraft.refresh(), { defer: true }),
  );
  createEffect(
    on([siteDraft.saves, calibration.saves], () => void vehicleTable.refresh(), { defer: true }),
  );
  // A draft may be saved when the last vehicle has landed, and no more when one takes off.
  const inTheAir = createMemo(
    () => fleet.vehicles.filter(({ is_flying }) => is_flying.value !== false).length,
  );
  createEffect(on(inTheAir, () => siteDraft.recheck(), { defer: true }));
  return { siteDraft, vehicleTable, calibration };
}
