import { describe, expect, it } from "vitest";
import { FramePacer } from "./framePacer";

function paced() {
  const shown: number[] = [];
  let due: (() => void)[] = [];
  const pacer = new FramePacer<number>(
    (value) => shown.push(value),
    (action) => due.push(action),
  );
  const frame = () => {
    const now = due;
    due = [];
    for (const action of now) action();
  };
  return { pacer, shown, frame };
}

describe("the pace of states", () => {
  it("is that of the states while frames are faster", () => {
    const { pacer, shown, frame } = paced();
    for (const value of [1, 2, 3]) {
      pacer.offer(value);
      frame();
      frame();
    }
    expect(shown).toEqual([1, 2, 3]);
  });

  it("is that of the frames while those are slower, and the newest state is next", () => {
    const { pacer, shown, frame } = paced();
    for (const value of [1, 2, 3]) pacer.offer(value);
    frame();
    expect(shown).toEqual([1]);
    frame();
    expect(shown).toEqual([1, 3]);
    frame();
    frame();
    frame();
    pacer.offer(4);
    expect(shown).toEqual([1, 3, 4]);
  });

  it("does not hold back the first state of a connection", () => {
    const { pacer, shown, frame } = paced();
    pacer.offer(1);
    pacer.offer(2);
    pacer.restart(10);
    frame();
    frame();
    expect(shown).toEqual([1, 10]);
  });

  it("is not limited without frames", () => {
    const shown: number[] = [];
    const pacer = new FramePacer<number>(
      (value) => shown.push(value),
      (action) => action(),
    );
    for (const value of [1, 2, 3]) pacer.offer(value);
    expect(shown).toEqual([1, 2, 3]);
  });

  it("goes on after a state that could not be shown", () => {
    const shown: number[] = [];
    const due: (() => void)[] = [];
    const pacer = new FramePacer<number>(
      (value) => {
        if (value === 1) throw new Error("it cannot be drawn");
        shown.push(value);
      },
      (action) => due.push(action),
    );
    expect(() => pacer.offer(1)).toThrow();
    pacer.offer(2);
    while (due.length > 0) due.shift()?.();
    expect(shown).toEqual([2]);
  });
});
