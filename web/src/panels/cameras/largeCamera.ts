import { type Accessor, createSignal } from "solid-js";

/** The camera whose picture is large. */
export interface LargeCamera {
  /** Of its vehicle; null when none is large. */
  readonly serial: Accessor<string | null>;
  /** Enlarges a vehicle's picture; of the one that is large, and of null, makes it small again. */
  toggle(serial: string | null): void;
  /** Makes it small; false when none was large. */
  clear(): boolean;
}

export function createLargeCamera(): LargeCamera {
  const [serial, setSerial] = createSignal<string | null>(null);
  return {
    serial,
    toggle: (next) => setSerial((now) => (now === next ? null : next)),
    clear: () => {
      const wasLarge = serial() !== null;
      setSerial(null);
      return wasLarge;
    },
  };
}
