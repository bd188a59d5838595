import type { Map as MapLibre } from "maplibre-gl";
import { text } from "../text/catalogue";
import { colourOf, lookClasses } from "../theme/theme";
import type { Frame } from "./labels";
import { isInSight, type Uncovered } from "./uncovered";

/** A vehicle's place on the screen, and how it is named. */
export interface NamedSpot {
  readonly key: number;
  readonly x_px: number;
  readonly y_px: number;
  readonly badge: string;
  readonly name: string;
}

/** Vehicles out of sight in one direction, and where at the edge of the free map they are marked. */
export interface EdgeMark {
  readonly spots: readonly NamedSpot[];
  readonly x_px: number;
  readonly y_px: number;
  /** Clockwise from up. */
  readonly towards_deg: number;
}

/** As large as a finger; nearer marks are one. */
const MARK_PX = 44;
/** A symbol is in sight while its middle is. */
const MIDDLE_PX = 4;

/** Marks for the vehicles beyond the map's edge or under a panel; none where there is hardly a map. */
export function edgeMarksOf(spots: readonly NamedSpot[], seen: Uncovered): EdgeMark[] {
  const inner = inset(seen.room, MARK_PX / 2);
  if (inner.right - inner.left < 2 * MARK_PX || inner.bottom - inner.top < 2 * MARK_PX) return [];
  const marks: EdgeMark[] = [];
  for (const spot of spots) {
    if (isInSight(inset(atPoint(spot), -MIDDLE_PX), seen)) continue;
    // At the window's edge, or beside the panel that stands there.
    const frames = [inset(seen.window, MARK_PX / 2), inner];
    const mark = frames
      .map((frame) => markOf(spot, frame))
      .find((place) => isInSight(inset(atPoint(place), 1 - MARK_PX / 2), seen));
    if (mark === undefined) continue;
    const near = marks.findIndex(
      ({ x_px, y_px }) => Math.hypot(x_px - mark.x_px, y_px - mark.y_px) < MARK_PX,
    );
    const other = marks[near];
    if (other === undefined) marks.push(mark);
    else marks[near] = { ...other, spots: [...other.spots, spot] };
  }
  return marks;
}

function atPoint({ x_px, y_px }: Pick<NamedSpot, "x_px" | "y_px">): Frame {
  return { left: x_px, right: x_px, top: y_px, bottom: y_px };
}

function inset({ left, top, right, bottom }: Frame, by_px: number): Frame {
  return { left: left + by_px, top: top + by_px, right: right - by_px, bottom: bottom - by_px };
}

/** Where the line from the middle to the vehicle leaves the frame; inside it, the nearest edge is taken. */
function markOf(spot: NamedSpot, { left, top, right, bottom }: Frame): EdgeMark {
  const [x, y] = [(left + right) / 2, (top + bottom) / 2];
  const [east, south] = [spot.x_px - x || 1e-9, spot.y_px - y || 1e-9];
  const share = Math.min((right - x) / Math.abs(east), (bottom - y) / Math.abs(south));
  return {
    spots: [spot],
    x_px: x + share * east,
    y_px: y + share * south,
    towards_deg: (Math.atan2(east, -south) * 180) / Math.PI,
  };
}

/** The marks as buttons; a press moves the map to the vehicles. */
export class EdgeMarkers {
  private readonly buttons: HTMLButtonElement[] = [];
  private marks: readonly EdgeMark[] = [];

  constructor(private readonly map: MapLibre) {}

  show(marks: readonly EdgeMark[]): void {
    this.marks = marks;
    while (this.buttons.length > marks.length) this.buttons.pop()?.remove();
    for (const [index, mark] of marks.entries()) this.draw(this.buttonAt(index), mark);
  }

  private draw(button: HTMLButtonElement, { spots, x_px, y_px, towards_deg }: EdgeMark): void {
    const [first, ...others] = spots;
    if (first === undefined) return;
    const label = others.length === 0 ? first.badge : text.map.manyOut(spots.length);
    if (button.textContent !== label) button.textContent = label;
    const look = others.length === 0 ? ` own-colour ${lookClasses(first.key)}` : "";
    button.className = `edge-mark${look}`;
    button.style.setProperty("--own", colourOf(first.key));
    button.style.setProperty("--towards", `${Math.round(towards_deg)}deg`);
    const half_px = MARK_PX / 2;
    const place = `translate(${Math.round(x_px - half_px)}px, ${Math.round(y_px - half_px)}px)`;
    if (button.style.transform !== place) button.style.transform = place;
    const name = text.map.outOfSight(spots.map((spot) => spot.name));
    if (button.ariaLabel !== name) button.ariaLabel = name;
    button.title = name;
  }

  private buttonAt(index: number): HTMLButtonElement {
    const known = this.buttons[index];
    if (known !== undefined) return known;
    const button = document.createElement("button");
    button.type = "button";
    button.addEventListener("click", (event) => {
      event.stopPropagation();
      const spots = this.marks[index]?.spots ?? [];
      const mean = (of: (spot: NamedSpot) => number) =>
        spots.reduce((sum, spot) => sum + of(spot), 0) / spots.length;
      const middle: [number, number] = [mean(({ x_px }) => x_px), mean(({ y_px }) => y_px)];
      if (spots.length > 0)
        this.map.panTo(this.map.unproject(middle), {}, { originalEvent: event });
    });
    this.buttons[index] = button;
    this.map.getCanvasContainer().append(button);
    return button;
  }
}
