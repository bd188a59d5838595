import type { Map as MapLibre } from "maplibre-gl";
import type { Colours } from "./colours";
import { addFeatures, lineFeature, setFeatures } from "./features";
import type { Layer, Scene } from "./scene";
import { TargetMarkers } from "./targetMarkers";

const SOURCE = "fly-here";
const CASING = "fly-here-casing";
const WAY = "fly-here-way";

/** The unconfirmed fly-here target: a dashed ring and the line to it. */
export class FlyHereLayer implements Layer {
  private map: MapLibre | null = null;
  private drawn = "";
  private readonly targets = new TargetMarkers("target-planned");

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    addFeatures(map, SOURCE);
    map.addLayer({
      id: CASING,
      type: "line",
      source: SOURCE,
      paint: { "line-color": colours.casing, "line-width": 6, "line-opacity": 0.7 },
    });
    map.addLayer({
      id: WAY,
      type: "line",
      source: SOURCE,
      paint: { "line-color": colours.text, "line-width": 2.5, "line-dasharray": [2, 2] },
    });
  }

  update(scene: Scene): void {
    const { map } = this;
    if (map === null) return;
    const { plannedTarget } = scene;
    this.targets.show(
      map,
      plannedTarget === null ? [] : [{ key: 0, colour: "var(--text)", ...plannedTarget }],
    );
    const drawn = JSON.stringify([plannedTarget?.from, plannedTarget?.at]);
    if (drawn === this.drawn) return;
    this.drawn = drawn;
    const { from, at } = plannedTarget ?? {};
    const way =
      !from || !at
        ? []
        : [
            lineFeature(
              [
                [from.lon, from.lat],
                [at.lon, at.lat],
              ],
              {},
            ),
          ];
    setFeatures(map, SOURCE, way);
  }

  recolour(colours: Colours): void {
    this.map?.setPaintProperty(CASING, "line-color", colours.casing);
    this.map?.setPaintProperty(WAY, "line-color", colours.text);
  }
}
