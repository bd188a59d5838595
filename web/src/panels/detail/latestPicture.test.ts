import { describe, expect, it } from "vitest";
import type { Outcome, Picture } from "../../source/stationSource";
import { FakeClock } from "../../testing/fakeClock";
import { LatestPicture, type PictureKey } from "./latestPicture";

function setUp() {
  const asked: { key: PictureKey; answer: (outcome: Outcome<Picture>) => void }[] = [];
  const alive = new Set<string>();
  const shown: (string | null)[] = [];
  let made = 0;
  const clock = new FakeClock();
  const picture = new LatestPicture({
    fetch: (key) => new Promise((answer) => asked.push({ key, answer })),
    addresses: {
      create: () => {
        made += 1;
        alive.add(`blob:${made}`);
        return `blob:${made}`;
      },
      revoke: (url) => alive.delete(url),
    },
    show: (newest) => shown.push(newest?.url ?? null),
    later: (action) => clock.after(2000, action),
  });
  const settle = async (index: number, outcome: Outcome<Picture>) => {
    asked[index]?.answer(outcome);
    await new Promise((resolve) => queueMicrotask(() => resolve(null)));
    await Promise.resolve();
  };
  const answer = (index: number) =>
    settle(index, { kind: "answered", value: { blob: new Blob(["x"]), frameId: null } });
  const fail = (index: number) => settle(index, { kind: "failed", problem: "no" });
  return { picture, asked, alive, shown, answer, fail, clock };
}

describe("a camera's latest picture", () => {
  it("fetches one at a time and passes over those that were overtaken", async () => {
    const { picture, asked, answer } = setUp();
    for (const frameId of [1, 2, 3]) picture.want({ serial: "A", frameId });
    expect(asked.map(({ key }) => key.frameId)).toEqual([1]);
    await answer(0);
    expect(asked.map(({ key }) => key.frameId)).toEqual([1, 3]);
  });

  it("lets go of every picture but the newest", async () => {
    const { picture, alive, shown, answer } = setUp();
    picture.want({ serial: "A", frameId: 1 });
    await answer(0);
    picture.want({ serial: "A", frameId: 2 });
    await answer(1);
    expect([...alive]).toEqual(["blob:2"]);
    expect(shown.at(-1)).toBe("blob:2");
    picture.close();
    expect(alive.size).toBe(0);
  });

  it("never shows one vehicle's picture for another", async () => {
    const { picture, shown, answer } = setUp();
    picture.want({ serial: "A", frameId: 1 });
    picture.want({ serial: "B", frameId: 1 });
    await answer(0);
    expect(shown.every((url) => url === null)).toBe(true);
    await answer(1);
    expect(shown.at(-1)).toBe("blob:1");
  });

  it("asks again after a while for one that did not come, and not after it was closed", async () => {
    const { picture, asked, fail, clock, shown } = setUp();
    picture.want({ serial: "A", frameId: 1 });
    await fail(0);
    expect(asked).toHaveLength(1);
    clock.advance(2000);
    expect(asked.map(({ key }) => key.frameId)).toEqual([1, 1]);
    await fail(1);
    picture.close();
    clock.advance(9000);
    expect(asked).toHaveLength(2);
    expect(shown).toEqual([]);
  });
});
