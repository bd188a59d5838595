import { Map as MapLibre, setWorkerUrl } from "maplibre-gl";
import workerUrl from "maplibre-gl/dist/maplibre-gl-worker.mjs?worker&url";
import { createEffect, createMemo, createSignal, on, onCleanup, onMount, Show } from "solid-js";
import "maplibre-gl/dist/maplibre-gl.css";
import "./map.css";
import { useConsole } from "../console";
import { courseText } from "../orders/course";
import { listNames, vehicleLabel } from "../text/names";
import { BoundaryLayer, HeightZoneLayer, KeepOutLayer, SurveyLayer } from "./areaLayer";
import { readColours } from "./colours";
import { FlyHereLayer } from "./flyHereLayer";
import { GroundImageNote } from "./GroundImageNote";
import { GraticuleLayer } from "./graticuleLayer";
import { createDisplayedGround, GroundImageLayer } from "./groundImageLayer";
import { HazardLayer } from "./hazardLayer";
import type { Box } from "./localGrid";
import { ForecastLayer, ShadeLayer, SurveyCellsLayer } from "./overlays";
import { PadLayer } from "./padLayer";
import { createSunHere, SunHereNote } from "./SunHere";
import { type Layer, type PlannedTarget, positionOf, wholeView } from "./scene";
import { SteeringLayer } from "./steeringLayer";
import { SurveyRowsLayer } from "./surveyRowsLayer";
import { TemporaryZoneLayer } from "./temporaryZoneLayer";
import { TrailLayer } from "./trailLayer";
import { VehicleLayer } from "./vehicleLayer";

// Under Vite MapLibre does not find its worker and stays blank.
setWorkerUrl(workerUrl);

/** Step of displayed ages on the map while no new state arrives. */
const AGE_STEP_S = 0.2;

/** The map with everything that has a position. */
export function MapView() {
  const { source, selection, theme, behindS, fitRequests, flyHere, zoneDraft, overlay } =
    useConsole();
  const { aim, setMapCentre } = useConsole();
  const [map, setMap] = createSignal<MapLibre | null>(null);
  const ground = createDisplayedGround(source);
  const sunHere = createSunHere(source, overlay, () => source.state()?.shade?.map?.number ?? null);
  let holder!: HTMLDivElement;
  let labels!: HTMLDivElement;
  let scaleBar!: HTMLDivElement;
  let tools!: HTMLDivElement;
  let notes!: HTMLDivElement;
  let layers: readonly Layer[] = [];

  onMount(() => {
    const made = createMap(holder, readColours(document).ground);
    layers = [
      new GroundImageLayer((frameId) => source.groundImage(frameId), ground),
      new ShadeLayer(overlay, source),
      new ForecastLayer(overlay, source),
      new SurveyCellsLayer(overlay, source),
      new GraticuleLayer(labels, scaleBar),
      new SurveyLayer(),
      new SurveyRowsLayer(source),
      new HeightZoneLayer(),
      new KeepOutLayer(),
      new BoundaryLayer(),
      new TemporaryZoneLayer(),
      new PadLayer(),
      new HazardLayer(),
      new TrailLayer(),
      new SteeringLayer(),
      new FlyHereLayer(),
      new VehicleLayer({ select: selection.only, toggle: selection.toggle }, [tools, notes]),
    ];
    made.on("click", ({ lngLat }) => aim({ lon: lngLat.lng, lat: lngLat.lat }));
    // A tap moves no pointer, and the keyboard moves the map under its centre.
    for (const kind of ["mousemove", "click"] as const)
      made.on(kind, ({ lngLat }) => sunHere.point({ lon: lngLat.lng, lat: lngLat.lat }));
    made.on("mouseout", () => sunHere.point(null));
    made.on("moveend", () => {
      const { lng: lon, lat } = made.getCenter();
      if (made.getCanvas().matches(":focus-visible")) sunHere.point({ lon, lat });
    });
    setMapCentre(() => ({ lon: made.getCenter().lng, lat: made.getCenter().lat }));
    made.on("load", () => {
      for (const layer of layers) layer.add(made, readColours(document));
      setMap(made);
    });
    onCleanup(() => made.remove());
  });

  // New states update the map; between them it is redrawn only as the state ages.
  const agedBehindS = createMemo(() => Math.floor(behindS() / AGE_STEP_S) * AGE_STEP_S);
  const plannedTarget = createMemo<PlannedTarget | null>(() => {
    const [vehicle, at, course] = [flyHere.vehicle(), flyHere.target(), flyHere.course()];
    if (vehicle === null || at === null) return null;
    const text = course === null ? vehicleLabel(vehicle) : courseText(course);
    return { from: positionOf(vehicle), at, text };
  });
  createEffect(() => {
    const state = source.state();
    if (map() === null || state === null) return;
    const scene = {
      state,
      behindS: agedBehindS(),
      selected: selection.keys(),
      plannedTarget: plannedTarget(),
      zoneDraft: zoneDraft.isOn()
        ? { points: zoneDraft.points(), radius_m: zoneDraft.radius_m() }
        : null,
    };
    for (const layer of layers) layer.update(scene);
  });

  createEffect(() => {
    theme.changes();
    const colours = readColours(document);
    map()?.setPaintProperty("ground", "background-color", colours.ground);
    if (map() !== null) for (const layer of layers) layer.recolour(colours);
  });

  const whole = createMemo<Box | null>(() => {
    const state = source.state();
    return state === null ? null : wholeView(state);
  });
  const fit = (isFirst: boolean) => {
    const box = whole();
    if (box !== null) map()?.fitBounds([box.west, box.south, box.east, box.north], view(isFirst));
  };
  createEffect(on(fitRequests, () => fit(false), { defer: true }));

  let hasFitted = false;
  createEffect(() => {
    if (hasFitted || map() === null || whole() === null) return;
    hasFitted = true;
    fit(true);
  });

  return (
    <section
      class="map"
      classList={{ "is-aiming": flyHere.isOn() || zoneDraft.isOn() }}
      aria-label="Map"
    >
      <div class="map-canvas" ref={holder} />
      <div class="grid-labels" ref={labels} aria-hidden="true" />
      <div class="map-tools" ref={tools}>
        <button type="button" class="button" onClick={() => map()?.zoomIn()} aria-label="Zoom in">
          +
        </button>
        <button type="button" class="button" onClick={() => map()?.zoomOut()} aria-label="Zoom out">
          −
        </button>
        <button type="button" class="button" onClick={() => fit(false)} title="Show everything (F)">
          Fit
        </button>
        <button
          type="button"
          class="button"
          aria-pressed={flyHere.isOn()}
          disabled={flyHere.vehicle() === null}
          aria-label="Fly here"
          title="Fly the selected vehicle to a position on the map (G)"
          onClick={() => flyHere.toggle()}
        >
          <AimIcon />
        </button>
      </div>
      <div class="map-scale">
        <span class="map-north" title="North is up">
          N ↑
        </span>
        <div class="map-scale-bar" ref={scaleBar} />
      </div>
      <div class="map-notes" ref={notes}>
        <GroundImageNote shown={ground.shown()} />
        <SunHereNote here={sunHere} />
        <UnplacedNote />
      </div>
    </section>
  );
}

/** A ring with a cross as SVG: not every font has one. */
function AimIcon() {
  return (
    <svg class="aim-icon" viewBox="0 0 24 24" width="24" height="24" aria-hidden="true">
      <circle cx="12" cy="12" r="7" />
      <path d="M12 1v8M12 15v8M1 12h8M15 12h8" />
    </svg>
  );
}

function createMap(container: HTMLElement, ground: string): MapLibre {
  const map = new MapLibre({
    container,
    // No sprite, glyphs or tiles: no network requests.
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
  });
  // North is always up, so that headings can be read directly.
  map.touchZoomRotate.disableRotation();
  map.keyboard.disableRotation();
  return map;
}

function view(isFirst: boolean) {
  return { padding: 90, maxZoom: 19, animate: !isFirst, duration: 400 };
}

/** Lists vehicles that cannot be drawn on the map. */
function UnplacedNote() {
  const { source } = useConsole();
  const unplaced = () =>
    (source.state()?.vehicles ?? []).filter((vehicle) => positionOf(vehicle) === null);
  return (
    <Show when={unplaced().length > 0}>
      <p class="map-note wire-text">
        Position unknown, not on the map: {listNames(unplaced().map(vehicleLabel))}
      </p>
    </Show>
  );
}
