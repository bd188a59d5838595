import type { ImageSource, Map as MapLibre } from "maplibre-gl";
import { type Accessor, createSignal } from "solid-js";
import type { Outcome, Picture } from "../protocol";
import type { LightRequests } from "../source/lightRequests";
import type { SurveyRequests } from "../source/surveyRequests";
import { shownSurvey } from "../text/survey";
import { type Corners, cornersOf } from "./features";
import type { Layer, Scene } from "./scene";

/** Overlays on the ground image; one at a time, so that each can be read. */
export type OverlayKind = "none" | "shade" | "forecast" | "cells";

/** The selected overlay and forecast lead. */
export interface Overlay {
  readonly kind: Accessor<OverlayKind>;
  /** Lead of the displayed forecast, seconds after its shade map. */
  readonly lead_s: Accessor<number>;
  show(kind: OverlayKind): void;
  setLead(lead_s: number): void;
}

/** Until the operator selects an overlay, an active survey shows its coverage. */
export function createOverlay(isSurveyActive: Accessor<boolean> = () => false): Overlay {
  const [selected, select] = createSignal<OverlayKind | null>(null);
  const [lead_s, setLead] = createSignal(0);
  return {
    kind: () => selected() ?? (isSurveyActive() ? "cells" : "none"),
    lead_s,
    show: (kind) => {
      select(kind);
    },
    setLead,
  };
}

/** Wait this long (station time) before requesting a failed picture again. */
const RETRY_NS = 2e9;

/** The picture to show for a scene; `key` changes when a different picture is needed. */
export interface OverlayRequest {
  readonly key: string;
  readonly corners: readonly (readonly [number, number])[];
  fetch(): Promise<Outcome<Picture>>;
}

/** A picture of grid cells, above the ground image and below everything else. */
export abstract class PictureOverlay implements Layer {
  private map: MapLibre | null = null;
  private address: string | null = null;
  private shown: string | null = null;
  private wanted: OverlayRequest | null = null;
  private isFetching = false;
  private notBefore_ns = 0;

  protected constructor(private readonly id: string) {}

  /** The picture for this scene; null for none. */
  protected abstract requestFor(scene: Scene): OverlayRequest | null;

  add(map: MapLibre): void {
    this.map = map;
  }

  update(scene: Scene): void {
    this.wanted = this.requestFor(scene);
    if (this.wanted === null) this.clear();
    const isNew = this.wanted !== null && this.wanted.key !== this.shown;
    if (!isNew || this.isFetching || scene.state.time_ns < this.notBefore_ns) return;
    this.isFetching = true;
    this.notBefore_ns = scene.state.time_ns + RETRY_NS;
    void this.fetch(this.wanted as OverlayRequest).finally(() => {
      this.isFetching = false;
    });
  }

  recolour(): void {}

  private async fetch(request: OverlayRequest): Promise<void> {
    const outcome = await request.fetch();
    const corners = cornersOf(request.corners);
    // The overlay may have been switched off meanwhile.
    if (outcome.kind === "failed" || corners === null || this.wanted === null) return;
    this.notBefore_ns = 0;
    this.shown = request.key;
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

/** Current shade on the ground. */
export class ShadeLayer extends PictureOverlay {
  constructor(
    private readonly overlay: Overlay,
    private readonly light: Pick<LightRequests, "shadePicture">,
  ) {
    super("shade");
  }

  protected requestFor(scene: Scene): OverlayRequest | null {
    const map = scene.state.shade?.map ?? null;
    if (this.overlay.kind() !== "shade" || map === null) return null;
    const key = `${map.number}`;
    return { key, corners: map.corners, fetch: () => this.light.shadePicture(map.number) };
  }
}

/** Forecast probability of sun at a lead after the newest shade map. */
export class ForecastLayer extends PictureOverlay {
  constructor(
    private readonly overlay: Overlay,
    private readonly light: Pick<LightRequests, "forecastPicture">,
  ) {
    super("forecast");
  }

  protected requestFor(scene: Scene): OverlayRequest | null {
    const forecast = scene.state.shade?.forecast ?? null;
    const lead_s = this.overlay.lead_s();
    if (this.overlay.kind() !== "forecast" || forecast === null) return null;
    return {
      key: `${forecast.number}:${lead_s}`,
      corners: forecast.corners,
      fetch: () => this.light.forecastPicture(forecast.number, lead_s),
    };
  }
}

/** Survey coverage: cells photographed in sun (filled), in shade (striped), light unknown (hatched). */
export class SurveyCellsLayer extends PictureOverlay {
  constructor(
    private readonly overlay: Overlay,
    private readonly surveys: Pick<SurveyRequests, "cells">,
  ) {
    super("survey-cells");
  }

  protected requestFor(scene: Scene): OverlayRequest | null {
    const survey = shownSurvey(scene.state.surveys);
    const cells = survey?.cells ?? null;
    if (this.overlay.kind() !== "cells" || survey === null || cells === null) return null;
    return {
      key: `${survey.id}:${cells.number}`,
      corners: cells.corners,
      fetch: () => this.surveys.cells(survey.id, cells.number),
    };
  }
}
