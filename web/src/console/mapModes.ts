import { type Accessor, createEffect, createMemo, createSignal, on } from "solid-js";
import { activeSurveys } from "../fleet/activity";
import { selectedVehicles } from "../fleet/selection";
import { type BaseMaps, createBaseMaps, type Kept } from "../map/baseMaps";
import type { LonLat } from "../map/localGrid";
import { createOverlay, type Overlay } from "../map/overlays";
import { createFlyHere, type FlyHere } from "../orders/flyHere";
import { createMissionDraft, type MissionDraft } from "../orders/missionDraft";
import { createZoneDraft, type ZoneDraft } from "../orders/zoneDraft";
import type { OrderPart } from "./orders";
import type { SiteEditingPart } from "./siteEditing";
import type { StationPart } from "./station";

/** What the map shows, and what a press on it means. */
export interface MapPart {
  readonly flyHere: FlyHere;
  readonly missionDraft: MissionDraft;
  readonly zoneDraft: ZoneDraft;
  readonly overlay: Overlay;
  readonly baseMaps: BaseMaps;
  readonly fitRequests: Accessor<number>;
  /** Zooms the map to show everything. */
  fit(): void;
  /** A press on the map: a place for the zone or mission being drawn, or the fly-here target. */
  aim(at: LonLat): void;
  /** The same at the map centre, for operators using the keyboard. */
  aimAtCentre(): void;
  /** The middle of the map's free part, and how wide that is; null before there is a map. */
  mapCentre(): MapCentre | null;
  /** Registers a function that returns the map centre. */
  setMapCentre(centre: () => MapCentre): void;
}

/** A place on the map, with the width around it that is in view, metres. */
export interface MapCentre extends LonLat {
  readonly width_m: number;
}

/** `kept` is what this browser keeps: the chosen base map. */
export function createMapPart(
  { source, clock, fleet }: StationPart,
  { selection, orderApi }: OrderPart,
  { siteDraft, calibration }: SiteEditingPart,
  kept: Kept,
): MapPart {
  const single = createMemo(() => {
    const [only, ...others] = selectedVehicles(fleet.vehicles, selection);
    return only === undefined || only.serial === null || others.length > 0 ? null : only;
  });
  const flyHere = createFlyHere(single, source.orders, orderApi, clock);
  const missionDraft = createMissionDraft(single, source.orders, orderApi, clock);
  const zoneDraft = createZoneDraft();
  leaveOthers([
    { isOn: flyHere.isOn, leave: () => flyHere.isOn() && flyHere.toggle() },
    missionDraft,
    zoneDraft,
    siteDraft,
    calibration,
  ]);
  const [fitRequests, setFitRequests] = createSignal(0);
  const aim = (at: LonLat) => {
    if (calibration.isOn()) calibration.aim(at);
    else if (!siteDraft.isOn())
      ([zoneDraft, missionDraft].find(({ isOn }) => isOn()) ?? flyHere).aim(at);
  };
  let centre: (() => MapCentre) | null = null;
  return {
    flyHere,
    missionDraft,
    zoneDraft,
    overlay: createOverlay(() => activeSurveys(fleet.surveys).length > 0),
    baseMaps: createBaseMaps(source, kept),
    fitRequests,
    fit: () => setFitRequests((count) => count + 1),
    aim,
    aimAtCentre: () => {
      if (centre !== null) aim(centre());
    },
    mapCentre: () => centre?.() ?? null,
    setMapCentre: (of) => {
      centre = of;
    },
  };
}

interface Mode {
  isOn(): boolean;
  leave(): unknown;
}

/** A press on the map means one thing at a time. */
function leaveOthers(modes: readonly Mode[]): void {
  for (const mode of modes) {
    createEffect(
      on(mode.isOn, (isOn) => {
        if (isOn) for (const other of modes) if (other !== mode) other.leave();
      }),
    );
  }
}
