import { describe, expect, it } from "vitest";
import { at, FIELD, hazard, vehicle } from "../testing/fakeState";
import { band, hazardOf } from "./hazards";
import { metresPerDegree } from "./localGrid";

const LOST = { staleness: "lost", telemetry_age_s: 5 } as const;

describe("a hazard area", () => {
  it("grows between states, up to its largest radius", () => {
    const one = vehicle(3, { ...LOST, hazard: hazard([0, 0]) });
    expect(hazardOf(one, 0)?.radius_m).toBe(50);
    expect(hazardOf(one, 4)?.radius_m).toBe(90);
    expect(hazardOf(one, 60)?.radius_m).toBe(150);
  });

  it("is never smaller than the station reports", () => {
    const one = vehicle(3, { ...LOST, hazard: hazard([0, 0], { largest_radius_m: 20 }) });
    expect(hazardOf(one, 4)?.radius_m).toBe(50);
  });

  it("includes the corridor to home", () => {
    const corridor: [number, number][] = [at(0, 0), at(100, 0)];
    const one = vehicle(3, { ...LOST, hazard: hazard([0, 0], { corridor }) });
    expect(hazardOf(one, 0)).toMatchObject({ corridor, corridorHalfWidth_m: 12 });
  });

  it("does not exist when the station reports none", () => {
    expect(hazardOf(vehicle(3, LOST), 0)).toBeNull();
  });

  it("is computed by the page when the state is old", () => {
    expect(hazardOf(vehicle(1), 0)).toBeNull();
    const soon = hazardOf(vehicle(1), 4)?.radius_m ?? 0;
    expect(soon).toBeGreaterThan(3);
    expect(hazardOf(vehicle(1), 8)?.radius_m).toBeGreaterThan(soon);
    const unplaced = { latitude_deg: null, longitude_deg: null, age_s: null };
    expect(hazardOf(vehicle(1, { position: unplaced }), 8)).toBeNull();
  });
});

describe("the band around a line", () => {
  it("has the half width on both sides and is closed", () => {
    const ring = band(at(0, 0), at(300, 400), 10);
    const per = metresPerDegree(FIELD.lat);
    // The distance from the line through the origin along (3, 4).
    const offsets = ring.map(([lon, lat]) => {
      const east_m = (lon - FIELD.lon) * per.lon;
      const north_m = (lat - FIELD.lat) * per.lat;
      return (3 * north_m - 4 * east_m) / 5;
    });
    expect(offsets.map((offset) => Math.round(Math.abs(offset)))).toEqual(Array(5).fill(10));
    expect(ring[0]).toEqual(ring.at(-1));
  });

  it("is empty for a line without length", () => expect(band(at(0, 0), at(0, 0), 10)).toEqual([]));
});
