import type { Map as MapLibre } from "maplibre-gl";
import { type Accessor, createEffect, createSignal, onMount } from "solid-js";
import { useMapModes, useOrders, usePage, useSiteEditing, useStation } from "../console";
import { AreaLabelLayer } from "./areaLabelLayer";
import { BoundaryLayer, HeightZoneLayer, KeepOutLayer, SurveyLayer } from "./areaLayer";
import { BaseMapLayer } from "./baseMapLayer";
import { readColours } from "./colours";
import { hideLayers } from "./features";
import { GraticuleLayer } from "./graticuleLayer";
import { type DisplayedGround, GroundImageLayer } from "./groundImageLayer";
import { LightSensorLayer } from "./lightSensorLayer";
import { MissionDraftLayer } from "./missionDraftLayer";
import { MovingLayer } from "./movingLayer";
import { ForecastLayer, ShadeLayer, SurveyCellsLayer } from "./overlays";
import { PadLayer } from "./padLayer";
import type { Layer, Scene } from "./scene";
import { SiteDraftLayer } from "./siteDraftLayer";
import { SurveyRowsLayer } from "./surveyRowsLayer";
import { TargetLayer } from "./targetLayer";
import { TargetMarkers } from "./targetMarkers";
import { TemporaryZoneLayer } from "./temporaryZoneLayer";
import { VehicleLayer } from "./vehicleLayer";

/** Draws the scene in a map, the lowest layer first; returns the map once it has its layers. */
export function createMapLayers(
  made: Accessor<MapLibre | null>,
  scaleBar: () => HTMLElement,
  ground: DisplayedGround,
  scene: Accessor<Scene | null>,
): Accessor<MapLibre | null> {
  const { source } = useStation();
  const { selection } = useOrders();
  const { overlay, missionDraft, baseMaps } = useMapModes();
  const { theme } = usePage();
  const [drawn, setDrawn] = createSignal<MapLibre | null>(null);
  const baseMap = new BaseMapLayer(source.maps);
  let layers: readonly Layer[] = [];
  onMount(() => {
    layers = [
      baseMap,
      new GroundImageLayer((frameId) => source.light.groundImage(frameId), ground),
      new ShadeLayer(overlay, source.light),
      new ForecastLayer(overlay, source.light),
      new SurveyCellsLayer(overlay, source.surveys),
      new GraticuleLayer(scaleBar()),
      new SurveyLayer(),
      new SurveyRowsLayer(source.surveys),
      new HeightZoneLayer(),
      new KeepOutLayer(),
      new BoundaryLayer(),
      new TemporaryZoneLayer(),
      new AreaLabelLayer(),
      new PadLayer(),
      new LightSensorLayer(),
      new SiteDraftLayer(),
      new MissionDraftLayer(missionDraft),
      new MovingLayer(),
      new TargetLayer(),
      new VehicleLayer({ select: selection.only, toggle: selection.toggle }),
    ];
  });
  createEffect(() => {
    const map = made();
    map?.on("load", () => {
      for (const layer of layers) layer.add(map, readColours(document));
      hideLayers(map);
      setDrawn(map);
    });
  });
  createEffect(() => {
    const shown = drawn() === null ? null : scene();
    if (shown !== null) for (const layer of layers) layer.update(shown);
  });
  createEffect(() => {
    const shown = baseMaps.shown();
    if (drawn() !== null) baseMap.show(shown);
  });
  createEffect(() => {
    theme.changes();
    const colours = readColours(document);
    drawn()?.setPaintProperty("ground", "background-color", colours.ground);
    if (drawn() !== null) for (const layer of layers) layer.recolour(colours);
  });
  createControlPoints(drawn);
  return drawn;
}

/** The points by which a camera is calibrated. */
function createControlPoints(drawn: Accessor<MapLibre | null>): void {
  const { calibration } = useSiteEditing();
  const markers = new TargetMarkers("target-planned");
  createEffect(() => {
    const shown = drawn();
    const placed = calibration.points().flatMap(({ id, name, place }) => {
      const colour = id === calibration.selected()?.id ? "var(--accent)" : "var(--text)";
      return place === null ? [] : [{ key: id, at: place, colour, text: name }];
    });
    if (shown !== null) markers.show(shown, placed);
  });
}
