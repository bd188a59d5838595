import { type Accessor, createSignal } from "solid-js";

const STORED_AS = "recon.muted";
/** Stored in place of a kind when all are muted. */
const ALL = "*";

/** Which kinds of alarms make no sound; kept in this browser. A kind is a rule of the station, `separation`. */
export interface Mutes {
  readonly isAllMuted: Accessor<boolean>;
  /** The kinds that are muted of their own, also while all are. */
  readonly kinds: Accessor<readonly string[]>;
  isMuted(kind: string): boolean;
  mute(kind: string, isMuted: boolean): void;
  muteAll(isMuted: boolean): void;
}

export function createMutes(storage: Pick<Storage, "getItem" | "setItem">): Mutes {
  const stored = (storage.getItem(STORED_AS) ?? "").split(",").filter((kind) => kind !== "");
  const [muted, setMuted] = createSignal<readonly string[]>(stored);
  const set = (kind: string, isMuted: boolean) => {
    const others = muted().filter((other) => other !== kind);
    setMuted(isMuted ? [...others, kind] : others);
    storage.setItem(STORED_AS, muted().join(","));
  };
  const isAllMuted = () => muted().includes(ALL);
  return {
    isAllMuted,
    kinds: () => muted().filter((kind) => kind !== ALL),
    isMuted: (kind) => isAllMuted() || muted().includes(kind),
    mute: set,
    muteAll: (isMuted) => set(ALL, isMuted),
  };
}
