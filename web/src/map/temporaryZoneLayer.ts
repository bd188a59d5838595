import type { Map as MapLibre } from "maplibre-gl";
import type { Colours } from "./colours";
import { addFeatures, areaFeature, lineFeature, type Point, setFeatures } from "./features";
import { hatchImage } from "./hatch";
import { circle } from "./localGrid";
import type { Layer, Scene, ZoneOutline } from "./scene";

const SOURCE = "temporary-zones";
const FILL = "temporary-zones-fill";
const CASING = "temporary-zones-casing";
const EDGE = "temporary-zones-edge";
const DRAFT = "zone-draft";
const DRAFT_CASING = "zone-draft-casing";
const DRAFT_EDGE = "zone-draft-edge";

/** Broad stripes: the site's own zones have thin crossed ones. */
const STRIPES = { isCrossed: false, tile_px: 16, stripe_px: 7, opacity: 0.5 } as const;

/** Temporary zones in force, broad stripes inside a heavy dashed line; and the one being drawn. */
export class TemporaryZoneLayer implements Layer {
  private map: MapLibre | null = null;
  private shown = "";
  private drafted = "";

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    addFeatures(map, SOURCE);
    addFeatures(map, DRAFT);
    map.addImage(SOURCE, hatchImage(STRIPES, colours.temporaryZone));
    map.addLayer({ id: FILL, type: "fill", source: SOURCE, paint: { "fill-pattern": SOURCE } });
    const casing = { "line-color": colours.casing, "line-width": 8, "line-opacity": 0.8 };
    map.addLayer({ id: CASING, type: "line", source: SOURCE, paint: casing });
    map.addLayer({
      id: EDGE,
      type: "line",
      source: SOURCE,
      paint: {
        "line-color": colours.temporaryZone,
        "line-width": 4.5,
        "line-dasharray": [2.5, 1],
      },
    });
    map.addLayer({ id: DRAFT_CASING, type: "line", source: DRAFT, paint: casing });
    map.addLayer({
      id: DRAFT_EDGE,
      type: "line",
      source: DRAFT,
      paint: { "line-color": colours.text, "line-width": 3, "line-dasharray": [1, 1] },
    });
  }

  update(scene: Scene): void {
    const { map } = this;
    if (map === null) return;
    const rings = scene.state.temporary_zones.map(({ ring }) => ring as Point[]);
    const shown = JSON.stringify(rings);
    if (shown !== this.shown) {
      this.shown = shown;
      setFeatures(
        map,
        SOURCE,
        rings.map((ring) => areaFeature(ring, {})),
      );
    }
    const drafted = JSON.stringify(scene.zoneDraft);
    if (drafted === this.drafted) return;
    this.drafted = drafted;
    setFeatures(map, DRAFT, scene.zoneDraft === null ? [] : [draftLine(scene.zoneDraft)]);
  }

  recolour(colours: Colours): void {
    const { map } = this;
    if (map === null) return;
    map.updateImage(SOURCE, hatchImage(STRIPES, colours.temporaryZone));
    map.setPaintProperty(EDGE, "line-color", colours.temporaryZone);
    map.setPaintProperty(DRAFT_EDGE, "line-color", colours.text);
    for (const line of [CASING, DRAFT_CASING])
      map.setPaintProperty(line, "line-color", colours.casing);
  }
}

/** The line of a zone being drawn: a circle, or the corners so far; a single point as a small ring. */
function draftLine({ points, radius_m }: ZoneOutline) {
  const [first] = points;
  if (first === undefined) return lineFeature([], {});
  if (radius_m !== null) return lineFeature(circle(first, radius_m), {});
  if (points.length === 1) return lineFeature(circle(first, 2, 12), {});
  return lineFeature(
    [...points, first].map(({ lon, lat }): Point => [lon, lat]),
    {},
  );
}
