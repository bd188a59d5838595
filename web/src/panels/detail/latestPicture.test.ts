import { describe, expect, it } from "vitest";
import type { Outcome, Picture } from "../../protocol";
import { FakeClock } from "../../testing/fakeClock";
import { LatestPicture, type PictureKey } from "./latestPicture";

function setUp() {
  const requests: { key: PictureKey; answer: (outcome: Outcome<Picture>) => void }[] = [];
  const alive = new Set<string>();
  const shown: (string | null)[] = [];
  let count = 0;
  const clock = new FakeClock();
  const picture = new LatestPicture({
    fetch: (key) => new Promise((answer) => requests.push({ key, answer })),
    addresses: {
      create: () => {
        count += 1;
        alive.add(`blob:${count}`);
        return `blob:${count}`;
      },
      revoke: (url) => alive.delete(url),
    },
    show: (newest) => shown.push(newest?.url ?? null),
    later: (action) => clock.after(2000, action),
  });
  const settle = async (index: number, outcome: Outcome<Picture>) => {
    requests[index]?.answer(outcome);
    await new Promise((resolve) => queueMicrotask(() => resolve(null)));
    await Promise.resolve();
  };
  const answer = (index: number) =>
    settle(index, { kind: "answered", value: { blob: new Blob(["x"]), frameId: null } });
  const fail = (index: number) => settle(index, { kind: "failed", problem: "no" });
  return { picture, requests, alive, shown, answer, fail, clock };
}

describe("a camera's latest picture", () => {
  it("fetches one at a time and skips superseded ones", async () => {
    const { picture, requests, answer } = setUp();
    for (const frameId of [1, 2, 3]) picture.request({ serial: "A", frameId });
    expect(requests.map(({ key }) => key.frameId)).toEqual([1]);
    await answer(0);
    expect(requests.map(({ key }) => key.frameId)).toEqual([1, 3]);
  });

  it("revokes every picture but the newest", async () => {
    const { picture, alive, shown, answer } = setUp();
    picture.request({ serial: "A", frameId: 1 });
    await answer(0);
    picture.request({ serial: "A", frameId: 2 });
    await answer(1);
    expect([...alive]).toEqual(["blob:2"]);
    expect(shown.at(-1)).toBe("blob:2");
    picture.close();
    expect(alive.size).toBe(0);
  });

  it("never shows one vehicle's picture for another", async () => {
    const { picture, shown, answer } = setUp();
    picture.request({ serial: "A", frameId: 1 });
    picture.request({ serial: "B", frameId: 1 });
    await answer(0);
    expect(shown.every((url) => url === null)).toBe(true);
    await answer(1);
    expect(shown.at(-1)).toBe("blob:1");
  });

  it("retries a failed picture, but not after close", async () => {
    const { picture, requests, fail, clock, shown } = setUp();
    picture.request({ serial: "A", frameId: 1 });
    await fail(0);
    expect(requests).toHaveLength(1);
    clock.advance(2000);
    expect(requests.map(({ key }) => key.frameId)).toEqual([1, 1]);
    await fail(1);
    picture.close();
    clock.advance(9000);
    expect(requests).toHaveLength(2);
    expect(shown).toEqual([]);
  });
});
