import { createRoot, createSignal } from "solid-js";
import { describe, expect, it, vi } from "vitest";
import type { Outcome, SunAtView } from "../protocol";
import { createOverlay } from "./overlays";
import { createSunHere, sunHereText } from "./SunHere";

function view(changes: Partial<SunAtView> = {}): SunAtView {
  return {
    number: 1,
    light: "sun",
    known_ahead_s: 50,
    change_chance: 0,
    change_after_s: null,
    change_early_s: null,
    change_late_s: null,
    ...changes,
  };
}

describe("the light at a place in words", () => {
  const coming = { change_chance: 1, change_after_s: 42, change_early_s: 31, change_late_s: 58 };
  it.each([
    [view(coming), "in sun; shade in about 42 s (31 s to 58 s)"],
    [view({ ...coming, light: "shade" }), "in shade; sun in about 42 s (31 s to 58 s)"],
    [
      view({ ...coming, change_early_s: 3 }),
      "in sun; shade in about 42 s (less than 10 s to 58 s)",
    ],
    [view(), "in sun; no shade within 50 s"],
    [view({ change_chance: 0.3 }), "in sun; shade with 30\u00a0% within 50 s"],
    [view({ light: "shade", known_ahead_s: 0 }), "in shade"],
    [view({ light: "unknown", known_ahead_s: 0 }), "light unknown"],
  ])("%#", (answer, text) => {
    expect(sunHereText(answer)).toBe(text);
  });
});

const done = (value: SunAtView): Outcome<SunAtView> => ({ kind: "answered", value });

/** A source that answers when asked to. */
function asked() {
  const waiting: ((outcome: Outcome<SunAtView>) => void)[] = [];
  const sunAt = vi.fn(
    () => new Promise<Outcome<SunAtView>>((resolve) => void waiting.push(resolve)),
  );
  const settle = async (outcome: Outcome<SunAtView>) => {
    waiting.shift()?.(outcome);
    await Promise.resolve();
    await Promise.resolve();
  };
  return { source: { sunAt }, sunAt, settle };
}

describe("the light where the pointer is", () => {
  const here = { lon: -93.6, lat: 41.9 };
  const there = { lon: -93.5, lat: 41.9 };

  function started(kind: "none" | "shade") {
    const overlay = createOverlay();
    overlay.show(kind);
    const [number, setNumber] = createSignal<number | null>(1);
    const calls = asked();
    const sunHere = createRoot(() => createSunHere(calls.source, overlay, number));
    return { ...calls, sunHere, overlay, setNumber };
  }

  it("is asked for once at a time, and then for the newest place", async () => {
    const { sunHere, sunAt, settle } = started("shade");
    await Promise.resolve();
    sunHere.point(here);
    sunHere.point(there);
    sunHere.point(here);
    sunHere.point(there);
    expect(sunAt.mock.calls).toEqual([[41.9, -93.6]]);
    await settle(done(view()));
    expect(sunAt.mock.calls.slice(1)).toEqual([[41.9, -93.5]]);
    await settle(done(view({ light: "shade" })));
    expect(sunHere.answer()?.light).toBe("shade");
    expect(sunAt).toHaveBeenCalledTimes(2);
  });

  it("is asked for again with a new map, and nothing is left of a failure", async () => {
    const { sunHere, sunAt, settle, setNumber } = started("shade");
    await Promise.resolve();
    sunHere.point(here);
    await settle(done(view()));
    expect(sunHere.answer()).not.toBeNull();
    setNumber(2);
    expect(sunAt).toHaveBeenCalledTimes(2);
    await settle({ kind: "failed", problem: "late" });
    expect(sunHere.answer()).toBeNull();
  });

  it("is asked for only over shade or forecast, and gone with the pointer", async () => {
    const { sunHere, sunAt, settle, overlay } = started("none");
    await Promise.resolve();
    sunHere.point(here);
    await Promise.resolve();
    expect(sunAt).not.toHaveBeenCalled();
    overlay.show("forecast");
    await settle(done(view()));
    expect(sunHere.answer()).not.toBeNull();
    sunHere.point(null);
    await Promise.resolve();
    expect(sunHere.answer()).toBeNull();
  });
});
