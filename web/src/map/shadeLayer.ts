import type { StationSource } from "../source/stationSource";
import type { Overlay } from "./overlay";
import { PictureOverlay, type Wanted } from "./pictureOverlay";
import type { Scene } from "./scene";

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
