import { type Accessor, createSignal } from "solid-js";

/** The selected theme: `auto` follows the computer (light or dark), `sun` has high contrast for bright sun. */
export type Theme = "auto" | "sun";

const STORED_AS = "recon.theme";

export interface ThemeSwitch {
  readonly theme: Accessor<Theme>;
  /** Incremented whenever colours change, by the operator or by the computer. */
  readonly changes: Accessor<number>;
  toggle(): void;
}

/** Sets the page's theme in `<html data-theme>` and stores it in this browser. */
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

/** Number of vehicle colours; vehicles that share one differ by the number beside it. */
export const VEHICLE_COLOURS = 8;

/** CSS variable with a vehicle's colour, fixed by its number; grey without a number. */
export function colourVariable(number: number): string {
  if (number <= 0) return "--stale";
  return `--vehicle-${((number - 1) % VEHICLE_COLOURS) + 1}`;
}

/** A vehicle's colour as a CSS value. */
export function colourOf(number: number): string {
  return `var(${colourVariable(number)})`;
}
