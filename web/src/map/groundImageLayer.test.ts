import type { Map as MapLibre } from "maplibre-gl";
import { beforeEach, describe, expect, it, vi } from "vitest";
import type { GroundImageView } from "../protocol";
import type { Outcome, Picture } from "../source/stationSource";
import { at, station } from "../testing/fakeState";
import { GroundImageLayer } from "./groundImageLayer";

type Shown = { readonly url: string; readonly coordinates: [number, number][] };

/** As much of a map as an image needs; remembers what it was given. */
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
        { id: "trails", type: "line" },
      ],
    }),
  };
  return { map: map as unknown as MapLibre, shown, added };
}

function image(frame_id: number): GroundImageView {
  return {
    frame_id,
    serial: "SN-001",
    captured_age_s: 0.5,
    captured_sigma_s: 0.2,
    registration: "unregistered",
    reference: "telemetry",
    corners: [at(frame_id, 10), at(10, 10), at(10, -10), at(frame_id, -10)],
    cell_m: 1,
    rows: 20,
    cols: 20,
  };
}

function setUp() {
  const asked: { frameId: number; answer: (outcome: Outcome<Picture>) => void }[] = [];
  const onGround: number[] = [];
  let run = 0;
  const layer = new GroundImageLayer(
    (frameId) => new Promise((answer) => asked.push({ frameId, answer })),
    { run: () => run, show: (shownImage) => onGround.push(shownImage.frame_id) },
  );
  const restart = () => {
    run += 1;
  };
  const { map, shown, added } = fakeMap();
  layer.add(map);
  const say = (frame_id: number, seconds = 1) =>
    layer.update({
      state: station([], { time_ns: seconds * 1e9, ground_image: image(frame_id) }),
      behindS: 0,
      selected: [],
      meant: null,
    });
  const answer = async (index: number, frameId: number | null) => {
    asked[index]?.answer({ kind: "answered", value: { blob: new Blob(["x"]), frameId } });
    await Promise.resolve();
    await Promise.resolve();
    await Promise.resolve();
  };
  return { asked, shown, added, onGround, restart, say, answer };
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
  it("lies at its corners, above the background and under everything else", async () => {
    const { say, answer, shown, added } = setUp();
    say(1);
    await answer(0, 1);
    expect(shown).toEqual([{ type: "image", url: "blob:1", coordinates: image(1).corners }]);
    expect(added).toEqual([{ id: "ground-image", before: "trails" }]);
  });

  it("is fetched once, one at a time, and its old address is let go", async () => {
    const { say, answer, asked, shown } = setUp();
    say(1);
    say(1);
    say(2);
    expect(asked.map(({ frameId }) => frameId)).toEqual([1]);
    await answer(0, 1);
    say(2);
    await answer(1, 2);
    say(2);
    expect(asked.map(({ frameId }) => frameId)).toEqual([1, 2]);
    expect(shown.at(-1)).toEqual({ url: "blob:2", coordinates: image(2).corners });
    expect(revoked).toEqual(["blob:1"]);
  });

  it("waits for the place of a picture that is newer than the state", async () => {
    const { say, answer, shown } = setUp();
    say(1);
    await answer(0, 2);
    expect(shown).toEqual([]);
    say(2);
    expect(shown).toMatchObject([{ coordinates: image(2).corners }]);
  });

  it("drops a picture whose place was never told, rather than show it elsewhere", async () => {
    const { say, answer, asked, shown } = setUp();
    say(1);
    await answer(0, 2);
    say(3);
    expect(shown).toEqual([]);
    expect(asked.map(({ frameId }) => frameId)).toEqual([1, 3]);
    await answer(1, 3);
    expect(shown).toMatchObject([{ coordinates: image(3).corners }]);
  });

  it("tells which frame lies there: the one that was shown, not the newest", async () => {
    const { say, answer, onGround, asked } = setUp();
    say(1);
    expect(onGround).toEqual([]);
    await answer(0, 1);
    say(2);
    say(3);
    expect(onGround).toEqual([1]);
    await answer(1, 2);
    expect(onGround).toEqual([1, 2]);
    expect(asked.map(({ frameId }) => frameId)).toEqual([1, 2]);
  });

  it("does not show a picture without its number", async () => {
    const { say, answer, shown, onGround } = setUp();
    say(1);
    await answer(0, null);
    say(1);
    expect(shown).toEqual([]);
    expect(onGround).toEqual([]);
  });

  it("takes no frame of a restarted station for that of the same number before", async () => {
    const { say, answer, asked, onGround, restart } = setUp();
    say(7);
    await answer(0, 7);
    restart();
    say(7);
    expect(asked.map(({ frameId }) => frameId)).toEqual([7, 7]);
    restart();
    say(3);
    await answer(1, 7);
    say(3);
    await answer(2, 3);
    expect(onGround).toEqual([7, 3]);
  });

  it("asks again after a while when a picture did not come", async () => {
    const { say, asked } = setUp();
    say(1, 1);
    asked[0]?.answer({ kind: "failed", problem: "no" });
    await vi.waitFor(() => {
      say(1, 4);
      expect(asked).toHaveLength(2);
    });
    say(1, 4.1);
    expect(asked).toHaveLength(2);
  });
});
