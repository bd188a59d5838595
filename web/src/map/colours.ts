import { colourVariable, VEHICLE_COLOURS } from "../theme/theme";

/** The theme's colours used on the map. */
export interface Colours {
  readonly ground: string;
  readonly grid: string;
  readonly gridAxis: string;
  readonly casing: string;
  readonly text: string;
  readonly stale: string;
  readonly critical: string;
  readonly boundary: string;
  readonly keepOut: string;
  readonly heightZone: string;
  readonly temporaryZone: string;
  readonly survey: string;
  /** How much of a base map is left by the theme: opacity 0 to 1, saturation -1 to 1. */
  readonly baseMapOpacity: number;
  readonly baseMapSaturation: number;
  vehicle(number: number): string;
}

/** Reads the theme from the page's style sheet. */
export function readColours(page: Document): Colours {
  const style = getComputedStyle(page.documentElement);
  const read = (name: string) => style.getPropertyValue(name).trim();
  const vehicles = Array.from({ length: VEHICLE_COLOURS }, (_, index) =>
    read(colourVariable(index + 1)),
  );
  const stale = read("--stale");
  return {
    ground: read("--ground"),
    grid: read("--grid"),
    gridAxis: read("--grid-axis"),
    casing: read("--casing"),
    text: read("--text"),
    critical: read("--critical"),
    boundary: read("--boundary"),
    keepOut: read("--keep-out"),
    heightZone: read("--height-zone"),
    temporaryZone: read("--temporary-zone"),
    survey: read("--survey"),
    baseMapOpacity: Number(read("--base-map-opacity")),
    baseMapSaturation: Number(read("--base-map-saturation")),
    stale,
    vehicle: (number) => vehicles[(number - 1) % VEHICLE_COLOURS] ?? stale,
  };
}
