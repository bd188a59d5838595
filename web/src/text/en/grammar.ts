/** A count with its noun: `1 drone`, `20 drones`. */
export function plural(count: number, noun: string): string {
  return `${count} ${noun}${count === 1 ? "" : "s"}`;
}

/** Names as a list in a sentence: `a`, `a and b`, `a, b and c`. */
export function listNames(names: readonly string[]): string {
  if (names.length <= 1) return names.join("");
  return `${names.slice(0, -1).join(", ")} and ${names.at(-1)}`;
}

/** At most `most` names, then how many more. */
export function listSome(names: readonly string[], most: number): string {
  if (names.length <= most) return listNames(names);
  return `${names.slice(0, most).join(", ")} and ${names.length - most} more`;
}
