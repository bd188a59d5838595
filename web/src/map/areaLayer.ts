import type { FillLayerSpecification, LineLayerSpecification, Map as MapLibre } from "maplibre-gl";
import type { AreaView } from "../protocol";
import { areaFeatures, shownAreas } from "./areas";
import type { Colours } from "./colours";
import { addFeatures, setFeatures } from "./features";
import { type Hatch, hatchImage } from "./hatch";
import type { Layer, Scene } from "./scene";

/** Style of the areas of one kind. Kinds differ in line and fill, not only in colour. */
export interface AreaStyle {
  readonly kind: AreaView["kind"];
  colour(colours: Colours): string;
  readonly width_px: number;
  /** Lengths of dash and gap in line widths; null for a solid line. */
  readonly dash: readonly [number, number] | null;
  /** Fill pattern; null for no fill. */
  readonly hatch: Hatch | null;
}

/** The site's areas of one kind: outline and fill pattern. */
export class AreaLayer implements Layer {
  private map: MapLibre | null = null;
  private shown = "";
  private readonly id: string;

  constructor(private readonly style: AreaStyle) {
    this.id = `area-${style.kind}`;
  }

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    addFeatures(map, this.id);
    if (this.style.hatch !== null) {
      map.addImage(this.id, hatchImage(this.style.hatch, this.style.colour(colours)));
      map.addLayer(this.stripes());
    }
    map.addLayer(this.casing(colours));
    map.addLayer(this.outline(colours));
  }

  update(scene: Scene): void {
    if (this.map === null) return;
    const areas = shownAreas(scene.state).filter(({ kind }) => kind === this.style.kind);
    // Sites rarely change, and states arrive ten times a second.
    const shown = JSON.stringify(areas);
    if (shown === this.shown) return;
    this.shown = shown;
    setFeatures(this.map, this.id, areaFeatures(areas));
  }

  recolour(colours: Colours): void {
    const { map, style } = this;
    if (map === null) return;
    map.setPaintProperty(`${this.id}-casing`, "line-color", colours.casing);
    map.setPaintProperty(`${this.id}-line`, "line-color", style.colour(colours));
    if (style.hatch !== null)
      map.updateImage(this.id, hatchImage(style.hatch, style.colour(colours)));
  }

  private stripes(): FillLayerSpecification {
    const paint = { "fill-pattern": this.id };
    return { id: `${this.id}-fill`, type: "fill", source: this.id, paint };
  }

  /** Makes the line visible on the ground image too. */
  private casing(colours: Colours): LineLayerSpecification {
    const paint = {
      "line-color": colours.casing,
      "line-width": this.style.width_px + 2.5,
      "line-opacity": 0.7,
    };
    return { id: `${this.id}-casing`, type: "line", source: this.id, paint };
  }

  private outline(colours: Colours): LineLayerSpecification {
    const { style } = this;
    const paint = { "line-color": style.colour(colours), "line-width": style.width_px };
    const dashed = style.dash === null ? paint : { ...paint, "line-dasharray": [...style.dash] };
    return { id: `${this.id}-line`, type: "line", source: this.id, paint: dashed };
  }
}

/** The flight boundary: a thick solid line. */
export class BoundaryLayer extends AreaLayer {
  constructor() {
    super({
      kind: "boundary",
      colour: (colours) => colours.boundary,
      width_px: 4,
      dash: null,
      hatch: null,
    });
  }
}

/** Zones with a floor and a ceiling: wide stripes inside a dashed line. */
export class HeightZoneLayer extends AreaLayer {
  constructor() {
    super({
      kind: "height",
      colour: (colours) => colours.heightZone,
      width_px: 2.5,
      dash: [4, 2],
      hatch: { isCrossed: false, tile_px: 20, stripe_px: 2, opacity: 0.45 },
    });
  }
}

/** Keep-out zones: crossed stripes inside a heavy line. */
export class KeepOutLayer extends AreaLayer {
  constructor() {
    super({
      kind: "keep_out",
      colour: (colours) => colours.keepOut,
      width_px: 3,
      dash: null,
      hatch: { isCrossed: true, tile_px: 12, stripe_px: 2, opacity: 0.55 },
    });
  }
}

/** Survey regions: a dotted line. */
export class SurveyLayer extends AreaLayer {
  constructor() {
    super({
      kind: "survey",
      colour: (colours) => colours.survey,
      width_px: 2,
      dash: [1, 2],
      hatch: null,
    });
  }
}
