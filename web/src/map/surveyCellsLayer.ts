import type { StationSource } from "../source/stationSource";
import { shownSurvey } from "../words/survey";
import type { Overlay } from "./overlay";
import { PictureOverlay, type Wanted } from "./pictureOverlay";
import type { Scene } from "./scene";

/** Which cells of a survey are imaged in sun (filled), in shade (striped), or not yet (empty). */
export class SurveyCellsLayer extends PictureOverlay {
  constructor(
    private readonly overlay: Overlay,
    private readonly source: Pick<StationSource, "surveyCells">,
  ) {
    super("survey-cells");
  }

  protected want(scene: Scene): Wanted | null {
    const survey = shownSurvey(scene.state.surveys);
    const cells = survey?.cells ?? null;
    if (this.overlay.kind() !== "cells" || survey === null || cells === null) return null;
    return {
      key: `${survey.id}:${cells.number}`,
      corners: cells.corners,
      bring: () => this.source.surveyCells(survey.id, cells.number),
    };
  }
}
