import { type Accessor, createSignal } from "solid-js";

/** The look the operator chose: as the computer says (light or dark), or made for bright sun. */
export type Theme = "auto" | "sun";

const STORED_AS = "recon.theme";

export interface ThemeSwitch {
  readonly theme: Accessor<Theme>;
  /** Grows whenever colours changed, by the operator or by the computer. */
  readonly changes: Accessor<number>;
  toggle(): void;
}

/** Keeps the page's theme in `<html data-theme>` and remembers it in this browser. */
export function createThemeSwitch(page: Document, storage: Storage): ThemeSwitch {
  const stored = storage.getItem(STORED_AS) === "sun" ? "sun" : "auto";
  const [theme, setTheme] = createSignal<Theme>(stored);
  const [changes, setChanges] = createSignal(0);
  const show = (next: Theme) => {
    setTheme(next);
    page.documentElement.dataset["theme"] = next;
    setChanges((count) => count + 1);
  };
  show(stored);
  page.defaultView
    ?.matchMedia("(prefers-color-scheme: dark)")
    .addEventListener("change", () => setChanges((count) => count + 1));
  return {
    theme,
    changes,
    toggle: () => {
      const next = theme() === "sun" ? "auto" : "sun";
      storage.setItem(STORED_AS, next);
      show(next);
    },
  };
}

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
