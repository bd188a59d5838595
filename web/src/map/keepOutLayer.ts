import { AreaLayer } from "./areaLayer";

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
