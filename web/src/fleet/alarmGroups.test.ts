import { describe, expect, it } from "vitest";
import { alarm } from "../testing/fakeState";
import { groupAlarms } from "./alarmGroups";

const pair = (id: number) =>
  alarm(id, {
    rule: "separation",
    severity: "critical",
    vehicle_name: `Drone ${id}`,
    text: "near",
  });

describe("alarms", () => {
  it("of one cause are one, with their number", () => {
    const groups = groupAlarms(Array.from({ length: 31 }, (_, id) => pair(id)));
    expect(groups.map(({ title }) => title)).toEqual(["Separation: 31 pairs"]);
    expect(groups[0]?.alarms).toHaveLength(31);
  });

  it("keep the text of a single one", () => {
    const [group] = groupAlarms([alarm(1)]);
    expect(group?.title).toBe("Dogwood: Aircraft battery warning: low, 28 % left.");
  });

  it("come by severity, those that ask for nothing last", () => {
    const over = { is_active: false, is_acknowledged: true };
    const groups = groupAlarms([
      alarm(1, { rule: "app_message", severity: "info" }),
      alarm(2, { rule: "link_lost", severity: "critical", ...over }),
      alarm(3),
      pair(4),
    ]);
    expect(groups.map(({ severity, needsLook }) => [severity, needsLook])).toEqual([
      ["critical", true],
      ["warning", true],
      ["critical", false],
      ["info", false],
    ]);
  });

  it("that go on after an acknowledgement are apart from new ones", () => {
    const groups = groupAlarms([pair(1), { ...pair(2), is_acknowledged: true }, pair(3)]);
    expect(groups.map(({ title, isAcknowledged }) => [title, isAcknowledged])).toEqual([
      ["Separation: 2 pairs", false],
      ["Drone 2: Near", true],
    ]);
  });
});
