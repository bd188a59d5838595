import {
  type FillLayerSpecification,
  type LineLayerSpecification,
  type Map as MapLibre,
  Marker,
} from "maplibre-gl";
import type { AreaView } from "../protocol";
import { areaFeatures, areasOf, areaText, extent, labelPoint } from "./areas";
import type { Colours } from "./colours";
import { addFeatures, setFeatures } from "./features";
import { type Hatch, hatchImage } from "./hatch";
import type { Layer, Scene } from "./scene";

/** How the areas of one kind look. Each differs from the others in line and filling, not in colour alone. */
export interface AreaLook {
  readonly kind: AreaView["kind"];
  colour(colours: Colours): string;
  readonly width_px: number;
  /** Lengths of dash and gap in line widths; null for a whole line. */
  readonly dash: readonly [number, number] | null;
  /** Stripes that fill the area; null leaves it empty. */
  readonly hatch: Hatch | null;
}

/** The site's areas of one kind: outline, stripes, names. */
export class AreaLayer implements Layer {
  private map: MapLibre | null = null;
  private shown = "";
  private readonly labels: AreaLabels;
  private readonly id: string;

  constructor(private readonly look: AreaLook) {
    this.id = `area-${look.kind}`;
    this.labels = new AreaLabels(`area-label-${look.kind}`);
  }

  add(map: MapLibre, colours: Colours): void {
    this.map = map;
    addFeatures(map, this.id);
    if (this.look.hatch !== null) {
      map.addImage(this.id, hatchImage(this.look.hatch, this.look.colour(colours)));
      map.addLayer(this.stripes());
    }
    map.addLayer(this.casing(colours));
    map.addLayer(this.outline(colours));
    this.labels.add(map);
  }

  update(scene: Scene): void {
    if (this.map === null) return;
    const { site } = scene.state;
    const areas = areasOf(site, this.look.kind);
    // A site hardly ever changes, and states come ten times a second.
    const shown = JSON.stringify(areas);
    if (shown === this.shown) return;
    this.shown = shown;
    setFeatures(this.map, this.id, areaFeatures(site, this.look.kind));
    this.labels.show(areas);
  }

  recolour(colours: Colours): void {
    const { map, look } = this;
    if (map === null) return;
    map.setPaintProperty(`${this.id}-casing`, "line-color", colours.casing);
    map.setPaintProperty(`${this.id}-line`, "line-color", look.colour(colours));
    if (look.hatch !== null) map.updateImage(this.id, hatchImage(look.hatch, look.colour(colours)));
  }

  private stripes(): FillLayerSpecification {
    const paint = { "fill-pattern": this.id };
    return { id: `${this.id}-fill`, type: "fill", source: this.id, paint };
  }

  /** So that the line stands out on a picture of the ground too. */
  private casing(colours: Colours): LineLayerSpecification {
    const paint = {
      "line-color": colours.casing,
      "line-width": this.look.width_px + 2.5,
      "line-opacity": 0.7,
    };
    return { id: `${this.id}-casing`, type: "line", source: this.id, paint };
  }

  private outline(colours: Colours): LineLayerSpecification {
    const { look } = this;
    const paint = { "line-color": look.colour(colours), "line-width": look.width_px };
    const dashed = look.dash === null ? paint : { ...paint, "line-dasharray": [...look.dash] };
    return { id: `${this.id}-line`, type: "line", source: this.id, paint: dashed };
  }
}

/** The line nobody flies over: thick and whole. */
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

/** Where one flies between a floor and a ceiling only: wide stripes in a dashed line. */
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

/** Where nobody flies: crossed stripes in a heavy line. */
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

/** What is to be looked at: a dotted line that forbids nothing. */
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

/** An area narrower than this on the screen has no room for its label; nearer to it, it has. */
const LEAST_WIDTH_PX = 40;

interface Placed {
  readonly area: AreaView;
  readonly marker: Marker;
}

/** The names of areas, with their heights: the map has no letters of its own. */
export class AreaLabels {
  private map: MapLibre | null = null;
  private placed: readonly Placed[] = [];

  constructor(private readonly className: string) {}

  add(map: MapLibre): void {
    this.map = map;
    map.on("zoom", () => this.hideThoseWithoutRoom());
  }

  show(areas: readonly AreaView[]): void {
    const { map } = this;
    if (map === null) return;
    for (const { marker } of this.placed) marker.remove();
    this.placed = areas.map((area) => {
      const { lon, lat } = labelPoint(area);
      const marker = new Marker({ element: this.element(area), anchor: "center" });
      marker.setLngLat([lon, lat]).addTo(map);
      return { area, marker };
    });
    this.hideThoseWithoutRoom();
  }

  private element(area: AreaView): HTMLElement {
    const element = document.createElement("span");
    element.className = `area-label ${this.className}`;
    element.textContent = areaText(area);
    return element;
  }

  private hideThoseWithoutRoom(): void {
    const { map } = this;
    if (map === null) return;
    for (const { area, marker } of this.placed) {
      const { west, east, north } = extent(area);
      const width_px = map.project([east, north]).x - map.project([west, north]).x;
      marker.getElement().hidden = width_px < LEAST_WIDTH_PX;
    }
  }
}
