import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { Outcome, Picture, StationState } from "../../protocol";
import { station, vehicle } from "../../testing/fakeState";
import { find, type RenderedPage, renderPage, settled } from "../../testing/renderPage";
import { VehicleDetail } from "./VehicleDetail";

/** The state at `second` that announces frame `id`; frame n is captured at second n. */
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
let requests: { frameId: number; settle: (outcome: Outcome<Picture>) => void }[];

beforeEach(() => {
  vi.spyOn(URL, "createObjectURL").mockReturnValue("blob:1");
  vi.spyOn(URL, "revokeObjectURL").mockReturnValue(undefined);
  requests = [];
  page = renderPage(VehicleDetail, station([vehicle(1), vehicle(2)], { time_ns: 11e9 }));
  page.fetchFramesWith(
    (_serial, frameId) => new Promise((settle) => requests.push({ frameId, settle })),
  );
  page.shared.selection.only(1);
});

afterEach(() => page.dispose());

const caption = () => page.root.querySelector("figcaption")?.textContent ?? null;

/** Answers the request with the picture of frame `frameId`. */
async function deliver(index: number, frameId: number | null): Promise<void> {
  requests[index]?.settle({ kind: "answered", value: { blob: new Blob(["x"]), frameId } });
  await settled();
}

async function fail(index: number): Promise<void> {
  requests[index]?.settle({ kind: "failed", problem: "no" });
  await settled();
}

describe("the caption of a camera's picture", () => {
  it("appears with the picture", async () => {
    page.receive(announcing(12, 12.5));
    expect(find(page.root, ".camera").textContent).toBe("Loading picture");
    await deliver(0, 12);
    expect(caption()).toBe("Frame 12, taken 0.5 s ago ± 0.2 s");
  });

  it("describes the displayed picture while newer ones fail", async () => {
    page.receive(announcing(12, 12.5));
    await deliver(0, 12);
    page.receive(announcing(13, 13.5));
    await fail(1);
    expect(caption()).toBe("Frame 12, taken 1.5 s ago ± 0.2 s");
    page.receive(announcing(15, 15.4));
    await fail(2);
    expect(caption()).toBe("Frame 12, taken 3.4 s ago ± 0.2 s");
    page.age(0.2);
    expect(caption()).toBe("Frame 12, taken 3.6 s ago ± 0.2 s; a newer frame exists");
    page.clock.advance(2000);
    await deliver(3, 15);
    expect(caption()).toBe("Frame 15, taken 0.6 s ago ± 0.2 s");
  });

  it("describes the displayed picture while a newer one is loading", async () => {
    page.receive(announcing(12, 12.5));
    await deliver(0, 12);
    for (let id = 13; id <= 90; id += 1) page.receive(announcing(id, id + 0.5));
    expect(requests.map(({ frameId }) => frameId)).toEqual([12, 13]);
    expect(caption()).toBe("Frame 12, taken 1 min 19 s ago ± 0.2 s; a newer frame exists");
  });

  it("shows no time for a picture newer than the state until it is announced", async () => {
    page.receive(announcing(12, 12.5));
    await deliver(0, 13);
    expect(caption()).toBe("Frame 13, capture time unknown");
    page.receive(announcing(13, 13.5));
    expect(caption()).toBe("Frame 13, taken 0.5 s ago ± 0.2 s");
  });

  it("shows neither number nor time for an unnumbered picture", async () => {
    page.receive(announcing(12, 12.5));
    await deliver(0, null);
    page.receive(announcing(12, 15));
    expect(caption()).toBe("Unnumbered frame, capture time unknown; a newer frame exists");
  });

  it("distinguishes frames with the same number across a station restart", async () => {
    page.receive(announcing(12, 12.5));
    await deliver(0, 12);
    const restarted = announcing(12, 14);
    page.receive({ ...restarted, station: { ...restarted.station, uptime_s: 3 } });
    expect(caption()).toBe("Frame 12, capture time unknown");
    expect(requests).toHaveLength(2);
    await deliver(1, 12);
    expect(caption()).toBe("Frame 12, taken 2.0 s ago ± 0.2 s");
  });

  it("disappears when another vehicle is selected", async () => {
    page.receive(announcing(12, 12.5));
    await deliver(0, 12);
    page.shared.selection.only(2);
    expect(caption()).toBeNull();
    expect(page.root.querySelector("img")).toBeNull();
  });
});
