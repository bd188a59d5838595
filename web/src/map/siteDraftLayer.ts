import type { Feature } from "geojson";
import type { ExpressionSpecification, Map as MapLibre } from "maplibre-gl";
import type { LayerName } from "../protocol";
import { closed, LAYERS, type Ring } from "../site/siteFeatures";
import type { Colours } from "./colours";
import { addFeatures, type Point, setFeatures } from "./features";
import type { DraftShapes, Layer, Scene } from "./scene";

const SOURCE = "site-draft";
const CASING = "site-draft-casing";
const EDGE = "site-draft-edge";
const IMPORT_EDGE = "site-draft-import";
/** What a press on the map selects. */
export const DRAFT_FILL = "site-draft-fill";
export const DRAFT_POINT = "site-draft-point";

/** In place of a layer: a feature of an imported file that is not taken. */
const EXCLUDED = "excluded";

const IS_IMPORT: ExpressionSpecification = ["get", "isImport"];
const IS_SELECTED: ExpressionSpecification = ["get", "isSelected"];
const WIDTH: ExpressionSpecification = ["case", IS_SELECTED, 5, 3];
/** What is taken of a file differs from what is excluded by its fill and line too. */
const IMPORT_WIDTH: ExpressionSpecification = ["case", IS_SELECTED, 4, 2];
const OPACITY: ExpressionSpecification = ["case", ["all", IS_IMPORT, IS_SELECTED], 0.35, 0.1];

/** The site being edited: dashed over the fences in force; features of an imported file are dotted, grey while they are excluded. */
export class SiteDraftLayer implements Layer {
  private map: MapLibre | null = null;
  private shown: DraftShapes | null = null;

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    const colour = colourOf(colours);
    addFeatures(map, SOURCE);
    map.addLayer({
      id: DRAFT_FILL,
      type: "fill",
      source: SOURCE,
      filter: ["==", ["geometry-type"], "Polygon"],
      paint: { "fill-color": colour, "fill-opacity": OPACITY },
    });
    map.addLayer({
      id: CASING,
      type: "line",
      source: SOURCE,
      paint: { "line-color": colours.casing, "line-width": 7, "line-opacity": 0.8 },
    });
    map.addLayer({
      id: EDGE,
      type: "line",
      source: SOURCE,
      filter: ["!", IS_IMPORT],
      paint: { "line-color": colour, "line-width": WIDTH, "line-dasharray": [3, 1.5] },
    });
    map.addLayer({
      id: IMPORT_EDGE,
      type: "line",
      source: SOURCE,
      filter: IS_IMPORT,
      paint: { "line-color": colour, "line-width": IMPORT_WIDTH, "line-dasharray": [1, 1] },
    });
    map.addLayer({
      id: DRAFT_POINT,
      type: "circle",
      source: SOURCE,
      filter: ["==", ["geometry-type"], "Point"],
      paint: {
        "circle-color": colour,
        "circle-radius": 8,
        "circle-stroke-color": colours.casing,
        "circle-stroke-width": 3,
      },
    });
  }

  update({ siteDraft }: Scene): void {
    if (this.map === null || siteDraft === this.shown) return;
    this.shown = siteDraft;
    setFeatures(this.map, SOURCE, siteDraft === null ? [] : draftFeatures(siteDraft));
  }

  recolour(colours: Colours): void {
    const { map } = this;
    if (map === null) return;
    const colour = colourOf(colours);
    map.setPaintProperty(DRAFT_FILL, "fill-color", colour);
    map.setPaintProperty(CASING, "line-color", colours.casing);
    map.setPaintProperty(EDGE, "line-color", colour);
    map.setPaintProperty(IMPORT_EDGE, "line-color", colour);
    map.setPaintProperty(DRAFT_POINT, "circle-color", colour);
    map.setPaintProperty(DRAFT_POINT, "circle-stroke-color", colours.casing);
  }
}

/** The draft and what was imported, as GeoJSON. */
export function draftFeatures({ features, imported, selectedId }: DraftShapes): Feature[] {
  const drafted = features.map(({ id, layer, rings }) =>
    shape(rings, LAYERS[layer].isPoint, {
      id,
      importIndex: null,
      layer,
      isSelected: id === selectedId,
      isImport: false,
    }),
  );
  const read = imported.map(({ rings, isPoint, layer }, importIndex) =>
    shape(rings, isPoint, {
      id: null,
      importIndex,
      layer: layer ?? EXCLUDED,
      isSelected: layer !== null,
      isImport: true,
    }),
  );
  return [...drafted, ...read];
}

function shape(
  rings: readonly Ring[],
  isPoint: boolean,
  properties: Feature["properties"],
): Feature {
  const positions = rings.map((ring) => closed(ring).map(({ lon, lat }): Point => [lon, lat]));
  const point = positions[0]?.[0] ?? [0, 0];
  return {
    type: "Feature",
    properties,
    geometry: isPoint
      ? { type: "Point", coordinates: point }
      : { type: "Polygon", coordinates: positions },
  };
}

/** A layer's colour on the map. */
export function layerColour(layer: LayerName, colours: Colours): string {
  switch (layer) {
    case "boundary":
      return colours.boundary;
    case "keep_out":
      return colours.keepOut;
    case "height_zones":
      return colours.heightZone;
    case "survey_regions":
      return colours.survey;
    case "landing_pads":
      return colours.text;
  }
}

function colourOf(colours: Colours): ExpressionSpecification {
  const of = (layer: LayerName) => layerColour(layer, colours);
  return [
    "match",
    ["get", "layer"],
    "boundary",
    of("boundary"),
    "keep_out",
    of("keep_out"),
    "height_zones",
    of("height_zones"),
    "survey_regions",
    of("survey_regions"),
    "landing_pads",
    of("landing_pads"),
    colours.stale,
  ];
}
