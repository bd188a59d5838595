import { type Accessor, createSignal } from "solid-js";

/** The panels that open over the map, in the order in which they stand. */
export const PANEL_NAMES = [
  "vehicle",
  "alarms",
  "survey",
  "cameras",
  "sun",
  "zones",
  "site",
  "vehicles",
  "calibration",
  "return",
  "orders",
  "timeline",
  "links",
  "photos",
  "flights",
  "station",
] as const;

export type PanelName = (typeof PANEL_NAMES)[number];

const STORED_AS = "recon.panels";
const FIRST: readonly PanelName[] = ["survey"];

/** Which panels are open; kept in this browser. */
export interface OpenPanels {
  readonly names: Accessor<readonly PanelName[]>;
  isOpen(name: PanelName): boolean;
  toggle(name: PanelName): void;
  open(name: PanelName): void;
  close(name: PanelName): void;
}

/** `isNarrow` tells whether the screen has room for one panel only, as a phone's. */
export function createOpenPanels(
  storage: Pick<Storage, "getItem" | "setItem">,
  isNarrow: () => boolean,
): OpenPanels {
  const stored = storage.getItem(STORED_AS)?.split(",") ?? FIRST;
  const known = isNarrow() ? [] : PANEL_NAMES.filter((name) => stored.includes(name));
  const [names, setNames] = createSignal<readonly PanelName[]>(known);
  const isOpen = (name: PanelName) => names().includes(name);
  const set = (next: readonly PanelName[]) => {
    setNames(next);
    storage.setItem(STORED_AS, next.join(","));
  };
  const close = (name: PanelName) => set(names().filter((other) => other !== name));
  const open = (name: PanelName) => {
    if (!isOpen(name)) set(isNarrow() ? [name] : [...names(), name]);
  };
  return {
    names,
    isOpen,
    open,
    close,
    toggle: (name) => (isOpen(name) ? close(name) : open(name)),
  };
}

/** Narrower than this the page is a phone's. */
export const NARROW = "(max-width: 699px)";
