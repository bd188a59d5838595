import type { Map as MapLibre } from "maplibre-gl";
import type { Colours } from "./colours";
import type { Point } from "./features";
import { looksOf, movingShapes, type Shape } from "./movingShapes";
import type { Layer, Scene } from "./scene";

/** The ends of moving lines are this old at most: at 5 m/s the symbol hides them, or nearly so. */
const REDRAW_S = 0.5;
/** Points of a track nearer than this on the screen are excluded. */
const LEAST_STEP_PX = 2;
/** MapLibre's world at zoom 0. */
const WORLD_PX = 512;

/**
 * What moves with the vehicles, on a canvas between the map and the symbols. On the map itself each change of it would
 * draw the whole map again, for which a browser without a GPU takes longer than the time between two states. Drawn
 * twice a second, at once when the looks change, and with each motion of the map.
 */
export class MovingLayer implements Layer {
  private map: MapLibre | null = null;
  private pen: CanvasRenderingContext2D | null = null;
  private colours: Colours | null = null;
  private scene: Scene | null = null;
  private looks = "";
  private drawnAt_s = Number.NEGATIVE_INFINITY;

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    this.colours = colours;
    const canvas = document.createElement("canvas");
    canvas.className = "map-moving";
    canvas.setAttribute("aria-hidden", "true");
    map.getCanvas().after(canvas);
    // Drawn by the processor: without a GPU lines are much slower through WebGL.
    this.pen = canvas.getContext("2d", { willReadFrequently: true });
    map.on("move", () => this.draw());
    map.on("resize", () => this.draw());
  }

  update(scene: Scene): void {
    this.scene = scene;
    const now_s = scene.state.time_ns / 1e9 + scene.behindS;
    const looks = looksOf(scene);
    if (looks === this.looks && Math.abs(now_s - this.drawnAt_s) < REDRAW_S) return;
    this.looks = looks;
    this.drawnAt_s = now_s;
    this.draw();
  }

  recolour(colours: Colours): void {
    this.colours = colours;
    this.draw();
  }

  private draw(): void {
    const { map, pen, colours, scene } = this;
    if (map === null || pen === null || colours === null || scene === null) return;
    const { clientWidth: width, clientHeight: height } = map.getContainer();
    const ratio = devicePixelRatio;
    fitCanvas(pen.canvas, Math.round(width * ratio), Math.round(height * ratio));
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    const place = placeOnScreen(map);
    for (const shape of movingShapes(scene, colours)) drawShape(pen, shape, place);
  }
}

/** Setting a canvas's size clears it, and allocates it anew. */
function fitCanvas(canvas: HTMLCanvasElement, width: number, height: number): void {
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
}

/** A function from places to pixels of the map, which is never turned or tilted; tracks have too many for `project`. */
export function placeOnScreen(map: Pick<MapLibre, "getCenter" | "getZoom" | "project">) {
  const centre = map.getCenter();
  const { x, y } = map.project(centre);
  const world_px = WORLD_PX * 2 ** map.getZoom();
  const middle = mercatorY(centre.lat);
  return ([lon, lat]: Point): Point => {
    const turns = (lon - centre.lng) / 360;
    return [
      // Beside the date line the nearer of its places.
      x + (turns - Math.round(turns)) * world_px,
      y + (mercatorY(lat) - middle) * world_px,
    ];
  };
}

/** Web Mercator, 0 (north) to 1. */
function mercatorY(lat: number): number {
  return (1 - Math.asinh(Math.tan((lat * Math.PI) / 180)) / Math.PI) / 2;
}

function drawShape(
  pen: CanvasRenderingContext2D,
  { points, colour, opacity, width_px, dash_px }: Shape,
  place: (at: Point) => Point,
): void {
  pen.beginPath();
  for (const [index, [x, y]] of thinned(points.map(place)).entries()) {
    if (index === 0) pen.moveTo(x, y);
    else pen.lineTo(x, y);
  }
  pen.globalAlpha = opacity;
  if (width_px === null) {
    pen.fillStyle = colour;
    pen.fill();
  } else {
    pen.strokeStyle = colour;
    pen.lineWidth = width_px;
    pen.lineJoin = "round";
    pen.setLineDash([...dash_px]);
    pen.stroke();
  }
}

/** Without points that would not be seen; the last one stays. */
export function thinned(points: readonly Point[]): Point[] {
  const kept: Point[] = [];
  for (const [index, point] of points.entries()) {
    const before = kept.at(-1);
    const isFar =
      before === undefined ||
      Math.hypot(point[0] - before[0], point[1] - before[1]) >= LEAST_STEP_PX;
    if (isFar || index === points.length - 1) kept.push(point);
  }
  return kept;
}
