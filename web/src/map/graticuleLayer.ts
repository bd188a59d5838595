import type { Feature } from "geojson";
import type { Map as MapLibre } from "maplibre-gl";
import { inLengthUnit, lengthUnit, metresOf } from "../text/units";
import type { Colours } from "./colours";
import { addFeatures, lineFeature, setFeatures } from "./features";
import { gridLines, type LonLat, metresPerDegree, roundStepM } from "./localGrid";
import { gridOrigin, type Layer, type Scene } from "./scene";

const SOURCE = "graticule";
const LINES = "graticule-lines";
/** Smallest distance between lines on the screen. */
const LEAST_GAP_PX = 96;

/** A grid in round lengths, and the scale bar. */
export class GraticuleLayer implements Layer {
  private map: MapLibre | null = null;
  private origin: LonLat | null = null;
  private unit = lengthUnit();

  /** Sets width and text of `scaleBar`. */
  constructor(private readonly scaleBar: HTMLElement) {}

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    addFeatures(map, SOURCE);
    map.addLayer({ id: LINES, type: "line", source: SOURCE, paint: linePaint(colours) });
    map.on("move", () => this.draw());
    map.on("resize", () => this.draw());
  }

  update(scene: Scene): void {
    // Keep the first origin: a grid that jumps is worse than one off centre.
    const origin = this.origin ?? gridOrigin(scene.state);
    if (origin === this.origin && lengthUnit() === this.unit) return;
    this.origin = origin;
    this.unit = lengthUnit();
    this.draw();
  }

  recolour(colours: Colours): void {
    const paint = linePaint(colours);
    this.map?.setPaintProperty(LINES, "line-color", paint["line-color"]);
  }

  private draw(): void {
    if (this.map === null || this.origin === null) return;
    const metresPerPixel = metresPerPixelOf(this.map, this.origin.lat);
    const step = roundStepM(inLengthUnit(LEAST_GAP_PX * metresPerPixel));
    const step_m = metresOf(step);
    const bounds = this.map.getBounds();
    const box = {
      west: bounds.getWest(),
      east: bounds.getEast(),
      south: bounds.getSouth(),
      north: bounds.getNorth(),
    };
    const grid = gridLines(box, this.origin, step_m);
    setFeatures(this.map, SOURCE, [
      ...grid.eastings.map((line) => meridian(line.deg, box.south, box.north, line.m)),
      ...grid.northings.map((line) => parallel(line.deg, box.west, box.east, line.m)),
    ]);
    this.drawScale(step_m / metresPerPixel, step);
  }

  private drawScale(width_px: number, step: number): void {
    this.scaleBar.style.width = `${width_px}px`;
    this.scaleBar.textContent = stepText(step);
  }
}

function linePaint(colours: Colours) {
  return {
    "line-color": ["case", ["==", ["get", "m"], 0], colours.gridAxis, colours.grid],
    "line-width": ["case", ["==", ["get", "m"], 0], 2, 1],
    "line-opacity": 0.8,
  } as {
    "line-color": ["case", ["==", ["get", "m"], 0], string, string];
    "line-width": ["case", ["==", ["get", "m"], 0], number, number];
    "line-opacity": number;
  };
}

function meridian(lon: number, south: number, north: number, m: number): Feature {
  return lineFeature(
    [
      [lon, south],
      [lon, north],
    ],
    { m },
  );
}

function parallel(lat: number, west: number, east: number, m: number): Feature {
  return lineFeature(
    [
      [west, lat],
      [east, lat],
    ],
    { m },
  );
}

function metresPerPixelOf(map: MapLibre, lat: number): number {
  const width = map.getContainer().clientWidth;
  const left = map.unproject([0, 0]);
  const right = map.unproject([width, 0]);
  return ((right.lng - left.lng) * metresPerDegree(lat).lon) / Math.max(1, width);
}

function stepText(step: number): string {
  const isLong = lengthUnit() === "m" && step >= 1000;
  return isLong ? `${step / 1000} km` : `${step} ${lengthUnit()}`;
}
