import { AreaLayer } from "./areaLayer";

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
