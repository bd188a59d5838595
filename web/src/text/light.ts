import type { LightSensorView, LightSharesView } from "../protocol";

/** Without a state of the station for so long nothing is shown as live. */
const LIVE_S = 10;

/** Whether a light sensor's value is of now, also while no new state arrives. */
export function isSensorLive(sensor: LightSensorView, behindS: number): boolean {
  return sensor.is_live && behindS < LIVE_S;
}

/** Shares of the ground in view in whole per cent; they add up to 100. */
export interface LightPercents {
  readonly sun: number;
  readonly shade: number;
  readonly unknown: number;
}

/** Sun is rounded down and unknown up, so that the light never reads better known than it is. */
export function lightPercents({ sun, unknown }: LightSharesView): LightPercents {
  const sunny = Math.floor(100 * sun + 1e-6);
  const undecided = Math.max(0, Math.min(100 - sunny, Math.ceil(100 * unknown - 1e-6)));
  return { sun: sunny, shade: 100 - sunny - undecided, unknown: undecided };
}
