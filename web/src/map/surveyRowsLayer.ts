import type { Feature } from "geojson";
import type { Map as MapLibre } from "maplibre-gl";
import type { SurveyPaths } from "../protocol";
import type { SurveyRequests } from "../source/surveyRequests";
import { shownSurvey } from "../text/survey";
import type { Colours } from "./colours";
import { addFeatures, lineFeature, type Point, setFeatures } from "./features";
import type { Layer, Scene } from "./scene";

const SOURCE = "survey-rows";
/** Makes the rows visible on the ground image too. */
const CASING = "survey-rows-casing";
const PLANNED = "survey-rows-planned";
const FLYING = "survey-rows-flying";
const FLOWN = "survey-rows-flown";
/** Shortest interval between requests (station time). */
const REPEAT_NS = 2e9;

/** A survey's rows: planned ones dotted, current missions dashed, flown ones solid. */
export class SurveyRowsLayer implements Layer {
  private map: MapLibre | null = null;
  private shown = "";
  private isFetching = false;
  private notBefore_ns = 0;

  constructor(private readonly surveys: Pick<SurveyRequests, "paths">) {}

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    addFeatures(map, SOURCE);
    const look = (id: string, width: number, dash: number[] | null) =>
      map.addLayer({
        id,
        type: "line",
        source: SOURCE,
        filter: ["==", ["get", "kind"], id],
        paint: {
          "line-color": colours.survey,
          "line-width": width,
          ...(dash === null ? {} : { "line-dasharray": dash }),
        },
      });
    map.addLayer({
      id: CASING,
      type: "line",
      source: SOURCE,
      paint: { "line-color": colours.casing, "line-width": 5, "line-opacity": 0.55 },
    });
    look(PLANNED, 2, [1, 2]);
    look(FLYING, 2, [4, 2]);
    look(FLOWN, 3.5, null);
  }

  update(scene: Scene): void {
    const survey = shownSurvey(scene.state.surveys);
    if (survey === null) {
      this.draw("", null);
      return;
    }
    const key = `${survey.id}:${survey.phase}:${survey.missions}:${survey.paths}`;
    const isNew = key !== this.shown;
    if (!isNew || this.isFetching || scene.state.time_ns < this.notBefore_ns) return;
    this.isFetching = true;
    this.notBefore_ns = scene.state.time_ns + REPEAT_NS;
    void this.surveys
      .paths(survey.id)
      .then((outcome) => {
        if (outcome.kind === "answered") this.draw(key, outcome.value);
      })
      .finally(() => {
        this.isFetching = false;
      });
  }

  recolour(colours: Colours): void {
    this.map?.setPaintProperty(CASING, "line-color", colours.casing);
    for (const id of [PLANNED, FLYING, FLOWN]) {
      this.map?.setPaintProperty(id, "line-color", colours.survey);
    }
  }

  private draw(key: string, paths: SurveyPaths | null): void {
    if (this.map === null || key === this.shown) return;
    this.shown = key;
    setFeatures(this.map, SOURCE, paths === null ? [] : pathFeatures(paths));
  }
}

/** The lines of a survey's paths, each with its kind. */
export function pathFeatures(paths: SurveyPaths): Feature[] {
  const line = (places: readonly (readonly [number, number])[], kind: string): Feature[] =>
    places.length < 2
      ? []
      : [
          lineFeature(
            places.map(([lon, lat]): Point => [lon, lat]),
            { kind },
          ),
        ];
  return [
    ...paths.rows.flatMap((row) => line(row, PLANNED)),
    ...paths.flying.flatMap(({ places }) => line(places, FLYING)),
    ...paths.flown.flatMap(({ places }) => line(places, FLOWN)),
  ];
}
