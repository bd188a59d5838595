import { AreaLayer } from "./areaLayer";

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
