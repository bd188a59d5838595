import type { Map as MapLibre, RasterSourceSpecification } from "maplibre-gl";
import { expect, test } from "vitest";
import { mapRequests } from "../source/mapRequests";
import { StationHttp } from "../source/stationHttp";
import { baseMap } from "../testing/fakeField";
import { BaseMapLayer } from "./baseMapLayer";
import type { Colours } from "./colours";

const DIM = { baseMapOpacity: 0.5, baseMapSaturation: -0.2 } as Colours;

/** The layers of a map from bottom to top, and what its source and paint are. */
function fakeMap(...ids: string[]) {
  const layers = ids.map((id) => ({ id }));
  const paint: Record<string, unknown> = {};
  const shown = { source: null as RasterSourceSpecification | null, layers, paint };
  const map = {
    getStyle: () => ({ layers }),
    addSource: (_id: string, source: RasterSourceSpecification) => {
      if (shown.source !== null) throw new Error("There is a source already.");
      shown.source = source;
    },
    removeSource: () => {
      shown.source = null;
    },
    addLayer: (layer: { id: string; paint: object }, before?: string) => {
      const at = layers.findIndex(({ id }) => id === before);
      layers.splice(at < 0 ? layers.length : at, 0, layer);
      Object.assign(paint, layer.paint);
    },
    removeLayer: (gone: string) => {
      layers.splice(
        layers.findIndex(({ id }) => id === gone),
        1,
      );
    },
    setPaintProperty: (_id: string, name: string, value: unknown) => {
      paint[name] = value;
    },
  };
  return { map: map as unknown as MapLibre, shown };
}

function setUp(...ids: string[]) {
  const { map, shown } = fakeMap(...ids);
  const http = new StationHttp("http://station", "secret", async () => new Response());
  const requests = mapRequests(http);
  const layer = new BaseMapLayer(requests);
  layer.add(map, DIM);
  return { layer, shown, requests };
}

const idsOf = ({ layers }: { layers: readonly { id: string }[] }) => layers.map(({ id }) => id);

test("it lies above the bare ground and below everything else", () => {
  const { layer, shown } = setUp("ground", "ground-image", "shade", "boundary");
  layer.show(baseMap());
  expect(idsOf(shown)).toEqual(["ground", "base-map", "ground-image", "shade", "boundary"]);
  const alone = setUp("ground");
  alone.layer.show(baseMap());
  expect(idsOf(alone.shown)).toEqual(["ground", "base-map"]);
});

test("another map takes its place, and none leaves nothing", () => {
  const { layer, shown } = setUp("ground", "boundary");
  layer.show(baseMap({ name: "a.tif" }));
  layer.show(baseMap({ name: "Süd {z} 1.mbtiles", version: "v 2", min_zoom: 14, tile_px: 512 }));
  expect(idsOf(shown)).toEqual(["ground", "base-map", "boundary"]);
  expect(shown.source?.tiles).toEqual([
    "http://station/api/maps/S%C3%BCd%20%7Bz%7D%201.mbtiles/{z}/{x}/{y}?v=v%202",
  ]);
  expect(shown.source).toMatchObject({ minzoom: 14, maxzoom: 19, tileSize: 512 });
  expect(shown.source?.bounds).toEqual([-93.61, 41.89, -93.59, 41.91]);
  layer.show(null);
  expect(idsOf(shown)).toEqual(["ground", "boundary"]);
  expect(shown.source).toBeNull();
});

test("the theme dims it, also one that is shown later", () => {
  const { layer, shown } = setUp("ground");
  layer.show(baseMap());
  expect(shown.paint).toMatchObject({ "raster-opacity": 0.5, "raster-saturation": -0.2 });
  layer.recolour({ ...DIM, baseMapOpacity: 0.3 });
  expect(shown.paint["raster-opacity"]).toBe(0.3);
  layer.show(baseMap());
  expect(shown.paint["raster-opacity"]).toBe(0.3);
});

test("the token goes with tiles of the station, and nowhere else", () => {
  const { requests } = setUp("ground");
  const tile = requests.tiles(baseMap()).replace("{z}/{x}/{y}", "3/2/1");
  expect(requests.tileRequest(tile).headers).toEqual({ Authorization: "Bearer secret" });
  for (const other of ["http://elsewhere/api/maps/a/3/2/1", "http://station.evil/api/maps/a"])
    expect(requests.tileRequest(other)).toEqual({ url: other });
});
