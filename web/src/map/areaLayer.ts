import type { FillLayerSpecification, LineLayerSpecification, Map as MapLibre } from "maplibre-gl";
import type { AreaView } from "../protocol";
import { AreaLabels } from "./areaLabels";
import { areaFeatures, areasOf } from "./areas";
import type { Colours } from "./colours";
import { type Hatch, hatchImage } from "./hatch";
import type { Layer } from "./layer";
import { addFeatures, setFeatures } from "./lines";
import type { Scene } from "./scene";

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
