import { Map as MapLibre, setWorkerUrl } from "maplibre-gl";
import workerUrl from "maplibre-gl/dist/maplibre-gl-worker.mjs?worker&url";

// Under Vite MapLibre does not find its worker and stays blank.
setWorkerUrl(workerUrl);

/** A map of nothing but its ground; north is always up, and only the station is asked for tiles. */
export function createMap(
  container: HTMLElement,
  ground: string,
  transformRequest: (url: string) => { url: string },
): MapLibre {
  const map = new MapLibre({
    container,
    transformRequest,
    // No sprite, glyphs or foreign tiles: only the station is asked.
    style: {
      version: 8,
      sources: {},
      layers: [{ id: "ground", type: "background", paint: { "background-color": ground } }],
    },
    center: [0, 0],
    zoom: 1,
    maxZoom: 23,
    attributionControl: false,
    dragRotate: false,
    pitchWithRotate: false,
    touchPitch: false,
    // A fade would repaint the whole map at the rate of the screen after each change of a label.
    fadeDuration: 0,
  });
  // North is always up, so that headings can be read directly.
  map.touchZoomRotate.disableRotation();
  map.keyboard.disableRotation();
  return map;
}
