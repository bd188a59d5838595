import type { Map as MapLibre } from "maplibre-gl";
import { createSignal, onCleanup, onMount } from "solid-js";
import { text } from "../text/catalogue";
import "maplibre-gl/dist/maplibre-gl.css";
import "./map.css";
import { useMapModes, useOrders, usePage, useSiteEditing, useStation } from "../console";
import { readColours } from "./colours";
import { createDraftShapes, createScene } from "./drawnScene";
import { GroundImageNote } from "./GroundImageNote";
import { createDisplayedGround } from "./groundImageLayer";
import { BaseMapNote, UnplacedNote } from "./MapNotes";
import { MapTools } from "./MapTools";
import { centreOf, createMapCamera } from "./mapCamera";
import { createMapLayers } from "./mapLayers";
import { createMap } from "./newMap";
import { createSunHere, type SunHere, SunHereNote } from "./SunHere";
import { createSelectionBand, keysIn } from "./selectionBand";
import { createSiteEditing } from "./siteEditing";

/** The map with everything that has a position. */
export function MapView() {
  const { source } = useStation();
  const { aim, setMapCentre, overlay } = useMapModes();
  const { theme } = usePage();
  const { flyHere, missionDraft, zoneDraft } = useMapModes();
  const { siteDraft, calibration } = useSiteEditing();
  const [made, setMade] = createSignal<MapLibre | null>(null);
  const [isBanding, setBanding] = createSignal(false);
  let holder!: HTMLDivElement;
  let scaleBar!: HTMLDivElement;
  let free!: HTMLDivElement;
  const parts = () => ({ holder, free });
  const ground = createDisplayedGround(source);
  const mapNumber = () => source.state()?.shade?.map?.number ?? null;
  const sunHere = createSunHere(source.light, overlay, mapNumber);
  const draft = createDraftShapes();
  const isPlacing = () =>
    [flyHere, missionDraft, zoneDraft, calibration].some((mode) => mode.isOn());
  const map = createMapLayers(made, () => scaleBar, ground, createScene(draft));
  const camera = createMapCamera(map, parts, draft, () => isPlacing() || siteDraft.isOn());

  onMount(() => {
    const map = createMap(holder, readColours(document).ground, source.maps.tileRequest);
    onCleanup(() => map.remove());
    createBand(map, isBanding, () => setBanding(false));
    map.on("click", ({ lngLat }) => aim({ lon: lngLat.lng, lat: lngLat.lat }));
    pointSun(map, sunHere);
    setMapCentre(() => centreOf(map, parts()));
    createSiteEditing(map, siteDraft, theme);
    setMade(map);
  });

  return (
    <>
      <section
        class="map"
        classList={{ "is-aiming": isPlacing() || siteDraft.tool() !== null }}
        aria-label={text.map.name}
      >
        <div class="map-canvas" ref={holder} />
      </section>
      <div class="map-free" ref={free}>
        <MapTools map={map()} camera={camera} isBanding={isBanding()} setBanding={setBanding} />
        <div class="map-notes">
          <UnplacedNote />
          <SunHereNote here={sunHere} />
          <GroundImageNote shown={ground.shown()} />
          <BaseMapNote />
          <div class="map-scale">
            <div class="map-scale-bar" ref={scaleBar} />
            <span title={text.map.northHint}>{text.map.northArrow}</span>
          </div>
        </div>
      </div>
    </>
  );
}

/** Selects the vehicles inside a box that is drawn over the map, beside those selected. */
function createBand(map: MapLibre, isBanding: () => boolean, end: () => void): void {
  const { source } = useStation();
  const { selection } = useOrders();
  const remove = createSelectionBand(map, isBanding, (band) => {
    end();
    const found = keysIn(band, source.state()?.vehicles ?? [], map);
    selection.all([...new Set([...selection.keys(), ...found])]);
  });
  onCleanup(remove);
}

/** Asks for the light under the pointer; a tap moves none, and keys move the map under its centre. */
function pointSun(map: MapLibre, sunHere: SunHere): void {
  for (const kind of ["mousemove", "click"] as const)
    map.on(kind, ({ lngLat }) => sunHere.point({ lon: lngLat.lng, lat: lngLat.lat }));
  map.on("mouseout", () => sunHere.point(null));
  map.on("moveend", () => {
    const { lng: lon, lat } = map.getCenter();
    if (map.getCanvas().matches(":focus-visible")) sunHere.point({ lon, lat });
  });
}
