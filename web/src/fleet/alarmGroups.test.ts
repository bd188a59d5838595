import { describe, expect, it } from "vitest";
import { alarm } from "../testing/fakeState";
import { groupAlarms, isAlarmNow } from "./alarmGroups";

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

  it("come active first, then worst first, however long ago they were raised", () => {
    const over = { is_active: false };
    const groups = groupAlarms([
      alarm(1, { rule: "app_message", severity: "info" }),
      alarm(2, { rule: "link_lost", severity: "critical", raised_age_s: 1, ...over }),
      alarm(3),
      pair(4),
      alarm(5, { rule: "gnss", severity: "error", raised_age_s: 2, ...over }),
    ]);
    expect(groups.map(({ severity, isActive }) => [severity, isActive])).toEqual([
      ["critical", true],
      ["warning", true],
      ["info", true],
      ["critical", false],
      ["error", false],
    ]);
  });

  it("are counted while their cause lasts, notes are not", () => {
    const alarms = [alarm(1), alarm(2, { is_active: false }), alarm(3, { severity: "info" })];
    expect(alarms.filter(isAlarmNow)).toHaveLength(1);
  });

  it("that go on after an acknowledgement are apart from new ones", () => {
    const groups = groupAlarms([pair(1), { ...pair(2), is_acknowledged: true }, pair(3)]);
    expect(groups.map(({ title, isAcknowledged }) => [title, isAcknowledged])).toEqual([
      ["Separation: 2 pairs", false],
      ["Drone 2: Near", true],
    ]);
  });
});
