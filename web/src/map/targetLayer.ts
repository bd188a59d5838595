import type { Map as MapLibre } from "maplibre-gl";
import { vehicleKey } from "../fleet/vehicleStatus";
import type { VehicleView } from "../protocol";
import { text } from "../text/catalogue";
import { vehicleLabel } from "../text/names";
import { formatHeight } from "../text/units";
import { colourOf } from "../theme/theme";
import type { Layer, Scene } from "./scene";
import { type Target, TargetMarkers } from "./targetMarkers";

/** Targets: a ring at that of each vehicle under virtual stick control, and a dashed one at fly-here's while planned. */
export class TargetLayer implements Layer {
  private map: MapLibre | null = null;
  private readonly steered = new TargetMarkers();
  private readonly planned = new TargetMarkers("target-planned");

  add(map: MapLibre): void {
    this.map = map;
  }

  update({ state, plannedTarget }: Scene): void {
    if (this.map === null) return;
    this.steered.show(this.map, state.vehicles.flatMap(targetOf));
    const planned = plannedTarget === null ? [] : [plannedTarget];
    this.planned.show(
      this.map,
      planned.map((target) => ({ key: 0, colour: "var(--text)", ...target })),
    );
  }

  recolour(): void {}
}

/** The target of a vehicle under virtual stick control, as none or one. */
export function targetOf(vehicle: VehicleView): Target[] {
  const { steering } = vehicle;
  if (steering === null) return [];
  const height = formatHeight(steering.height_above_takeoff_m);
  const action = steering.has_arrived ? text.map.holdingHere : text.map.flyingHere;
  return [
    {
      key: vehicleKey(vehicle),
      at: { lon: steering.longitude_deg, lat: steering.latitude_deg },
      colour: colourOf(vehicleKey(vehicle)),
      text: action(vehicleLabel(vehicle), height),
    },
  ];
}
