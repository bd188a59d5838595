import type { Map as MapLibre } from "maplibre-gl";
import { vehicleKey } from "../fleet/vehicleStatus";
import type { VehicleView } from "../protocol";
import { positionOf } from "./scene";

/** A shorter drag is a press whose hand shook. */
const LEAST_PX = 8;

/** A box on the screen, from the map's upper left corner. */
export interface Band {
  readonly left: number;
  readonly top: number;
  readonly right: number;
  readonly bottom: number;
}

type BandMap = Pick<MapLibre, "getCanvasContainer" | "dragPan" | "boxZoom" | "project">;

/** The keys of the vehicles whose place is in a box. */
export function keysIn(
  { left, top, right, bottom }: Band,
  vehicles: readonly VehicleView[],
  map: Pick<MapLibre, "project">,
): number[] {
  return vehicles.flatMap((vehicle) => {
    const at = positionOf(vehicle);
    if (at === null) return [];
    const { x, y } = map.project([at.lon, at.lat]);
    return x >= left && x <= right && y >= top && y <= bottom ? [vehicleKey(vehicle)] : [];
  });
}

/**
 * Selecting by a drag over the map: with Shift, or by any drag while `isTool` holds. The map stands still meanwhile.
 * Returns a function that removes it.
 */
export function createSelectionBand(
  map: BandMap,
  isTool: () => boolean,
  onBand: (band: Band) => void,
): () => void {
  // Shift and a drag is the library's zoom into a box.
  map.boxZoom.disable();
  const canvas = map.getCanvasContainer();
  const shown = document.createElement("div");
  shown.className = "selection-band";
  let from: { readonly x: number; readonly y: number; readonly pointer: number } | null = null;
  const place = (event: PointerEvent) => {
    const frame = canvas.getBoundingClientRect();
    return { x: event.clientX - frame.left, y: event.clientY - frame.top };
  };
  const bandTo = (event: PointerEvent): Band => {
    const [a, b] = [from ?? place(event), place(event)];
    return {
      left: Math.min(a.x, b.x),
      top: Math.min(a.y, b.y),
      right: Math.max(a.x, b.x),
      bottom: Math.max(a.y, b.y),
    };
  };
  const end = () => {
    if (from === null) return;
    from = null;
    shown.remove();
    map.dragPan.enable();
  };
  const onDown = (event: PointerEvent) => {
    if (from !== null) return end();
    if (event.button !== 0 || !(event.shiftKey || isTool())) return;
    // The symbols of vehicles have presses of their own.
    if (!(event.target instanceof HTMLCanvasElement)) return;
    from = { ...place(event), pointer: event.pointerId };
    map.dragPan.disable();
  };
  const onMove = (event: PointerEvent) => {
    if (from?.pointer !== event.pointerId) return;
    const { left, top, right, bottom } = bandTo(event);
    shown.style.transform = `translate(${left}px, ${top}px)`;
    shown.style.width = `${right - left}px`;
    shown.style.height = `${bottom - top}px`;
    if (!shown.isConnected) canvas.append(shown);
  };
  const onUp = (event: PointerEvent) => {
    if (from?.pointer !== event.pointerId) return;
    const band = bandTo(event);
    end();
    if (Math.max(band.right - band.left, band.bottom - band.top) >= LEAST_PX) onBand(band);
  };
  canvas.addEventListener("pointerdown", onDown);
  // A drag may end over a panel.
  window.addEventListener("pointermove", onMove);
  window.addEventListener("pointerup", onUp);
  window.addEventListener("pointercancel", end);
  return () => {
    end();
    canvas.removeEventListener("pointerdown", onDown);
    window.removeEventListener("pointermove", onMove);
    window.removeEventListener("pointerup", onUp);
    window.removeEventListener("pointercancel", end);
  };
}
