import { type Accessor, createSignal } from "solid-js";

/** The selected theme: `auto` follows the computer, `sun` has high contrast for bright sun. */
export type Theme = "auto" | "light" | "dark" | "sun";

const THEMES: readonly Theme[] = ["auto", "light", "dark", "sun"];
const STORED_AS = "recon.theme";

export interface ThemeSwitch {
  readonly theme: Accessor<Theme>;
  /** Incremented whenever colours change, by the operator or by the computer. */
  readonly changes: Accessor<number>;
  choose(theme: Theme): void;
  /** High contrast for bright sun, or back to what was before. */
  toggleSun(): void;
}

/** Sets the page's colours in `<html data-theme>` and stores the theme in this browser. */
export function createThemeSwitch(page: Document, storage: Storage): ThemeSwitch {
  const darkness = page.defaultView?.matchMedia("(prefers-color-scheme: dark)");
  const stored = THEMES.find((theme) => theme === storage.getItem(STORED_AS)) ?? "auto";
  const [theme, setTheme] = createSignal<Theme>(stored);
  const [changes, setChanges] = createSignal(0);
  let before: Theme = stored === "sun" ? "auto" : stored;
  const show = () => {
    const computers = darkness?.matches === true ? "dark" : "light";
    page.documentElement.dataset["theme"] = theme() === "auto" ? computers : theme();
    setChanges((count) => count + 1);
  };
  const choose = (next: Theme) => {
    if (theme() !== "sun") before = theme();
    storage.setItem(STORED_AS, next);
    setTheme(next);
    show();
  };
  show();
  darkness?.addEventListener("change", show);
  return {
    theme,
    changes,
    choose,
    toggleSun: () => choose(theme() === "sun" ? before : "sun"),
  };
}

/**
 * Identities differ by colour and shape: eight colours that stay apart for colour-blind eyes, in two shapes;
 * then the same sixteen with a stripe. The number is always beside them.
 */
export const VEHICLE_COLOURS = 8;
export const VEHICLE_LOOKS = 4 * VEHICLE_COLOURS;

export type VehicleShape = "round" | "square";

/** How a vehicle's symbol looks, fixed by its number. */
export interface VehicleLook {
  /** 1 to `VEHICLE_COLOURS`; 0 (grey) without a number. */
  readonly colour: number;
  readonly shape: VehicleShape;
  readonly isStriped: boolean;
}

export function vehicleLook(number: number): VehicleLook {
  if (number <= 0) return { colour: 0, shape: "round", isStriped: false };
  const turn = Math.floor((number - 1) / VEHICLE_COLOURS);
  return {
    colour: ((number - 1) % VEHICLE_COLOURS) + 1,
    shape: turn % 2 === 0 ? "round" : "square",
    isStriped: turn % 4 >= 2,
  };
}

/** CSS variable with a vehicle's colour, fixed by its number; grey without a number. */
export function colourVariable(number: number): string {
  const { colour } = vehicleLook(number);
  return colour === 0 ? "--stale" : `--vehicle-${colour}`;
}

/** A vehicle's colour as a CSS value. */
export function colourOf(number: number): string {
  return `var(${colourVariable(number)})`;
}

/** CSS classes for a vehicle's shape and stripe. */
export function lookClasses(number: number): string {
  const { shape, isStriped } = vehicleLook(number);
  return `look-${shape}${isStriped ? " look-striped" : ""}`;
}
