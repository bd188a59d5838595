import { type Accessor, createEffect, createSignal, on, Show } from "solid-js";
import type { SunAtView } from "../protocol";
import type { LightRequests } from "../source/lightRequests";
import { text } from "../text/catalogue";
import { formatAge, formatFraction } from "../text/quantities";
import type { LonLat } from "./localGrid";
import type { Overlay } from "./overlays";

/** Chances below this are not worth a word. */
const LEAST_CHANCE = 0.1;

/** The light at the place last pointed at on the map, and when it changes. */
export interface SunHere {
  readonly answer: Accessor<SunAtView | null>;
  /** A place; null when the pointer has left the map. */
  point(at: LonLat | null): void;
}

/** Asks for the place pointed at, and again with each new shade map; one request at a time. */
export function createSunHere(
  light: Pick<LightRequests, "sunAt">,
  overlay: Overlay,
  mapNumber: Accessor<number | null>,
): SunHere {
  const [place, point] = createSignal<LonLat | null>(null);
  const [answer, setAnswer] = createSignal<SunAtView | null>(null);
  const wanted = () => (isOverLight(overlay) && mapNumber() !== null ? place() : null);
  let isAsking = false;
  let isStale = false;

  const ask = async () => {
    if (isAsking) {
      isStale = true;
      return;
    }
    isAsking = true;
    do {
      isStale = false;
      const at = wanted();
      const outcome = at === null ? null : await light.sunAt(at.lat, at.lon);
      // A failed request leaves nothing: an old answer would pass for a new one.
      setAnswer(outcome?.kind === "answered" && wanted() !== null ? outcome.value : null);
    } while (isStale);
    isAsking = false;
  };
  createEffect(on([wanted, mapNumber], () => void ask(), { defer: true }));
  return { answer, point };
}

function isOverLight(overlay: Overlay): boolean {
  return overlay.kind() === "shade" || overlay.kind() === "forecast";
}

/** As `in sun; shade in about 40 s (30 s to 55 s)`. */
export function sunHereText(view: SunAtView): string {
  const { unknown, inSun, inShade, shadeIn, sunIn, noShade, noSun, maybeShade, maybeSun } =
    text.sunHere;
  if (view.light === "unknown") return unknown;
  const isSunny = view.light === "sun";
  const { change_after_s, change_early_s, change_late_s, change_chance, known_ahead_s } = view;
  if (change_after_s !== null) {
    const [early, late] = [formatSeconds(change_early_s), formatSeconds(change_late_s)];
    return (isSunny ? shadeIn : sunIn)(formatSeconds(change_after_s), early, late);
  }
  if (known_ahead_s <= 0) return isSunny ? inSun : inShade;
  const ahead = formatSeconds(known_ahead_s);
  if (change_chance < LEAST_CHANCE) return (isSunny ? noShade : noSun)(ahead);
  return (isSunny ? maybeShade : maybeSun)(formatFraction(change_chance), ahead);
}

/** Forecasts are no finer than seconds. */
function formatSeconds(seconds: number | null): string {
  return seconds === null || seconds >= 10 ? formatAge(seconds) : text.sunHere.soon;
}

/** The answer in words, beside the ground image's note. */
export function SunHereNote(props: { readonly here: SunHere }) {
  return (
    <Show when={props.here.answer()}>
      {(view) => (
        <p class="map-note" role="status">
          {text.sunHere.here(sunHereText(view()))}
        </p>
      )}
    </Show>
  );
}
