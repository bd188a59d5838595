import { Map as MapLibre, setWorkerUrl } from "maplibre-gl";
import workerUrl from "maplibre-gl/dist/maplibre-gl-worker.mjs?worker&url";
import { createEffect, createMemo, createSignal, on, onCleanup, onMount, Show } from "solid-js";
import { text } from "../text/catalogue";
import "maplibre-gl/dist/maplibre-gl.css";
import "./map.css";
import { useConsole } from "../console";
import { courseText } from "../orders/course";
import type { VehicleView } from "../protocol";
import { listNames, vehicleLabel } from "../text/names";
import { AreaLabelLayer } from "./areaLabelLayer";
import { BoundaryLayer, HeightZoneLayer, KeepOutLayer, SurveyLayer } from "./areaLayer";
import { BaseMapLayer } from "./baseMapLayer";
import { readColours } from "./colours";
import { hideLayers } from "./features";
import { GroundImageNote } from "./GroundImageNote";
import { GraticuleLayer } from "./graticuleLayer";
import { createDisplayedGround, GroundImageLayer } from "./groundImageLayer";
import { LayersButton } from "./LayersButton";
import type { Box, LonLat } from "./localGrid";
import { MissionDraftLayer, type MissionShape } from "./missionDraftLayer";
import { MovingLayer } from "./movingLayer";
import { ForecastLayer, ShadeLayer, SurveyCellsLayer } from "./overlays";
import { PadLayer } from "./padLayer";
import { createSunHere, SunHereNote } from "./SunHere";
import { type DraftShapes, type Layer, type PlannedTarget, positionOf, wholeView } from "./scene";
import { createSelectionBand, keysIn } from "./selectionBand";
import { SiteDraftLayer } from "./siteDraftLayer";
import { createSiteEditing } from "./siteEditing";
import { SurveyRowsLayer } from "./surveyRowsLayer";
import { TargetLayer } from "./targetLayer";
import { TargetMarkers } from "./targetMarkers";
import { TemporaryZoneLayer } from "./temporaryZoneLayer";
import { middleOf, paddingOf } from "./uncovered";
import { VehicleLayer } from "./vehicleLayer";

// Under Vite MapLibre does not find its worker and stays blank.
setWorkerUrl(workerUrl);

/** Nothing is fitted into a smaller part of the map: only a wide land would be in it. */
const LEAST_ROOM_PX = 120;

/** Step of displayed ages on the map while no new state arrives. */
const AGE_STEP_S = 0.2;

/** The map with everything that has a position. */
export function MapView() {
  const { source, selection, theme, behindS, fitRequests, flyHere, zoneDraft, overlay } =
    useConsole();
  const { aim, setMapCentre, siteDraft, missionDraft, calibration, baseMaps } = useConsole();
  const [map, setMap] = createSignal<MapLibre | null>(null);
  const [isBanding, setBanding] = createSignal(false);
  const ground = createDisplayedGround(source);
  const sunHere = createSunHere(
    source.light,
    overlay,
    () => source.state()?.shade?.map?.number ?? null,
  );
  let holder!: HTMLDivElement;
  let scaleBar!: HTMLDivElement;
  let free!: HTMLDivElement;
  let layers: readonly Layer[] = [];
  const baseMap = new BaseMapLayer(source.maps);

  onMount(() => {
    const made = createMap(holder, readColours(document).ground, source.maps.tileRequest);
    layers = [
      baseMap,
      new GroundImageLayer((frameId) => source.light.groundImage(frameId), ground),
      new ShadeLayer(overlay, source.light),
      new ForecastLayer(overlay, source.light),
      new SurveyCellsLayer(overlay, source.surveys),
      new GraticuleLayer(scaleBar),
      new SurveyLayer(),
      new SurveyRowsLayer(source.surveys),
      new HeightZoneLayer(),
      new KeepOutLayer(),
      new BoundaryLayer(),
      new TemporaryZoneLayer(),
      new AreaLabelLayer(),
      new PadLayer(),
      new SiteDraftLayer(),
      new MissionDraftLayer(missionDraft),
      new MovingLayer(),
      new TargetLayer(),
      new VehicleLayer({ select: selection.only, toggle: selection.toggle }),
    ];
    const removeBand = createSelectionBand(made, isBanding, (band) => {
      setBanding(false);
      const found = keysIn(band, source.state()?.vehicles ?? [], made);
      selection.all([...new Set([...selection.keys(), ...found])]);
    });
    onCleanup(removeBand);
    made.on("click", ({ lngLat }) => aim({ lon: lngLat.lng, lat: lngLat.lat }));
    // A tap moves no pointer, and the keyboard moves the map under its centre.
    for (const kind of ["mousemove", "click"] as const)
      made.on(kind, ({ lngLat }) => sunHere.point({ lon: lngLat.lng, lat: lngLat.lat }));
    made.on("mouseout", () => sunHere.point(null));
    made.on("moveend", () => {
      const { lng: lon, lat } = made.getCenter();
      if (made.getCanvas().matches(":focus-visible")) sunHere.point({ lon, lat });
    });
    // The middle of what nothing covers: the operator sees where an order goes.
    setMapCentre(() => {
      const [x, y] = middleOf(holder, free);
      const half_px = free.clientWidth / 2;
      const { lng: lon, lat } = made.unproject([x, y]);
      const width_m = made.unproject([x - half_px, y]).distanceTo(made.unproject([x + half_px, y]));
      return { lon, lat, width_m };
    });
    createSiteEditing(made, siteDraft, theme);
    made.on("load", () => {
      for (const layer of layers) layer.add(made, readColours(document));
      hideLayers(made);
      setMap(made);
    });
    onCleanup(() => made.remove());
  });

  // New states update the map; between them it is redrawn only as the state ages.
  const agedBehindS = createMemo(() => Math.floor(behindS() / AGE_STEP_S) * AGE_STEP_S);
  const plannedTarget = createMemo<PlannedTarget | null>(() => {
    const [vehicle, at, course] = [flyHere.vehicle(), flyHere.target(), flyHere.course()];
    if (vehicle === null || at === null) return null;
    const label = course === null ? vehicleLabel(vehicle) : courseText(course);
    return { from: positionOf(vehicle), at, text: label };
  });
  const draftShapes = createMemo<DraftShapes | null>(() => {
    const { isOn, features, imported, selected } = siteDraft;
    if (!isOn()) return null;
    return {
      features: features(),
      imported: imported(),
      selectedId: selected()?.id ?? null,
    };
  });
  const missionFrom = createMemo(() => nearlyAt(missionDraft.vehicle()), null, { equals: isSame });
  const missionShape = createMemo<MissionShape | null>(() => {
    if (!missionDraft.isOn()) return null;
    const points = missionDraft.points().map(({ id, at, height }, index) => ({
      id,
      at,
      height_m: height.metres(),
      isSelected: missionDraft.selected() === id,
      isRefused: missionDraft.refusedPoint() === index + 1,
    }));
    return { from: missionFrom(), points };
  });
  createEffect(() => {
    const state = source.state();
    if (map() === null || state === null) return;
    const scene = {
      state,
      behindS: agedBehindS(),
      selected: selection.keys(),
      plannedTarget: plannedTarget(),
      missionDraft: missionShape(),
      zoneDraft: zoneDraft.isOn()
        ? { points: zoneDraft.points(), radius_m: zoneDraft.radius_m() }
        : null,
      siteDraft: draftShapes(),
    };
    for (const layer of layers) layer.update(scene);
  });

  createEffect(() => {
    const shown = baseMaps.shown();
    if (map() !== null) baseMap.show(shown);
  });

  const controlPoints = new TargetMarkers("target-planned");
  createEffect(() => {
    const shown = map();
    const placed = calibration.points().flatMap(({ id, name, place }) => {
      const colour = id === calibration.selected()?.id ? "var(--accent)" : "var(--text)";
      return place === null ? [] : [{ key: id, at: place, colour, text: name }];
    });
    if (shown !== null) controlPoints.show(shown, placed);
  });

  createEffect(() => {
    theme.changes();
    const colours = readColours(document);
    map()?.setPaintProperty("ground", "background-color", colours.ground);
    if (map() !== null) for (const layer of layers) layer.recolour(colours);
  });

  const whole = createMemo<Box | null>(() => {
    const state = source.state();
    return state === null ? null : wholeView(state, draftShapes());
  });
  const isPlacing = () =>
    [flyHere, missionDraft, zoneDraft, calibration].some((mode) => mode.isOn());
  const isAiming = () => isPlacing() || siteDraft.isOn();
  const fit = (isFirst: boolean) => {
    const [box, shown] = [whole(), map()];
    if (box === null || shown === null) return;
    const options = { ...view(isFirst), padding: paddingOf(holder, free) };
    shown.fitBounds([box.west, box.south, box.east, box.north], options);
    isFitted = true;
  };
  // Until a person moves the map, nothing that takes room covers the view.
  let isFitted = false;
  const byHand = (move: () => void) => () => {
    isFitted = false;
    move();
  };
  onMount(() => {
    const room = new ResizeObserver(() => {
      const { clientWidth, clientHeight } = free;
      const isEnough = Math.min(clientWidth, clientHeight) >= LEAST_ROOM_PX;
      if (isFitted && isEnough && !isAiming()) fit(false);
    });
    room.observe(free);
    onCleanup(() => room.disconnect());
  });
  createEffect(() => {
    map()?.on("movestart", ({ originalEvent }) => {
      if (originalEvent !== undefined) isFitted = false;
    });
  });
  createEffect(on(fitRequests, () => fit(false), { defer: true }));
  // What was imported may be anywhere.
  createEffect(on(siteDraft.imported, (read) => read.length > 0 && fit(false), { defer: true }));

  let hasFitted = false;
  createEffect(() => {
    if (hasFitted || map() === null || whole() === null) return;
    hasFitted = true;
    fit(true);
  });

  return (
    <>
      <section
        class="map"
        classList={{
          "is-aiming": isPlacing() || siteDraft.tool() !== null,
        }}
        aria-label={text.map.name}
      >
        <div class="map-canvas" ref={holder} />
      </section>
      <div class="map-free" ref={free}>
        <div class="map-tools">
          <LayersButton />
          <button
            type="button"
            class="button"
            aria-pressed={isBanding()}
            onClick={() => setBanding(!isBanding())}
            title={text.map.bandHint}
            aria-label={text.map.band}
          >
            <BandIcon />
          </button>
          <button
            type="button"
            class="button"
            onClick={() => fit(false)}
            title={text.map.fitHint}
            aria-label={text.map.fit}
          >
            <FitIcon />
          </button>
          <button
            type="button"
            class="button"
            onClick={byHand(() => map()?.zoomIn())}
            aria-label={text.map.zoomIn}
          >
            +
          </button>
          <button
            type="button"
            class="button"
            onClick={byHand(() => map()?.zoomOut())}
            aria-label={text.map.zoomOut}
          >
            −
          </button>
        </div>
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

/** The name and source of the base map, as its licence asks. */
function BaseMapNote() {
  const { baseMaps } = useConsole();
  return (
    <Show when={baseMaps.shown()}>
      {(base) => (
        <p class="map-note wire-text">
          {text.map.base(
            [base().title, base().attribution].filter((part) => part !== "").join(", "),
          )}
        </p>
      )}
    </Show>
  );
}

/** A dashed box around a dot. */
function BandIcon() {
  return (
    <svg class="fit-icon" viewBox="0 0 24 24" width="22" height="22" aria-hidden="true">
      <path stroke-dasharray="4 3" d="M4 4h16v16H4z" />
      <path d="M11 12h2" />
    </svg>
  );
}

/** Four corners as SVG: not every font has the sign. */
function FitIcon() {
  return (
    <svg class="fit-icon" viewBox="0 0 24 24" width="22" height="22" aria-hidden="true">
      <path d="M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5" />
    </svg>
  );
}

function createMap(
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

/** Where a vehicle is to some metres, so that a line from there is not drawn anew for each state. */
function nearlyAt(vehicle: VehicleView | null): LonLat | null {
  const at = vehicle === null ? null : positionOf(vehicle);
  const rounded = (degrees: number) => Number(degrees.toFixed(NEARLY_DECIMALS));
  return at && { lon: rounded(at.lon), lat: rounded(at.lat) };
}

const NEARLY_DECIMALS = 4;

function isSame(a: LonLat | null, b: LonLat | null): boolean {
  return a?.lon === b?.lon && a?.lat === b?.lat;
}

function view(isFirst: boolean) {
  return { maxZoom: 19, animate: !isFirst, duration: 400 };
}

/** Lists vehicles that cannot be drawn on the map. */
function UnplacedNote() {
  const { source } = useConsole();
  const unplaced = () =>
    (source.state()?.vehicles ?? []).filter((vehicle) => positionOf(vehicle) === null);
  return (
    <Show when={unplaced().length > 0}>
      <p class="map-note wire-text">{text.map.unplaced(listNames(unplaced().map(vehicleLabel)))}</p>
    </Show>
  );
}
