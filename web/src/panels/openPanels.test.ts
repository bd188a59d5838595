import { describe, expect, it } from "vitest";
import { createOpenPanels } from "./openPanels";

function storage(kept: string | null = null) {
  let value = kept;
  return {
    getItem: () => value,
    setItem: (_name: string, next: string) => {
      value = next;
    },
  };
}

describe("open panels", () => {
  it("begin with the survey, and stay as they were left", () => {
    const store = storage();
    const panels = createOpenPanels(store, () => false);
    expect(panels.names()).toEqual(["survey"]);
    panels.toggle("alarms");
    panels.close("survey");
    expect(createOpenPanels(store, () => false).names()).toEqual(["alarms"]);
  });

  it("are one at a time on a phone, and none at first", () => {
    const panels = createOpenPanels(storage("survey,links"), () => true);
    expect(panels.names()).toEqual([]);
    panels.open("alarms");
    panels.open("zones");
    expect(panels.names()).toEqual(["zones"]);
    panels.toggle("zones");
    expect(panels.names()).toEqual([]);
  });

  it("ignore what another version has stored", () => {
    expect(createOpenPanels(storage("sky,links"), () => false).names()).toEqual(["links"]);
  });
});
