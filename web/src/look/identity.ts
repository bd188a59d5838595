/** How many colours there are; the number beside each tells vehicles of one colour apart. */
export const VEHICLE_COLOURS = 8;

/** The CSS variable with a vehicle's colour: always the same for the same number, grey without one. */
export function colourVariable(number: number): string {
  if (number <= 0) return "--stale";
  return `--vehicle-${((number - 1) % VEHICLE_COLOURS) + 1}`;
}

/** The same as a CSS value. */
export function colourOf(number: number): string {
  return `var(${colourVariable(number)})`;
}
