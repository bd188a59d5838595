import { afterEach, describe, expect, it } from "vitest";
import { find, type RenderedPage, renderPage } from "../testing/renderPage";
import { at, station, vehicle } from "../testing/world";
import { GroundImageNote } from "./GroundImageNote";

const TAKEN = station([vehicle(1)], {
  ground_image: {
    frame_id: 12,
    serial: "SN-001",
    captured_age_s: 0.8,
    captured_sigma_s: 0.2,
    registration: "unregistered",
    reference: "telemetry at the marked frame",
    corners: [at(-10, 10), at(10, 10), at(10, -10), at(-10, -10)],
    cell_m: 0.5,
    rows: 40,
    cols: 40,
  },
});

let page: RenderedPage;
const note = () => find(page.root, ".map-note");

afterEach(() => page.dispose());

describe("the note on the ground image", () => {
  it("looks old, and says so, from 5 s on", () => {
    page = renderPage(GroundImageNote, TAKEN);
    expect(note().textContent).toBe(
      "Ground image: frame 12, taken 0.8 s ago ± 0.2 s, unregistered",
    );
    page.age(4.1);
    expect(note().classList.contains("is-old")).toBe(false);
    page.age(4.3);
    expect(note().classList.contains("is-old")).toBe(true);
    expect(note().textContent).toMatch(/^old Ground image: frame 12, taken 5\.1 s ago/);
  });

  it("looks fresh again with a fresh frame", () => {
    page = renderPage(GroundImageNote, TAKEN);
    page.age(9);
    expect(note().classList.contains("is-old")).toBe(true);
    page.age(0);
    page.say(TAKEN);
    expect(note().classList.contains("is-old")).toBe(false);
    expect(note().textContent).not.toContain("old");
  });

  it("says that there is none", () => {
    page = renderPage(GroundImageNote, station([vehicle(1)]));
    expect(note().textContent).toBe("No ground image yet");
  });
});
