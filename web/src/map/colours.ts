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
    stale,
    vehicle: (number) => vehicles[(number - 1) % VEHICLE_COLOURS] ?? stale,
  };
}
