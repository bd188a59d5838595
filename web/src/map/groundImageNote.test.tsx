import { afterEach, describe, expect, it } from "vitest";
import { useStation } from "../console";
import type { StationState } from "../protocol";
import { groundImage } from "../testing/fakeField";
import { station, vehicle } from "../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../testing/renderPage";
import { GroundImageNote } from "./GroundImageNote";
import { createDisplayedGround, type DisplayedGround } from "./groundImageLayer";

/** The state at `second` that announces this frame; frame n is captured at second n. */
function announcing(frame_id: number, second: number): StationState {
  const ground_image = groundImage({ frame_id, captured_age_s: second - frame_id });
  return station([vehicle(1)], { time_ns: second * 1e9, ground_image });
}

let page: RenderedPage;
let ground: DisplayedGround;
const note = () => find(page.root, ".map-note");
const text = () => note().textContent;
const isOld = () => note().classList.contains("is-old");

function Note() {
  ground = createDisplayedGround(useStation().source);
  return <GroundImageNote shown={ground.shown()} />;
}

afterEach(() => page.dispose());

describe("the note on the ground image", () => {
  it("is marked old after 5 s", () => {
    page = renderPage(Note, announcing(12, 12.8));
    ground.show(groundImage({ frame_id: 12, captured_age_s: 0.8 }));
    expect(text()).toBe("Ground image: frame 12, taken 0.8 s ago ± 0.2 s, not aligned");
    page.age(4.1);
    expect(isOld()).toBe(false);
    page.age(4.3);
    expect(isOld()).toBe(true);
    expect(text()).toMatch(/^old Ground image: frame 12, taken 5\.1 s ago/);
  });

  it("states how well a frame is aligned, and that alignment was lost", () => {
    page = renderPage(Note, announcing(12, 12.8));
    ground.show(
      groundImage({
        frame_id: 12,
        captured_age_s: 0.8,
        registration: "registered",
        registration_residual_m: 0.14,
      }),
    );
    expect(text()).toMatch(/, aligned to 0\.1\u00a0m$/);
    ground.show(groundImage({ frame_id: 12, captured_age_s: 0.8, registration: "lost" }));
    expect(text()).toMatch(/, alignment lost: positions may be off by metres$/);
    expect(find(page.root, ".tone-warning").textContent).toMatch(/^alignment lost/);
  });

  it("describes the displayed frame until a newer picture has loaded", () => {
    page = renderPage(Note, announcing(12, 12.8));
    ground.show(groundImage({ frame_id: 12, captured_age_s: 0.8 }));
    page.receive(announcing(13, 13.8));
    expect(text()).toBe("Ground image: frame 12, taken 1.8 s ago ± 0.2 s, not aligned");
    page.receive(announcing(15, 15.9));
    expect(text()).toBe(
      "Ground image: frame 12, taken 3.9 s ago ± 0.2 s, not aligned; a newer frame exists",
    );
    page.receive(announcing(17, 17.8));
    expect(isOld()).toBe(true);
    ground.show(groundImage({ frame_id: 17, captured_age_s: 0.8 }));
    expect(text()).toBe("Ground image: frame 17, taken 0.8 s ago ± 0.2 s, not aligned");
    expect(isOld()).toBe(false);
  });

  it("reports a missing or loading image", () => {
    page = renderPage(Note, station([vehicle(1)], { time_ns: 12e9 }));
    expect(text()).toBe("No ground image yet");
    page.receive(announcing(12, 12.8));
    expect(text()).toBe("Loading ground image");
  });
});
