import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { StationState } from "../../protocol";
import type { Outcome, Picture } from "../../source/stationSource";
import { station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage } from "../../testing/renderPage";
import { VehicleDetail } from "./VehicleDetail";

/** The state of a moment; frame n is taken at second n, and the newest of that moment is announced. */
function announcing(id: number, second: number): StationState {
  const frame = {
    id,
    received_age_s: 0.1,
    captured_age_s: second - id,
    captured_sigma_s: 0.2,
  };
  return station([vehicle(1, { frame }), vehicle(2)], { time_ns: second * 1e9 });
}

let page: RenderedPage;
let asked: { frameId: number; settle: (outcome: Outcome<Picture>) => void }[];

beforeEach(() => {
  vi.spyOn(URL, "createObjectURL").mockReturnValue("blob:1");
  vi.spyOn(URL, "revokeObjectURL").mockReturnValue(undefined);
  asked = [];
  page = renderPage(VehicleDetail, station([vehicle(1), vehicle(2)], { time_ns: 11e9 }));
  page.bringFrames((_serial, frameId) => new Promise((settle) => asked.push({ frameId, settle })));
  page.shared.selection.only(1);
});

afterEach(() => page.dispose());

const caption = () => page.root.querySelector("figcaption")?.textContent ?? null;

async function settled(): Promise<void> {
  for (let turn = 0; turn < 4; turn += 1) await Promise.resolve();
}

/** The request of that index is answered with the picture of frame `frameId`. */
async function bring(index: number, frameId: number | null): Promise<void> {
  asked[index]?.settle({ kind: "answered", value: { blob: new Blob(["x"]), frameId } });
  await settled();
}

async function fail(index: number): Promise<void> {
  asked[index]?.settle({ kind: "failed", problem: "no" });
  await settled();
}

describe("the caption of a camera's picture", () => {
  it("is not there before a picture is", async () => {
    page.say(announcing(12, 12.5));
    expect(find(page.root, ".camera").textContent).toBe("Picture on its way");
    await bring(0, 12);
    expect(caption()).toBe("Frame 12, taken 0.5 s ago ± 0.2 s");
  });

  it("stays the shown picture's while newer ones fail, and grows old with it", async () => {
    page.say(announcing(12, 12.5));
    await bring(0, 12);
    page.say(announcing(13, 13.5));
    await fail(1);
    expect(caption()).toBe("Frame 12, taken 1.5 s ago ± 0.2 s");
    page.say(announcing(15, 15.4));
    await fail(2);
    expect(caption()).toBe("Frame 12, taken 3.4 s ago ± 0.2 s");
    page.age(0.2);
    expect(caption()).toBe("Frame 12, taken 3.6 s ago ± 0.2 s, newer not loaded");
    page.clock.advance(2000);
    await bring(3, 15);
    expect(caption()).toBe("Frame 15, taken 0.6 s ago ± 0.2 s");
  });

  it("stays the shown picture's while a newer one is slow", async () => {
    page.say(announcing(12, 12.5));
    await bring(0, 12);
    for (let id = 13; id <= 90; id += 1) page.say(announcing(id, id + 0.5));
    expect(asked.map(({ frameId }) => frameId)).toEqual([12, 13]);
    expect(caption()).toBe("Frame 12, taken 1 min 19 s ago ± 0.2 s, newer not loaded");
  });

  it("claims no time for a picture that is ahead of the states, until they name it", async () => {
    page.say(announcing(12, 12.5));
    await bring(0, 13);
    expect(caption()).toBe("Frame 13, time taken unknown");
    page.say(announcing(13, 13.5));
    expect(caption()).toBe("Frame 13, taken 0.5 s ago ± 0.2 s");
  });

  it("claims nothing for a picture without a number", async () => {
    page.say(announcing(12, 12.5));
    await bring(0, null);
    page.say(announcing(12, 15));
    expect(caption()).toBe("Frame without a number, time taken unknown, newer not loaded");
  });

  it("does not take a restarted station's frame for the one of the same number before", async () => {
    page.say(announcing(12, 12.5));
    await bring(0, 12);
    const restarted = announcing(12, 14);
    page.say({ ...restarted, station: { ...restarted.station, uptime_s: 3 } });
    expect(caption()).toBe("Frame 12, time taken unknown");
    expect(asked).toHaveLength(2);
    await bring(1, 12);
    expect(caption()).toBe("Frame 12, taken 2.0 s ago ± 0.2 s");
  });

  it("goes with the picture when another vehicle is selected", async () => {
    page.say(announcing(12, 12.5));
    await bring(0, 12);
    page.shared.selection.only(2);
    expect(caption()).toBeNull();
    expect(page.root.querySelector("img")).toBeNull();
  });
});
