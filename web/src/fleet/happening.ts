import type { ForecastView, StationState, SurveyView } from "../protocol";
import { text } from "../text/catalogue";
import { listNames } from "../text/names";
import { formatMinuteOfDay } from "../text/replay";
import { isFlyingNow } from "./vehicleStatus";

/** What happens now, as a sentence; null while nothing does. */
export function happening(state: StationState, behindS: number): string | null {
  const inPhase = (phase: SurveyView["phase"]) =>
    state.surveys.find((survey) => survey.phase === phase);
  const running = inPhase("running");
  if (running !== undefined) return surveying(running, state);
  if (inPhase("paused") !== undefined) return text.happening.paused;
  const [newest] = state.surveys;
  if (newest?.phase !== "done") return null;
  const flying = state.vehicles.filter((one) => !one.is_imager && isFlyingNow(one, behindS));
  if (flying.length > 0)
    return text.happening.landing(listNames(flying.map(({ name }) => name)), flying.length);
  return state.station.repeats_surveys ? text.happening.another : text.happening.complete;
}

function surveying({ planner, vehicles }: SurveyView, { shade, time_ns }: StationState): string {
  const flying = vehicles.filter((vehicle) => vehicle.is_flying_rows);
  const [waiting] = vehicles.filter((vehicle) => !vehicle.is_flying_rows);
  const names = listNames(flying.map(({ vehicle_name }) => vehicle_name));
  if (flying.length === 0)
    return waiting?.decision
      ? text.happening.waits(waiting.vehicle_name, waiting.decision)
      : text.happening.nobody;
  if (planner === "lawnmower_once") return text.happening.rows(names, flying.length);
  const forecast = shade?.forecast ?? null;
  if (forecast === null) return text.happening.unknownLight(names, flying.length);
  const later_s = moreSunIn(forecast);
  const time = later_s === null ? null : formatMinuteOfDay(time_ns / 1e6 + later_s * 1000);
  return text.happening.sunlit(names, flying.length, time);
}

/** A forecast for less of the field is not a forecast of the field. */
const LEAST_KNOWN = 0.5;
const LEAST_GAIN = 0.1;

/** When the field will have most sun, if that is clearly more than now and is known; seconds from now. */
function moreSunIn({ lead_s, sun_share, predicted_share }: ForecastView): number | null {
  let best = { share: (sun_share[0] ?? 0) + LEAST_GAIN, lead_s: null as number | null };
  for (const [index, lead] of lead_s.entries()) {
    const share = sun_share[index] ?? 0;
    const isKnown = (predicted_share[index] ?? 0) >= LEAST_KNOWN;
    if (isKnown && share > best.share) best = { share, lead_s: lead };
  }
  return best.lead_s;
}
