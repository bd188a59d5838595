/** The name under which this page holds steered orders: one for each connection, never used again. */

/** Random bytes in a name: nobody guesses another page's. */
const BYTES = 16;

/** The page says that it lives at most so often; the station gives up after 2 s of silence. */
export const BEAT_MS = 400;

/** A new name, 32 hexadecimal digits. */
export function newOwner(random: (bytes: Uint8Array) => Uint8Array): string {
  const bytes = random(new Uint8Array(BYTES));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}
