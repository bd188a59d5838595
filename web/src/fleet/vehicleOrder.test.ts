import { describe, expect, it } from "vitest";
import { vehicle } from "../testing/fakeState";
import {
  FIRST_CHOICE,
  firstFound,
  isSameList,
  type ListChoice,
  listVehicles,
} from "./vehicleOrder";

const FLEET = [
  vehicle(2),
  vehicle(1, { battery_fraction: { value: 0.3, age_s: 0.1 } }),
  vehicle(3, { is_flying: { value: false, age_s: 0.1 }, is_imager: true }),
  vehicle(12, { staleness: "lost", serial: "1581F5" }),
];

function listed(choice: Partial<ListChoice>, selected: readonly number[] = []) {
  const has = (key: number) => selected.includes(key);
  return listVehicles(FLEET, { ...FIRST_CHOICE, ...choice }, has, 0).map(
    ({ title, vehicles }) => [title, vehicles.map(({ number }) => number)] as const,
  );
}

describe("the list of vehicles", () => {
  it.each([
    [{}, [12, 1, 2, 3]],
    [{ sort: "battery" }, [12, 1, 3, 2]],
    [{ sort: "trouble" }, [12, 1, 2, 3]],
    [{ sort: "name" }, [12, 1, 2, 3]],
    [{ search: "1" }, [12, 1]],
    [{ search: "birch" }, [2]],
    [{ search: "1581f" }, [12]],
    [{ filter: "flying" }, [12, 1, 2]],
    [{ filter: "trouble" }, [12]],
    [{ filter: "selected" }, [2]],
  ] as const)("with %j is %j", (choice, numbers) => {
    expect(listed(choice, [2])).toEqual([["", numbers]]);
  });

  it("is grouped by what they do, and by kind", () => {
    expect(listed({ group: "activity" })).toEqual([
      ["Contact lost", [12]],
      ["Flying", [1, 2]],
      ["On the ground", [3]],
    ]);
    expect(listed({ group: "role" })).toEqual([
      ["Survey drones", [12, 1, 2]],
      ["Imaging drones", [3]],
    ]);
  });

  it("is searched for a number before a part of a name", () => {
    const found = (search: string) => {
      const groups = listVehicles(FLEET, { ...FIRST_CHOICE, search }, () => false, 0);
      return firstFound(groups, search)?.number ?? null;
    };
    expect(["1", " 12", "bir", "x", " "].map(found)).toEqual([1, 12, 2, null, null]);
  });

  it("is the same list while its vehicles and their order are the same", () => {
    const list = () => listVehicles(FLEET, FIRST_CHOICE, () => false, 0);
    expect(isSameList(list(), list())).toBe(true);
    const others = listVehicles(FLEET.slice(1), FIRST_CHOICE, () => false, 0);
    expect(isSameList(list(), others)).toBe(false);
  });
});
