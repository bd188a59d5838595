import { type Map as MapLibre, Marker } from "maplibre-gl";
import type { PadView, StationState } from "../protocol";
import { text } from "../text/catalogue";
import type { Layer, Scene } from "./scene";

/** Landing pads: an H in a square, with the name of the vehicle it is reserved for, if any. */
export class PadLayer implements Layer {
  private map: MapLibre | null = null;
  private markers: Marker[] = [];
  private shown = "";

  add(map: MapLibre): void {
    this.map = map;
  }

  update(scene: Scene): void {
    const { map } = this;
    if (map === null) return;
    const pads = scene.state.site?.pads ?? [];
    const names = pads.map((pad) => padText(pad, scene.state));
    const shown = JSON.stringify([pads, names]);
    if (shown === this.shown) return;
    this.shown = shown;
    for (const marker of this.markers) marker.remove();
    this.markers = pads.map((pad, index) =>
      new Marker({ element: padElement(names[index] ?? ""), anchor: "center" })
        .setLngLat([pad.longitude_deg, pad.latitude_deg])
        .addTo(map),
    );
  }

  recolour(): void {}
}

/** A pad's name and the vehicle it is reserved for, by name once that vehicle has connected. */
export function padText(pad: PadView, state: StationState): string {
  if (pad.serial === null) return text.map.padOfAny(pad.name);
  const owner = state.vehicles.find((vehicle) => vehicle.serial === pad.serial);
  return text.map.padOf(pad.name, owner?.name ?? pad.serial);
}

function padElement(pad: string): HTMLElement {
  const element = document.createElement("span");
  element.className = "pad";
  element.title = text.map.pad(pad);
  element.textContent = text.map.padSign;
  const read = document.createElement("span");
  read.className = "hidden-but-read";
  read.textContent = text.map.padRead(pad);
  element.append(read);
  return element;
}
