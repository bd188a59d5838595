import type { Map as MapLibre } from "maplibre-gl";
import type { BaseMapView } from "../protocol";
import type { MapRequests } from "../source/mapRequests";
import type { Colours } from "./colours";
import type { Layer } from "./scene";

export const BASE_MAP = "base-map";
/** Web Mercator ends there. */
const FARTHEST_LATITUDE_DEG = 85;

/** A picture of the ground from a file, below the ground image; dimmed so that what is drawn stays legible. */
export class BaseMapLayer implements Layer {
  private map: MapLibre | null = null;
  private colours: Colours | null = null;
  private isShown = false;

  constructor(private readonly requests: Pick<MapRequests, "tiles">) {}

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    this.colours = colours;
  }

  update(): void {}

  /** Shows another map, or none. */
  show(base: BaseMapView | null): void {
    const { map, colours } = this;
    if (map === null || colours === null) return;
    if (this.isShown) {
      map.removeLayer(BASE_MAP);
      map.removeSource(BASE_MAP);
    }
    this.isShown = base !== null;
    if (base === null) return;
    map.addSource(BASE_MAP, {
      type: "raster",
      tiles: [this.requests.tiles(base)],
      tileSize: base.tile_px,
      minzoom: base.min_zoom,
      maxzoom: base.max_zoom,
      bounds: boundsOf(base),
    });
    const [, lowest] = map.getStyle().layers;
    map.addLayer(
      { id: BASE_MAP, type: "raster", source: BASE_MAP, paint: paintOf(colours) },
      lowest?.id,
    );
  }

  recolour(colours: Colours): void {
    this.colours = colours;
    if (!this.isShown) return;
    const { map } = this;
    const paint = paintOf(colours);
    map?.setPaintProperty(BASE_MAP, "raster-opacity", paint["raster-opacity"]);
    map?.setPaintProperty(BASE_MAP, "raster-saturation", paint["raster-saturation"]);
  }
}

/** The theme's ground shines through: white ink stays legible on a dark one, black on a light one. */
function paintOf({ baseMapOpacity, baseMapSaturation }: Colours) {
  return {
    "raster-opacity": baseMapOpacity,
    "raster-saturation": baseMapSaturation,
    "raster-fade-duration": 0,
  } as const;
}

function boundsOf(base: BaseMapView): [number, number, number, number] {
  const within = (latitude_deg: number) =>
    Math.max(-FARTHEST_LATITUDE_DEG, Math.min(FARTHEST_LATITUDE_DEG, latitude_deg));
  return [base.west_deg, within(base.south_deg), base.east_deg, within(base.north_deg)];
}
