import type { ImageSource, Map as MapLibre } from "maplibre-gl";
import type { GroundImageView } from "../protocol";
import type { Outcome } from "../source/stationSource";
import type { Colours } from "./colours";
import type { Layer } from "./layer";
import type { Scene } from "./scene";

const SOURCE = "ground-image";
const LAYER = "ground-image";

/** After a picture that did not come, wait so long (station time) before asking again. */
const RETRY_NS = 2e9;

type Corner = [number, number];
type Corners = [Corner, Corner, Corner, Corner];

/** The newest frame of the imaging vehicle, laid on the ground under everything else. */
export class GroundImageLayer implements Layer {
  private map: MapLibre | null = null;
  private shownFrame: number | null = null;
  private isFetching = false;
  private address: string | null = null;
  private notBefore_ns = 0;

  /** `fetchImage` brings the picture of a frame. */
  constructor(private readonly fetchImage: (frameId: number) => Promise<Outcome<Blob>>) {}

  add(map: MapLibre, _colours: Colours): void {
    this.map = map;
  }

  update(scene: Scene): void {
    const image = scene.state.ground_image;
    // One at a time: on a slow link the newest is fetched next, those between are passed over.
    if (image === null || this.isFetching || image.frame_id === this.shownFrame) return;
    if (scene.state.time_ns < this.notBefore_ns) return;
    this.isFetching = true;
    this.notBefore_ns = scene.state.time_ns + RETRY_NS;
    void this.bring(image).finally(() => {
      this.isFetching = false;
    });
  }

  recolour(_colours: Colours): void {}

  private async bring(image: GroundImageView): Promise<void> {
    const corners = cornersOf(image);
    const outcome = await this.fetchImage(image.frame_id);
    if (outcome.kind === "failed" || corners === null) return;
    this.shownFrame = image.frame_id;
    this.notBefore_ns = 0;
    const before = this.address;
    this.address = URL.createObjectURL(outcome.value);
    await this.show(this.address, corners);
    if (before !== null) URL.revokeObjectURL(before);
  }

  private async show(url: string, coordinates: Corners): Promise<void> {
    const source = this.map?.getSource<ImageSource>(SOURCE);
    if (source === undefined) this.addImage(url, coordinates);
    else source.updateImage({ url, coordinates });
    await loaded(url);
  }

  private addImage(url: string, coordinates: Corners): void {
    if (this.map === null) return;
    this.map.addSource(SOURCE, { type: "image", url, coordinates });
    const lowest = this.map.getStyle().layers.find((layer) => layer.type !== "background");
    const paint = { "raster-fade-duration": 0, "raster-resampling": "linear" } as const;
    this.map.addLayer({ id: LAYER, type: "raster", source: SOURCE, paint }, lowest?.id);
  }
}

/** Waits until the browser has read the picture, so that its address may go. */
async function loaded(url: string): Promise<void> {
  const image = new Image();
  image.src = url;
  await image.decode().catch(() => undefined);
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
