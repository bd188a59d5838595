import type { Map as MapLibre } from "maplibre-gl";
import type { Colours } from "./colours";
import type { Scene } from "./scene";

/** One thing drawn on the map. `add` is called once, in the order things lie on each other. */
export interface Layer {
  add(map: MapLibre, colours: Colours): void;
  update(scene: Scene): void;
  /** The theme changed. */
  recolour(colours: Colours): void;
}
