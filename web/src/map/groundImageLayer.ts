import type { ImageSource, Map as MapLibre } from "maplibre-gl";
import { type Accessor, createSignal } from "solid-js";
import { createDisplayedFrame, type FrameInfo } from "../fleet/displayedFrame";
import type { GroundImageView, Outcome, Picture, StationState } from "../protocol";
import type { StationSource } from "../source/stationSource";
import { BASE_MAP } from "./baseMapLayer";
import { type Corners, cornersOf } from "./features";
import type { Layer, Scene } from "./scene";

const SOURCE = "ground-image";
const LAYER = "ground-image";
/** Wait this long (station time) before requesting a failed picture again. */
const RETRY_NS = 2e9;
/** Number of frame positions kept while their pictures are loading. */
const MAX_PLACES = 8;

/** Notified of the displayed ground image; `run` counts restarts of the station. */
export interface GroundImageListener {
  readonly run: () => number;
  /** The picture of this frame is now on the map. */
  show(image: GroundImageView): void;
}

interface Place {
  readonly image: GroundImageView;
  readonly corners: Corners;
}

/** The newest frame of the imaging drone, drawn below everything but a base map. */
export class GroundImageLayer implements Layer {
  private map: MapLibre | null = null;
  private readonly places = new Map<number, Place>();
  private waiting: { readonly blob: Blob; readonly frameId: number } | null = null;
  private shownFrame: number | null = null;
  private isFetching = false;
  private address: string | null = null;
  private notBefore_ns = 0;
  private run = 0;

  /** `fetchImage` returns the newest picture with its frame number. */
  constructor(
    private readonly fetchImage: (frameId: number) => Promise<Outcome<Picture>>,
    private readonly listener: GroundImageListener,
  ) {}

  add(map: MapLibre): void {
    this.map = map;
  }

  update(scene: Scene): void {
    const image = scene.state.ground_image;
    this.checkRestart();
    if (image === null) return;
    this.remember(image);
    this.showWaiting();
    // One request at a time: on a slow link the newest frame is next and those between are skipped.
    const isWanted = image.frame_id !== this.shownFrame && this.waiting === null;
    if (!isWanted || this.isFetching || scene.state.time_ns < this.notBefore_ns) return;
    this.isFetching = true;
    this.notBefore_ns = scene.state.time_ns + RETRY_NS;
    void this.load(image.frame_id).finally(() => {
      this.isFetching = false;
    });
  }

  recolour(): void {}

  /** Frame numbers start over with the station, so earlier ones are invalid. */
  private checkRestart(): void {
    const run = this.listener.run();
    if (run === this.run) return;
    this.run = run;
    this.places.clear();
    this.waiting = null;
    this.shownFrame = null;
    this.notBefore_ns = 0;
  }

  private async load(requestedId: number): Promise<void> {
    const { run } = this;
    const outcome = await this.fetchImage(requestedId);
    if (outcome.kind === "failed" || run !== this.run) return;
    const { blob, frameId } = outcome.value;
    // Without a frame number its position and age are unknown.
    if (frameId === null) return;
    this.waiting = { blob, frameId };
    this.notBefore_ns = 0;
    this.showWaiting();
  }

  private remember(image: GroundImageView): void {
    const corners = cornersOf(image.corners);
    if (corners !== null) this.places.set(image.frame_id, { image, corners });
    for (const known of this.places.keys()) {
      if (this.places.size <= MAX_PLACES) break;
      this.places.delete(known);
    }
  }

  /** Shows the loaded picture once its position is known; never at another frame's position. */
  private showWaiting(): void {
    const waiting = this.waiting;
    if (waiting === null) return;
    const place = this.places.get(waiting.frameId);
    const newest = Math.max(...this.places.keys());
    // A state with its position may still arrive, but not after a later frame's.
    if (place !== undefined || newest > waiting.frameId) this.waiting = null;
    if (place === undefined) return;
    this.shownFrame = waiting.frameId;
    this.show(URL.createObjectURL(waiting.blob), place.corners);
    this.listener.show(place.image);
  }

  private show(url: string, coordinates: Corners): void {
    const before = this.address;
    this.address = url;
    const source = this.map?.getSource<ImageSource>(SOURCE);
    if (source === undefined) this.addImage(url, coordinates);
    else source.updateImage({ url, coordinates });
    // MapLibre has loaded the previous image, or has just dropped it.
    if (before !== null) URL.revokeObjectURL(before);
  }

  private addImage(url: string, coordinates: Corners): void {
    if (this.map === null) return;
    this.map.addSource(SOURCE, { type: "image", url, coordinates });
    // A map from a file would hide it.
    const over = this.map
      .getStyle()
      .layers.find(({ id, type }) => type !== "background" && id !== BASE_MAP);
    const paint = { "raster-fade-duration": 0, "raster-resampling": "linear" } as const;
    this.map.addLayer({ id: LAYER, type: "raster", source: SOURCE, paint }, over?.id);
  }
}

/** How a frame was aligned with the ground, and how well in metres. */
type Alignment = Pick<GroundImageView, "registration" | "registration_residual_m">;

/** The displayed ground image. */
export interface GroundImageInfo extends FrameInfo, Alignment {}

/** Connects the layer, which displays the ground image, and the note, which describes it. */
export interface DisplayedGround extends GroundImageListener {
  readonly shown: Accessor<GroundImageInfo | null>;
}

/** Tracks the displayed ground image over the source's states. */
export function createDisplayedGround(source: Pick<StationSource, "state">): DisplayedGround {
  const frame = createDisplayedFrame(source, announcedIn);
  const [alignment, setAlignment] = createSignal<Alignment>({
    registration: "unregistered",
    registration_residual_m: null,
  });
  return {
    run: frame.run,
    show: (image) => {
      const { registration, registration_residual_m } = image;
      setAlignment({ registration, registration_residual_m });
      frame.show(image.frame_id);
    },
    shown: () => {
      const info = frame.info();
      return info === null ? null : { ...info, ...alignment() };
    },
  };
}

function announcedIn({ ground_image: image }: StationState) {
  return image === null ? null : { ...image, id: image.frame_id };
}
