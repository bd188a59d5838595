import { type Map as MapLibre, Marker } from "maplibre-gl";
import type { AreaView } from "../protocol";
import { areaText, extent, labelPoint } from "./areas";

/** An area narrower than this on the screen has no room for its label; nearer to it, it has. */
const LEAST_WIDTH_PX = 40;

interface Placed {
  readonly area: AreaView;
  readonly marker: Marker;
}

/** The names of areas, with their heights: the map has no letters of its own. */
export class AreaLabels {
  private map: MapLibre | null = null;
  private placed: readonly Placed[] = [];

  constructor(private readonly className: string) {}

  add(map: MapLibre): void {
    this.map = map;
    map.on("zoom", () => this.hideThoseWithoutRoom());
  }

  show(areas: readonly AreaView[]): void {
    const { map } = this;
    if (map === null) return;
    for (const { marker } of this.placed) marker.remove();
    this.placed = areas.map((area) => {
      const { lon, lat } = labelPoint(area);
      const marker = new Marker({ element: this.element(area), anchor: "center" });
      marker.setLngLat([lon, lat]).addTo(map);
      return { area, marker };
    });
    this.hideThoseWithoutRoom();
  }

  private element(area: AreaView): HTMLElement {
    const element = document.createElement("span");
    element.className = `area-label ${this.className}`;
    element.textContent = areaText(area);
    return element;
  }

  private hideThoseWithoutRoom(): void {
    const { map } = this;
    if (map === null) return;
    for (const { area, marker } of this.placed) {
      const { west, east, north } = extent(area);
      const width_px = map.project([east, north]).x - map.project([west, north]).x;
      marker.getElement().hidden = width_px < LEAST_WIDTH_PX;
    }
  }
}
