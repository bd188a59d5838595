import { describe, expect, it } from "vitest";
import { clustersOf, type Spot } from "./clusters";

const spot = (key: number, x_px: number, standsAlone = false): Spot => ({
  key,
  x_px,
  y_px: 100,
  standsAlone,
});

describe("clusters", () => {
  it("stand for five or more vehicles that would hide each other", () => {
    const close = [0, 4, 8, 12, 16].map((x, index) => spot(index + 1, x));
    const [cluster, ...others] = clustersOf([...close, spot(6, 200)]);
    expect(others).toEqual([]);
    expect(cluster).toEqual({ keys: [1, 2, 3, 4, 5], x_px: 8, y_px: 100 });
  });

  it("leave four vehicles, and those far enough apart", () => {
    expect(clustersOf([0, 4, 8, 12].map((x, index) => spot(index + 1, x)))).toEqual([]);
    expect(clustersOf([...Array(20).keys()].map((n) => spot(n, 40 * n)))).toEqual([]);
  });

  it("never hide one that is selected or in trouble", () => {
    const spots = [0, 2, 4, 6, 8, 10].map((x, index) => spot(index + 1, x, index === 2));
    expect(clustersOf(spots).map(({ keys }) => keys)).toEqual([[1, 2, 4, 5, 6]]);
  });

  it("take every vehicle once", () => {
    const spots = [...Array(64).keys()].map((n) => spot(n + 1, (n * 37) % 160));
    const keys = clustersOf(spots).flatMap((cluster) => cluster.keys);
    expect(new Set(keys).size).toBe(keys.length);
  });
});
