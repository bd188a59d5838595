import { AreaLayer } from "./areaLayer";

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
