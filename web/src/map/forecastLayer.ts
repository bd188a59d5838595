import type { StationSource } from "../source/stationSource";
import type { Overlay } from "./overlay";
import { PictureOverlay, type Wanted } from "./pictureOverlay";
import type { Scene } from "./scene";

/** How likely the ground lies in sun, so many seconds after the newest shade map. */
export class ForecastLayer extends PictureOverlay {
  constructor(
    private readonly overlay: Overlay,
    private readonly source: Pick<StationSource, "forecastPicture">,
  ) {
    super("forecast");
  }

  protected want(scene: Scene): Wanted | null {
    const forecast = scene.state.shade?.forecast ?? null;
    const lead_s = this.overlay.lead_s();
    if (this.overlay.kind() !== "forecast" || forecast === null) return null;
    return {
      key: `${forecast.number}:${lead_s}`,
      corners: forecast.corners,
      bring: () => this.source.forecastPicture(forecast.number, lead_s),
    };
  }
}
