import { describe, expect, it } from "vitest";
import { vehicle } from "../../testing/fakeState";
import { factsOf } from "./facts";

const flag = (value: boolean | null) => ({ value, age_s: 0.1 });

describe("the in-air fact", () => {
  it.each([
    [true, true, "yes"],
    [false, false, "no"],
    [true, false, "yes (reports on the ground)"],
    [null, false, "uncertain (reports on the ground)"],
    [null, null, "—"],
  ] as const)("believed %s and reported %s is %s", (believed, reported, text) => {
    const view = vehicle(1, { is_flying: flag(believed), reported_is_flying: flag(reported) });
    expect(factsOf(view).find(({ name }) => name === "Flying")?.text).toBe(text);
  });
});

it("shows each doubt about telemetry as a sentence", () => {
  const text = "its position jumped by 60 m; not believed. Check its position on its controller";
  const doubts = [{ kind: "position_jump", text, age_s: 1.5, packets: 12 }] as const;
  const facts = factsOf(vehicle(1, { doubts: [...doubts] }));
  expect(facts.find(({ name }) => name === "Telemetry doubted")?.text).toBe(text);
});
