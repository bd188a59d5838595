/** How many colours there are; the number beside each tells vehicles of one colour apart. */
export const VEHICLE_COLOURS = 8;

/** The CSS variable with a vehicle's colour: always the same for the same number. */
export function colourVariable(number: number): string {
  const index = (((number - 1) % VEHICLE_COLOURS) + VEHICLE_COLOURS) % VEHICLE_COLOURS;
  return `--vehicle-${index + 1}`;
}

/** The same as a CSS value. */
export function colourOf(number: number): string {
  return `var(${colourVariable(number)})`;
}
