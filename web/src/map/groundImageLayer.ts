import type { ImageSource, Map as MapLibre } from "maplibre-gl";
import { type Accessor, createSignal } from "solid-js";
import { createFrameOnScreen, type ShownFrame } from "../fleet/displayedFrame";
import type { GroundImageView, StationState } from "../protocol";
import type { Outcome, Picture, StationSource } from "../source/stationSource";
import type { Layer, Scene } from "./scene";

const SOURCE = "ground-image";
const LAYER = "ground-image";
/** After a picture that did not come, wait so long (station time) before asking again. */
const RETRY_NS = 2e9;
/** Places of so many frames are remembered while their pictures are on the way. */
const REMEMBERED = 8;

/** Told what lies on the ground, and knows which run of the station the newest state is of. */
export interface GroundWitness {
  readonly run: () => number;
  /** The picture of this very frame is on the map from now on. */
  show(image: GroundImageView): void;
}

interface Place {
  readonly image: GroundImageView;
  readonly corners: Corners;
}

type Corner = [number, number];
type Corners = [Corner, Corner, Corner, Corner];

/** The newest frame of the imaging vehicle, laid on the ground under everything else. */
export class GroundImageLayer implements Layer {
  private map: MapLibre | null = null;
  private readonly places = new Map<number, Place>();
  private waiting: { readonly blob: Blob; readonly frameId: number } | null = null;
  private shownFrame: number | null = null;
  private isFetching = false;
  private address: string | null = null;
  private notBefore_ns = 0;
  private run = 0;

  /** `fetchImage` brings the newest picture; which frame it is comes with it. */
  constructor(
    private readonly fetchImage: (frameId: number) => Promise<Outcome<Picture>>,
    private readonly witness: GroundWitness,
  ) {}

  add(map: MapLibre): void {
    this.map = map;
  }

  update(scene: Scene): void {
    const image = scene.state.ground_image;
    this.noticeRestart();
    if (image === null) return;
    this.remember(image);
    this.showWaiting();
    // One at a time: on a slow link the newest is fetched next, those between are passed over.
    const isWanted = image.frame_id !== this.shownFrame && this.waiting === null;
    if (!isWanted || this.isFetching || scene.state.time_ns < this.notBefore_ns) return;
    this.isFetching = true;
    this.notBefore_ns = scene.state.time_ns + RETRY_NS;
    void this.bring(image.frame_id).finally(() => {
      this.isFetching = false;
    });
  }

  recolour(): void {}

  /** Frame numbers start anew with the station: what was known by them is worth nothing. */
  private noticeRestart(): void {
    const run = this.witness.run();
    if (run === this.run) return;
    this.run = run;
    this.places.clear();
    this.waiting = null;
    this.shownFrame = null;
    this.notBefore_ns = 0;
  }

  private async bring(asked: number): Promise<void> {
    const { run } = this;
    const outcome = await this.fetchImage(asked);
    if (outcome.kind === "failed" || run !== this.run) return;
    const { blob, frameId } = outcome.value;
    // Without its number nobody knows where it belongs, nor how old it is.
    if (frameId === null) return;
    this.waiting = { blob, frameId };
    this.notBefore_ns = 0;
    this.showWaiting();
  }

  private remember(image: GroundImageView): void {
    const corners = cornersOf(image);
    if (corners !== null) this.places.set(image.frame_id, { image, corners });
    for (const known of this.places.keys()) {
      if (this.places.size <= REMEMBERED) break;
      this.places.delete(known);
    }
  }

  /** Shows the picture that came as soon as its own place is known: never one frame in another's place. */
  private showWaiting(): void {
    const waiting = this.waiting;
    if (waiting === null) return;
    const place = this.places.get(waiting.frameId);
    const newest = Math.max(...this.places.keys());
    // A state with its place may still come; after a later frame's it will not.
    if (place !== undefined || newest > waiting.frameId) this.waiting = null;
    if (place === undefined) return;
    this.shownFrame = waiting.frameId;
    this.show(URL.createObjectURL(waiting.blob), place.corners);
    this.witness.show(place.image);
  }

  private show(url: string, coordinates: Corners): void {
    const before = this.address;
    this.address = url;
    const source = this.map?.getSource<ImageSource>(SOURCE);
    if (source === undefined) this.addImage(url, coordinates);
    else source.updateImage({ url, coordinates });
    // MapLibre has read the one before, or has just been told to forget it.
    if (before !== null) URL.revokeObjectURL(before);
  }

  private addImage(url: string, coordinates: Corners): void {
    if (this.map === null) return;
    this.map.addSource(SOURCE, { type: "image", url, coordinates });
    const lowest = this.map.getStyle().layers.find((layer) => layer.type !== "background");
    const paint = { "raster-fade-duration": 0, "raster-resampling": "linear" } as const;
    this.map.addLayer({ id: LAYER, type: "raster", source: SOURCE, paint }, lowest?.id);
  }
}

function cornersOf(image: GroundImageView): Corners | null {
  const [nw, ne, se, sw] = image.corners;
  if (nw === undefined || ne === undefined || se === undefined || sw === undefined) return null;
  return [
    [nw[0], nw[1]],
    [ne[0], ne[1]],
    [se[0], se[1]],
    [sw[0], sw[1]],
  ];
}

/** The ground image on the map. */
export interface ShownGround extends ShownFrame {
  /** How well it is placed, as the station said of this very frame. */
  readonly registration: string;
}

/** Between the layer, which knows what lies on the ground, and the note, which tells it. */
export interface GroundOnMap extends GroundWitness {
  readonly shown: Accessor<ShownGround | null>;
}

/** Keeps the facts of the ground image that is shown, as the source's states go on. */
export function createGroundOnMap(source: Pick<StationSource, "state">): GroundOnMap {
  const frame = createFrameOnScreen(source, announcedIn);
  const [registration, setRegistration] = createSignal("");
  return {
    run: frame.run,
    show: (image) => {
      setRegistration(image.registration);
      frame.show(image.frame_id);
    },
    shown: () => {
      const facts = frame.facts();
      return facts === null ? null : { ...facts, registration: registration() };
    },
  };
}

function announcedIn({ ground_image: image }: StationState) {
  return image === null ? null : { ...image, id: image.frame_id };
}
