import type { Map as MapLibre } from "maplibre-gl";
import {
  type GeoJSONStoreFeatures,
  TerraDraw,
  TerraDrawPointMode,
  TerraDrawPolygonMode,
  TerraDrawSelectMode,
} from "terra-draw";
import { TerraDrawMapLibreGLAdapter } from "terra-draw-maplibre-gl-adapter";
import { closed, type DraftFeature, LAYERS, type Ring } from "../site/siteFeatures";

type Hex = `#${string}`;

/** What the editor reports. */
export interface RingEvents {
  drawn(ring: Ring): void;
  changed(index: number, ring: Ring): void;
}

/** Decimals of a degree that the library takes: a tenth of a millimetre. */
const DECIMALS = 9;
const DRAWN_AGAIN_PX = 24;

/**
 * Drawing and editing rings with a pointer, by Terra Draw. It knows no holes, so each ring of the feature being
 * edited is a polygon of its own there. Its store is filled from the draft and never the other way round.
 */
export class RingEditor {
  private readonly tool: TerraDraw;
  /** The rings in the tool's store; while they are the draft's, the tool is left alone. */
  private held = "";

  constructor(map: MapLibre, events: RingEvents) {
    const adapter = new TerraDrawMapLibreGLAdapter({ map, coordinatePrecision: DECIMALS });
    const corners = { midpoints: true, draggable: true, deletable: true };
    this.tool = new TerraDraw({
      adapter,
      modes: [
        new TerraDrawPolygonMode({ pointerDistance: DRAWN_AGAIN_PX, showCoordinatePoints: true }),
        new TerraDrawPointMode(),
        new TerraDrawSelectMode({
          allowManualDeselection: false,
          // Keys belong to the page: Delete here would remove the whole ring.
          keyEvents: null,
          flags: {
            polygon: { feature: { coordinates: corners } },
            point: { feature: { draggable: true } },
          },
        }),
      ],
    });
    this.tool.start();
    this.tool.on("finish", (id, { action }) => {
      const feature = this.tool.getSnapshotFeature(id);
      if (feature === undefined) return;
      const ring = ringOf(feature);
      if (action === "draw") {
        // After the tool's own handler: the draft's answer empties its store.
        queueMicrotask(() => events.drawn(ring));
        return;
      }
      const index = Number(feature.properties["ring"]);
      this.held = this.rings();
      events.changed(index, ring);
    });
  }

  draw(shape: "polygon" | "point"): void {
    if (this.tool.getMode() === shape) return;
    this.empty();
    this.tool.setMode(shape);
  }

  edit({ rings, layer }: DraftFeature): void {
    const isPoint = LAYERS[layer].isPoint;
    const features = rings.map((ring, index) => featureOf(ring, index, isPoint));
    if (this.tool.getMode() === "select" && this.held === textOf(features)) return;
    const selected = this.selectedRing();
    this.empty();
    this.tool.setMode("select");
    const added = this.tool.addFeatures(features);
    this.held = this.rings();
    const chosen = added[Math.min(selected, added.length - 1)];
    if (chosen?.valid === true && chosen.id !== undefined) this.tool.selectFeature(chosen.id);
  }

  /** Nothing is drawn or edited. */
  rest(): void {
    this.empty();
    this.tool.setMode("static");
  }

  recolour({ line, casing }: { readonly line: string; readonly casing: string }): void {
    const [own, rim] = [line as Hex, casing as Hex];
    this.tool.updateModeOptions<typeof TerraDrawPolygonMode>("polygon", {
      styles: {
        fillColor: own,
        fillOpacity: 0.15,
        outlineColor: own,
        outlineWidth: 3,
        closingPointColor: own,
        closingPointWidth: 8,
        closingPointOutlineColor: rim,
        closingPointOutlineWidth: 3,
        coordinatePointColor: own,
        coordinatePointWidth: 6,
        coordinatePointOutlineColor: rim,
        coordinatePointOutlineWidth: 2,
      },
    });
    this.tool.updateModeOptions<typeof TerraDrawPointMode>("point", {
      styles: { pointColor: own, pointWidth: 9, pointOutlineColor: rim, pointOutlineWidth: 3 },
    });
    this.tool.updateModeOptions<typeof TerraDrawSelectMode>("select", {
      styles: {
        selectedPolygonColor: own,
        selectedPolygonFillOpacity: 0.15,
        selectedPolygonOutlineColor: own,
        selectedPolygonOutlineWidth: 3,
        selectedPointColor: own,
        selectedPointWidth: 9,
        selectedPointOutlineColor: rim,
        selectedPointOutlineWidth: 3,
        selectionPointColor: own,
        selectionPointWidth: 9,
        selectionPointOutlineColor: rim,
        selectionPointOutlineWidth: 3,
        midPointColor: rim,
        midPointWidth: 6,
        midPointOutlineColor: own,
        midPointOutlineWidth: 2,
      },
    });
  }

  stop(): void {
    this.tool.stop();
  }

  private empty(): void {
    this.held = "";
    this.tool.clear();
  }

  private shapes(): GeoJSONStoreFeatures[] {
    return this.tool
      .getSnapshot()
      .filter(({ properties }) => typeof properties["ring"] === "number")
      .sort((a, b) => Number(a.properties["ring"]) - Number(b.properties["ring"]));
  }

  private rings(): string {
    return textOf(this.shapes());
  }

  private selectedRing(): number {
    const found = this.shapes().find(({ properties }) => properties["selected"] === true);
    return found === undefined ? 0 : Number(found.properties["ring"]);
  }
}

function featureOf(ring: Ring, index: number, isPoint: boolean): GeoJSONStoreFeatures {
  const positions = closed(ring).map(({ lon, lat }) => [rounded(lon), rounded(lat)]);
  return {
    type: "Feature",
    properties: { mode: isPoint ? "point" : "polygon", ring: index },
    geometry: isPoint
      ? { type: "Point", coordinates: positions[0] ?? [0, 0] }
      : { type: "Polygon", coordinates: [positions] },
  };
}

function ringOf({ geometry }: GeoJSONStoreFeatures): Ring {
  const corner = ([lon = 0, lat = 0]: readonly number[]) => ({ lon, lat });
  if (geometry.type === "Point") return [corner(geometry.coordinates)];
  const [ring = []] = geometry.type === "Polygon" ? geometry.coordinates : [];
  return ring.slice(0, -1).map(corner);
}

function textOf(features: readonly GeoJSONStoreFeatures[]): string {
  return JSON.stringify(features.map(({ geometry }) => geometry.coordinates));
}

function rounded(degrees: number): number {
  return Number(degrees.toFixed(DECIMALS));
}
