import type { ImageSource, Map as MapLibre } from "maplibre-gl";
import { type Accessor, createSignal } from "solid-js";
import type { Outcome, Picture, StationSource } from "../source/stationSource";
import { shownSurvey } from "../text/survey";
import type { Layer, Scene } from "./scene";

/** What lies over the ground image: one at a time, so that each can be read. */
export type OverlayKind = "none" | "shade" | "forecast" | "cells";

/** Which overlay the map shows, and for which lead. */
export interface Overlay {
  readonly kind: Accessor<OverlayKind>;
  /** How far ahead the forecast is shown, seconds from its shade map. */
  readonly lead_s: Accessor<number>;
  show(kind: OverlayKind): void;
  lookAhead(lead_s: number): void;
}

/** Until somebody chooses, a survey that is flown shows its cells: they are what is flown for. */
export function createOverlay(isSurveyFlown: Accessor<boolean> = () => false): Overlay {
  const [chosen, show] = createSignal<OverlayKind | null>(null);
  const [lead_s, lookAhead] = createSignal(0);
  return {
    kind: () => chosen() ?? (isSurveyFlown() ? "cells" : "none"),
    lead_s,
    show: (kind) => {
      show(kind);
    },
    lookAhead,
  };
}

/** After a picture that did not come, wait so long (station time) before asking again. */
const RETRY_NS = 2e9;

/** A picture that a moment asks for; `key` changes whenever another picture would come. */
export interface Wanted {
  readonly key: string;
  readonly corners: readonly (readonly [number, number])[];
  bring(): Promise<Outcome<Picture>>;
}

type Corners = [[number, number], [number, number], [number, number], [number, number]];

/** A picture of the ground's cells, over the ground image and under everything else. */
export abstract class PictureOverlay implements Layer {
  private map: MapLibre | null = null;
  private address: string | null = null;
  private shown: string | null = null;
  private wanted: Wanted | null = null;
  private isFetching = false;
  private notBefore_ns = 0;

  protected constructor(private readonly id: string) {}

  /** What the scene asks for; null shows nothing. */
  protected abstract want(scene: Scene): Wanted | null;

  add(map: MapLibre): void {
    this.map = map;
  }

  update(scene: Scene): void {
    this.wanted = this.want(scene);
    if (this.wanted === null) this.clear();
    const isNew = this.wanted !== null && this.wanted.key !== this.shown;
    if (!isNew || this.isFetching || scene.state.time_ns < this.notBefore_ns) return;
    this.isFetching = true;
    this.notBefore_ns = scene.state.time_ns + RETRY_NS;
    void this.fetch(this.wanted as Wanted).finally(() => {
      this.isFetching = false;
    });
  }

  recolour(): void {}

  private async fetch(asked: Wanted): Promise<void> {
    const outcome = await asked.bring();
    const corners = cornersOf(asked.corners);
    // What was asked for may be switched off by now; a newer picture of the same is shown next.
    if (outcome.kind === "failed" || corners === null || this.wanted === null) return;
    this.notBefore_ns = 0;
    this.shown = asked.key;
    this.show(URL.createObjectURL(outcome.value.blob), corners);
  }

  private show(url: string, coordinates: Corners): void {
    const before = this.address;
    this.address = url;
    const source = this.map?.getSource<ImageSource>(this.id);
    if (source === undefined) this.addImage(url, coordinates);
    else source.updateImage({ url, coordinates });
    if (before !== null) URL.revokeObjectURL(before);
  }

  private clear(): void {
    if (this.address === null || this.map === null) return;
    this.map.removeLayer(this.id);
    this.map.removeSource(this.id);
    URL.revokeObjectURL(this.address);
    this.address = null;
    this.shown = null;
  }

  private addImage(url: string, coordinates: Corners): void {
    if (this.map === null) return;
    this.map.addSource(this.id, { type: "image", url, coordinates });
    const over = this.map
      .getStyle()
      .layers.find(({ type }) => !["background", "raster"].includes(type));
    const paint = { "raster-fade-duration": 0, "raster-resampling": "nearest" } as const;
    this.map.addLayer({ id: this.id, type: "raster", source: this.id, paint }, over?.id);
  }
}

function cornersOf(corners: Wanted["corners"]): Corners | null {
  const [nw, ne, se, sw] = corners;
  if (nw === undefined || ne === undefined || se === undefined || sw === undefined) return null;
  return [
    [nw[0], nw[1]],
    [ne[0], ne[1]],
    [se[0], se[1]],
    [sw[0], sw[1]],
  ];
}

/** Where the ground lies in shade now. */
export class ShadeLayer extends PictureOverlay {
  constructor(
    private readonly overlay: Overlay,
    private readonly source: Pick<StationSource, "shadePicture">,
  ) {
    super("shade");
  }

  protected want(scene: Scene): Wanted | null {
    const map = scene.state.shade?.map ?? null;
    if (this.overlay.kind() !== "shade" || map === null) return null;
    const key = `${map.number}`;
    return { key, corners: map.corners, bring: () => this.source.shadePicture(map.number) };
  }
}

/** How likely the ground lies in sun, so many seconds after the newest shade map. */
export class ForecastLayer extends PictureOverlay {
  constructor(
    private readonly overlay: Overlay,
    private readonly source: Pick<StationSource, "forecastPicture">,
  ) {
    super("forecast");
  }

  protected want(scene: Scene): Wanted | null {
    const forecast = scene.state.shade?.forecast ?? null;
    const lead_s = this.overlay.lead_s();
    if (this.overlay.kind() !== "forecast" || forecast === null) return null;
    return {
      key: `${forecast.number}:${lead_s}`,
      corners: forecast.corners,
      bring: () => this.source.forecastPicture(forecast.number, lead_s),
    };
  }
}

/** Which cells of a survey are imaged in sun (filled), in shade (striped), or not yet (empty). */
export class SurveyCellsLayer extends PictureOverlay {
  constructor(
    private readonly overlay: Overlay,
    private readonly source: Pick<StationSource, "surveyCells">,
  ) {
    super("survey-cells");
  }

  protected want(scene: Scene): Wanted | null {
    const survey = shownSurvey(scene.state.surveys);
    const cells = survey?.cells ?? null;
    if (this.overlay.kind() !== "cells" || survey === null || cells === null) return null;
    return {
      key: `${survey.id}:${cells.number}`,
      corners: cells.corners,
      bring: () => this.source.surveyCells(survey.id, cells.number),
    };
  }
}
