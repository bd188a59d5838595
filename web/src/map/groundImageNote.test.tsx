import { afterEach, describe, expect, it } from "vitest";
import { useConsole } from "../console";
import type { GroundImageView, StationState } from "../protocol";
import { at, station, vehicle } from "../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../testing/renderPage";
import { GroundImageNote } from "./GroundImageNote";
import { createGroundOnMap, type GroundOnMap } from "./groundImageLayer";

function image(frame_id: number, captured_age_s: number): GroundImageView {
  return {
    frame_id,
    serial: "SN-001",
    captured_age_s,
    captured_sigma_s: 0.2,
    registration: "unregistered",
    reference: "telemetry at the marked frame",
    corners: [at(-10, 10), at(10, 10), at(10, -10), at(-10, -10)],
    cell_m: 0.5,
    rows: 40,
    cols: 40,
  };
}

/** The state of a moment that announces this frame, taken at the second of its number. */
function announcing(frame_id: number, second: number): StationState {
  const ground_image = image(frame_id, second - frame_id);
  return station([vehicle(1)], { time_ns: second * 1e9, ground_image });
}

let page: RenderedPage;
let ground: GroundOnMap;
const note = () => find(page.root, ".map-note");
const text = () => note().textContent;
const isOld = () => note().classList.contains("is-old");

function Part() {
  ground = createGroundOnMap(useConsole().source);
  return <GroundImageNote shown={ground.shown()} />;
}

afterEach(() => page.dispose());

describe("the note on the ground image", () => {
  it("looks old, and says so, from 5 s on", () => {
    page = renderPage(Part, announcing(12, 12.8));
    ground.show(image(12, 0.8));
    expect(text()).toBe("Ground image: frame 12, taken 0.8 s ago ± 0.2 s, unregistered");
    page.age(4.1);
    expect(isOld()).toBe(false);
    page.age(4.3);
    expect(isOld()).toBe(true);
    expect(text()).toMatch(/^old Ground image: frame 12, taken 5\.1 s ago/);
  });

  it("is the shown frame's for as long as no newer picture comes", () => {
    page = renderPage(Part, announcing(12, 12.8));
    ground.show(image(12, 0.8));
    page.say(announcing(13, 13.8));
    expect(text()).toBe("Ground image: frame 12, taken 1.8 s ago ± 0.2 s, unregistered");
    page.say(announcing(15, 15.9));
    expect(text()).toBe(
      "Ground image: frame 12, taken 3.9 s ago ± 0.2 s, unregistered, newer not loaded",
    );
    page.say(announcing(17, 17.8));
    expect(isOld()).toBe(true);
    ground.show(image(17, 0.8));
    expect(text()).toBe("Ground image: frame 17, taken 0.8 s ago ± 0.2 s, unregistered");
    expect(isOld()).toBe(false);
  });

  it("says that there is none, or none yet", () => {
    page = renderPage(Part, station([vehicle(1)], { time_ns: 12e9 }));
    expect(text()).toBe("No ground image yet");
    page.say(announcing(12, 12.8));
    expect(text()).toBe("Ground image on its way");
  });
});
