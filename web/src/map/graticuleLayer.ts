import type { Feature } from "geojson";
import type { Map as MapLibre } from "maplibre-gl";
import type { Colours } from "./colours";
import { addFeatures, lineFeature, setFeatures } from "./features";
import { type Grid, gridLines, type LonLat, metresPerDegree, roundStepM } from "./localGrid";
import { gridOrigin, type Layer, type Scene } from "./scene";

const SOURCE = "graticule";
const LINES = "graticule-lines";
/** Smallest distance between lines on the screen. */
const LEAST_GAP_PX = 96;
/** Distance of labels from the map's corners, which hold other controls. */
const LABEL_MARGIN_PX = 56;

/** Metric grid with labels at the edges, and the scale bar. */
export class GraticuleLayer implements Layer {
  private map: MapLibre | null = null;
  private origin: LonLat | null = null;

  /** Fills `labels`, an element over the map, and sets width and text of `scaleBar`. */
  constructor(
    private readonly labels: HTMLElement,
    private readonly scaleBar: HTMLElement,
  ) {}

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    addFeatures(map, SOURCE);
    map.addLayer({ id: LINES, type: "line", source: SOURCE, paint: linePaint(colours) });
    map.on("move", () => this.draw());
    map.on("resize", () => this.draw());
  }

  update(scene: Scene): void {
    // Keep the first origin: a grid that jumps is worse than one off centre.
    if (this.origin !== null) return;
    this.origin = gridOrigin(scene.state);
    if (this.origin !== null) this.draw();
  }

  recolour(colours: Colours): void {
    const paint = linePaint(colours);
    this.map?.setPaintProperty(LINES, "line-color", paint["line-color"]);
  }

  private draw(): void {
    if (this.map === null || this.origin === null) return;
    const metresPerPixel = metresPerPixelOf(this.map, this.origin.lat);
    const step_m = roundStepM(LEAST_GAP_PX * metresPerPixel);
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
    this.labels.replaceChildren(...labelsOf(this.map, grid, box.west, box.north));
    this.drawScale(metresPerPixel, step_m);
  }

  private drawScale(metresPerPixel: number, step_m: number): void {
    this.scaleBar.style.width = `${step_m / metresPerPixel}px`;
    this.scaleBar.textContent = distance(step_m);
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

function labelsOf(map: MapLibre, grid: Grid, west: number, north: number): HTMLElement[] {
  const { clientWidth, clientHeight } = map.getContainer();
  const east = grid.eastings
    .map((line) => ({ line, x: map.project([line.deg, north]).x }))
    .filter(({ x }) => x > LABEL_MARGIN_PX && x < clientWidth - LABEL_MARGIN_PX)
    .map(({ line, x }) => label("grid-label-east", `left:${x}px`, direction(line.m, "E", "W")));
  const up = grid.northings
    .map((line) => ({ line, y: map.project([west, line.deg]).y }))
    .filter(({ y }) => y > LABEL_MARGIN_PX && y < clientHeight - LABEL_MARGIN_PX)
    .map(({ line, y }) => label("grid-label-north", `top:${y}px`, direction(line.m, "N", "S")));
  return [...east, ...up];
}

function label(className: string, position: string, text: string): HTMLElement {
  const element = document.createElement("span");
  element.className = `grid-label ${className}`;
  element.style.cssText = position;
  element.textContent = text;
  return element;
}

function direction(m: number, positive: string, negative: string): string {
  if (m === 0) return "0";
  return `${distance(Math.abs(m))} ${m > 0 ? positive : negative}`;
}

function distance(m: number): string {
  return m >= 1000 ? `${m / 1000} km` : `${m} m`;
}
