import { describe, expect, it } from "vitest";
import { groupAlarms } from "../fleet/alarmGroups";
import { severityRank } from "../fleet/severity";
import type { AlarmView } from "../protocol";
import { alarm } from "../testing/fakeState";
import {
  AGAIN_MS,
  type Announcement,
  announce,
  GAP_MS,
  GATHER_MS,
  LONGEST_SPEECH_MS,
  REPEAT_MS,
  SILENT,
  spokenText,
} from "./announcements";

const STEP_MS = 100;
type Given = Announcement & { readonly at_ms: number };

/** Announcements of what `alarmsAt` has, ten times a second; nothing is spoken longer than `speech_ms`. */
function play(
  length_ms: number,
  alarmsAt: (now_ms: number) => readonly AlarmView[],
  speech_ms = 0,
): Given[] {
  let announcer = SILENT;
  const given: Given[] = [];
  for (let now_ms = 0; now_ms < length_ms; now_ms += STEP_MS) {
    const isSpeaking = now_ms - (given.at(-1)?.at_ms ?? -1e9) < speech_ms;
    const [next, one] = announce(announcer, groupAlarms(alarmsAt(now_ms)), isSpeaking, now_ms);
    announcer = next;
    if (one !== null) given.push({ ...one, at_ms: now_ms });
  }
  return given;
}

const pair = (id: number) =>
  alarm(id, { rule: "separation", severity: "critical", vehicle_name: `Drone ${id}` });
const texts = (given: readonly Given[]) => given.map(({ text }) => text);

describe("alarms of one cause", () => {
  it("are announced once, with their number, although they come one after the other", () => {
    const given = play(2000, (now_ms) =>
      Array.from({ length: Math.min(31, 1 + now_ms / 10) }, (_, id) => pair(id)),
    );
    expect(texts(given)).toEqual(["Separation: 31 pairs"]);
    expect(given[0]?.at_ms).toBe(GATHER_MS);
  });

  it("are announced again with more of them, but not at once", () => {
    const given = play(14_000, (now_ms) => [pair(1), pair(2), ...(now_ms > 3000 ? [pair(3)] : [])]);
    expect(texts(given)).toEqual(["Separation: 2 pairs", "Separation: 3 pairs"]);
    expect(given[1]?.at_ms).toBe(GATHER_MS + AGAIN_MS);
  });

  it("are repeated while critical, not when less", () => {
    expect(play(2 * REPEAT_MS, () => [pair(1)])).toHaveLength(2);
    expect(play(2 * REPEAT_MS, () => [alarm(1)])).toHaveLength(1);
  });

  it("do not sound each time they come and go", () => {
    const flapping = (now_ms: number) =>
      now_ms % 2000 < 1000 ? [alarm(now_ms - (now_ms % 2000))] : [];
    expect(play(AGAIN_MS, flapping)).toHaveLength(1);
    expect(play(2 * AGAIN_MS, flapping).length).toBeLessThanOrEqual(2);
  });
});

describe("several causes", () => {
  it("are announced one after the other, the worst first", () => {
    const given = play(6000, () => [alarm(1), pair(2)]);
    expect(given.map(({ severity }) => severity)).toEqual(["critical", "warning"]);
    expect(given[1]?.at_ms).toBe(GATHER_MS + GAP_MS);
  });

  it("let a more severe one interrupt speech, no other", () => {
    const given = play(
      12_000,
      (now_ms) => [alarm(1), ...(now_ms >= 1000 ? [pair(2), alarm(3, { rule: "geofence" })] : [])],
      20_000,
    );
    expect(given.map(({ severity, interrupts, at_ms }) => [severity, interrupts, at_ms])).toEqual([
      ["warning", false, GATHER_MS],
      ["critical", true, 1000 + GATHER_MS],
      // Speech that never ends does not silence what follows.
      ["warning", true, 1000 + GATHER_MS + LONGEST_SPEECH_MS],
    ]);
  });

  it("each sound, whatever comes with them, and never on top of each other", () => {
    for (let seed = 1; seed <= 30; seed += 1) {
      const random = sequence(seed);
      const rules = ["separation", "battery", "geofence", "link_lost", "gnss"];
      const made = Array.from({ length: 12 }, (_, id) => {
        const severity = (["critical", "error", "warning"] as const)[Math.floor(random() * 3)];
        const rule = rules[Math.floor(random() * rules.length)] ?? "gnss";
        return {
          begin_ms: random() * 20_000,
          one: alarm(id, { rule, severity: severity ?? "error" }),
        };
      });
      const given = play(90_000, (now_ms) =>
        made.filter(({ begin_ms }) => begin_ms <= now_ms).map(({ one }) => one),
      );
      // Each cause, with all of its alarms in its last announcement.
      for (const { title } of groupAlarms(made.map(({ one }) => one)))
        expect(texts(given), `seed ${seed}`).toContain(title);
      for (const [index, one] of given.entries()) {
        const before = given[index - 1];
        if (before === undefined) continue;
        const isWorse = severityRank(one.severity) < severityRank(before.severity);
        expect(isWorse || one.at_ms - before.at_ms >= GAP_MS).toBe(true);
      }
    }
  });
});

describe("a spoken text", () => {
  it.each([
    ["Cedar: Flying without telemetry for 4 s.", "Cedar: Flying without telemetry for 4 seconds."],
    [
      "battery 28 % left, 12\u00a0m away at 5 m/s",
      "battery 28 per cent left, 12 metres away at 5 metres per second",
    ],
    ["40 ft above, 3 min", "40 feet above, 3 min"],
    ["<speak>Alder & co", "speak Alder co"],
  ])("of %j is %j", (title, text) => expect(spokenText(title)).toBe(text));

  it("is short, whatever a vehicle sends", () => {
    expect(spokenText("x".repeat(5000))).toHaveLength(160);
  });
});

/** Numbers from 0 to 1, the same for the same seed. */
function sequence(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state * 48271) % 2147483647;
    return state / 2147483647;
  };
}
