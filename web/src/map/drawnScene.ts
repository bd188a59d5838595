import { type Accessor, createMemo } from "solid-js";
import { useMapModes, useOrders, useSiteEditing, useStation } from "../console";
import { courseText } from "../orders/course";
import type { VehicleView } from "../protocol";
import { vehicleLabel } from "../text/names";
import type { LonLat } from "./localGrid";
import type { MissionShape } from "./missionDraftLayer";
import { type DraftShapes, type PlannedTarget, positionOf, type Scene } from "./scene";

/** Step of displayed ages on the map while no new state arrives. */
const AGE_STEP_S = 0.2;

const NEARLY_DECIMALS = 4;

/** What the layers draw: the newest state, and what a person draws; null before the first state. */
export function createScene(draft: Accessor<DraftShapes | null>): Accessor<Scene | null> {
  const { source, behindS } = useStation();
  const { selection } = useOrders();
  const { zoneDraft } = useMapModes();
  // New states update the map; between them it is redrawn only as the state ages.
  const agedBehindS = createMemo(() => Math.floor(behindS() / AGE_STEP_S) * AGE_STEP_S);
  const plannedTarget = createPlannedTarget();
  const missionShape = createMissionShape();
  return () => {
    const state = source.state();
    if (state === null) return null;
    return {
      state,
      behindS: agedBehindS(),
      selected: selection.keys(),
      plannedTarget: plannedTarget(),
      missionDraft: missionShape(),
      zoneDraft: zoneDraft.isOn()
        ? { points: zoneDraft.points(), radius_m: zoneDraft.radius_m() }
        : null,
      siteDraft: draft(),
    };
  };
}

/** The shapes of the site being edited; null while it is not. */
export function createDraftShapes(): Accessor<DraftShapes | null> {
  const { isOn, features, imported, selected } = useSiteEditing().siteDraft;
  return createMemo(() => {
    if (!isOn()) return null;
    return { features: features(), imported: imported(), selectedId: selected()?.id ?? null };
  });
}

function createPlannedTarget(): Accessor<PlannedTarget | null> {
  const { flyHere } = useMapModes();
  return createMemo(() => {
    const [vehicle, at, course] = [flyHere.vehicle(), flyHere.target(), flyHere.course()];
    if (vehicle === null || at === null) return null;
    const label = course === null ? vehicleLabel(vehicle) : courseText(course);
    return { from: positionOf(vehicle), at, text: label };
  });
}

function createMissionShape(): Accessor<MissionShape | null> {
  const { missionDraft } = useMapModes();
  const from = createMemo(() => nearlyAt(missionDraft.vehicle()), null, { equals: isSame });
  return createMemo(() => {
    if (!missionDraft.isOn()) return null;
    const points = missionDraft.points().map(({ id, at, height }, index) => ({
      id,
      at,
      height_m: height.metres(),
      isSelected: missionDraft.selected() === id,
      isRefused: missionDraft.refusedPoint() === index + 1,
    }));
    return { from: from(), points };
  });
}

/** Where a vehicle is to some metres, so that a line from there is not drawn anew for each state. */
function nearlyAt(vehicle: VehicleView | null): LonLat | null {
  const at = vehicle === null ? null : positionOf(vehicle);
  const rounded = (degrees: number) => Number(degrees.toFixed(NEARLY_DECIMALS));
  return at && { lon: rounded(at.lon), lat: rounded(at.lat) };
}

function isSame(a: LonLat | null, b: LonLat | null): boolean {
  return a?.lon === b?.lon && a?.lat === b?.lat;
}
