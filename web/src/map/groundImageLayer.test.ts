import type { Map as MapLibre } from "maplibre-gl";
import { beforeEach, describe, expect, it, vi } from "vitest";
import type { GroundImageView, Outcome, Picture } from "../protocol";
import { groundImage } from "../testing/fakeField";
import { at, station } from "../testing/fakeState";
import { GroundImageLayer } from "./groundImageLayer";

type Shown = { readonly url: string; readonly coordinates: [number, number][] };

/** The parts of a map an image layer uses; records calls. */
function fakeMap() {
  const shown: Shown[] = [];
  const added: { id: string; before: string | undefined }[] = [];
  const source = { updateImage: (image: Shown) => shown.push(image) };
  const map = {
    getSource: () => (shown.length > 0 ? source : undefined),
    addSource: (_id: string, image: Shown) => shown.push(image),
    addLayer: (layer: { id: string }, before?: string) => added.push({ id: layer.id, before }),
    getStyle: () => ({
      layers: [
        { id: "ground", type: "background" },
        { id: "base-map", type: "raster" },
        { id: "trails", type: "line" },
      ],
    }),
  };
  return { map: map as unknown as MapLibre, shown, added };
}

function image(frame_id: number): GroundImageView {
  const corners: GroundImageView["corners"] = [
    at(frame_id, 10),
    at(10, 10),
    at(10, -10),
    at(frame_id, -10),
  ];
  return groundImage({ frame_id, corners });
}

function setUp() {
  const requests: { frameId: number; answer: (outcome: Outcome<Picture>) => void }[] = [];
  const displayed: number[] = [];
  let run = 0;
  const layer = new GroundImageLayer(
    (frameId) => new Promise((answer) => requests.push({ frameId, answer })),
    { run: () => run, show: (shownImage) => displayed.push(shownImage.frame_id) },
  );
  const restart = () => {
    run += 1;
  };
  const { map, shown, added } = fakeMap();
  layer.add(map);
  const update = (frame_id: number, seconds = 1) =>
    layer.update({
      state: station([], { time_ns: seconds * 1e9, ground_image: image(frame_id) }),
      behindS: 0,
      selected: [],
      plannedTarget: null,
      missionDraft: null,
      zoneDraft: null,
      siteDraft: null,
    });
  const answer = async (index: number, frameId: number | null) => {
    requests[index]?.answer({ kind: "answered", value: { blob: new Blob(["x"]), frameId } });
    await Promise.resolve();
    await Promise.resolve();
    await Promise.resolve();
  };
  return { requests, shown, added, displayed, restart, update, answer };
}

let revoked: string[];

beforeEach(() => {
  let made = 0;
  revoked = [];
  vi.spyOn(URL, "createObjectURL").mockImplementation(() => {
    made += 1;
    return `blob:${made}`;
  });
  vi.spyOn(URL, "revokeObjectURL").mockImplementation((url) => {
    revoked.push(url);
  });
});

describe("the ground image", () => {
  it("is placed at its corners, above the background and below everything else", async () => {
    const { update, answer, shown, added } = setUp();
    update(1);
    await answer(0, 1);
    expect(shown).toEqual([{ type: "image", url: "blob:1", coordinates: image(1).corners }]);
    expect(added).toEqual([{ id: "ground-image", before: "trails" }]);
  });

  it("is fetched once, one at a time, and the old URL is revoked", async () => {
    const { update, answer, requests, shown } = setUp();
    update(1);
    update(1);
    update(2);
    expect(requests.map(({ frameId }) => frameId)).toEqual([1]);
    await answer(0, 1);
    update(2);
    await answer(1, 2);
    update(2);
    expect(requests.map(({ frameId }) => frameId)).toEqual([1, 2]);
    expect(shown.at(-1)).toEqual({ url: "blob:2", coordinates: image(2).corners });
    expect(revoked).toEqual(["blob:1"]);
  });

  it("waits for the position of a picture newer than the state", async () => {
    const { update, answer, shown } = setUp();
    update(1);
    await answer(0, 2);
    expect(shown).toEqual([]);
    update(2);
    expect(shown).toMatchObject([{ coordinates: image(2).corners }]);
  });

  it("drops a picture whose position was never announced", async () => {
    const { update, answer, requests, shown } = setUp();
    update(1);
    await answer(0, 2);
    update(3);
    expect(shown).toEqual([]);
    expect(requests.map(({ frameId }) => frameId)).toEqual([1, 3]);
    await answer(1, 3);
    expect(shown).toMatchObject([{ coordinates: image(3).corners }]);
  });

  it("reports the displayed frame, not the newest", async () => {
    const { update, answer, displayed, requests } = setUp();
    update(1);
    expect(displayed).toEqual([]);
    await answer(0, 1);
    update(2);
    update(3);
    expect(displayed).toEqual([1]);
    await answer(1, 2);
    expect(displayed).toEqual([1, 2]);
    expect(requests.map(({ frameId }) => frameId)).toEqual([1, 2]);
  });

  it("does not show an unnumbered picture", async () => {
    const { update, answer, shown, displayed } = setUp();
    update(1);
    await answer(0, null);
    update(1);
    expect(shown).toEqual([]);
    expect(displayed).toEqual([]);
  });

  it("distinguishes frames with the same number across a station restart", async () => {
    const { update, answer, requests, displayed, restart } = setUp();
    update(7);
    await answer(0, 7);
    restart();
    update(7);
    expect(requests.map(({ frameId }) => frameId)).toEqual([7, 7]);
    restart();
    update(3);
    await answer(1, 7);
    update(3);
    await answer(2, 3);
    expect(displayed).toEqual([7, 3]);
  });

  it("retries a failed picture", async () => {
    const { update, requests } = setUp();
    update(1, 1);
    requests[0]?.answer({ kind: "failed", problem: "no" });
    await vi.waitFor(() => {
      update(1, 4);
      expect(requests).toHaveLength(2);
    });
    update(1, 4.1);
    expect(requests).toHaveLength(2);
  });
});
