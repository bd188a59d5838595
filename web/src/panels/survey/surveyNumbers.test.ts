import { describe, expect, it } from "vitest";
import { bestInterval, heightFor, mostSpeed, OTHER, pixelAt } from "./surveyNumbers";

/** As `recon plan --camera list` prints the Mavic 3M. */
const MAVIC_3M = { across_deg: 70.2751, along_deg: 55.7465, across_px: 5280 };
const TIMER_S = [0.7, 1, 2, 3, 5, 7, 10];
const FLOWN = { height_m: 50, frontOverlap: 0.7, fastest_mps: 15, stops: false };

describe("height and speed of a survey", () => {
  it("follow from the pixel on the ground, and back", () => {
    const height_m = heightFor(MAVIC_3M, 0.02) ?? 0;
    expect(height_m).toBeCloseTo(75.0, 0);
    expect(pixelAt(MAVIC_3M, height_m)).toBeCloseTo(0.02, 9);
    expect([heightFor(OTHER, 0.02), pixelAt(OTHER, 50)]).toEqual([null, null]);
  });

  it("follow from the overlap: half of what is left of a photo takes half the speed", () => {
    expect(mostSpeed(OTHER, 2, FLOWN)).toBe(7.3);
    expect(mostSpeed(OTHER, 2, { ...FLOWN, frontOverlap: 0.85 })).toBe(3.6);
    expect(mostSpeed(OTHER, 0.5, FLOWN)).toBe(15);
  });

  it("are limited by blur, by the site, and from below", () => {
    // Half a pixel of 1.33 cm in a thousandth of a second.
    expect(mostSpeed(MAVIC_3M, 0.7, FLOWN)).toBe(6.6);
    expect(mostSpeed(OTHER, 0.5, { ...FLOWN, fastest_mps: 4 })).toBe(4);
    expect(mostSpeed(OTHER, 60, FLOWN)).toBe(1);
  });

  it("have the longest interval of those that are as fast", () => {
    expect(bestInterval(MAVIC_3M, TIMER_S, FLOWN)).toBe(2);
    expect(bestInterval(OTHER, TIMER_S, FLOWN)).toBe(0.7);
  });

  it("leave room for stops in rows over uneven ground", () => {
    expect(mostSpeed(OTHER, 2, { ...FLOWN, frontOverlap: 0.3 })).toBe(15);
    expect(mostSpeed(OTHER, 2, { ...FLOWN, frontOverlap: 0.3, stops: true })).toBe(10.6);
  });
});
