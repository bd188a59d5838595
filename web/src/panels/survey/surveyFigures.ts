import { createSignal } from "solid-js";
import type { Kept } from "../../map/baseMaps";
import type { SurveyCameraView } from "../../protocol";
import { createLengthField, numberIn } from "../../text/units";
import { bestInterval, heightFor, type Lens, mostSpeed, OTHER, pixelAt } from "./surveyNumbers";

/** Heights that can be planned, above takeoff or above ground, and the one offered. */
export const [LOWEST_M, HIGHEST_M] = [10, 120];
const USUAL_HEIGHT_M = 50;
const USUAL_INTERVAL_S = 2;
const STORED_AS = "recon.surveyCamera";

export type SurveyFigures = ReturnType<typeof createSurveyFigures>;

/**
 * The numbers of a new survey: what is typed, and what follows from it. Height follows from the pixel on
 * the ground and sets it; speed and interval are the best ones until they are typed.
 */
export function createSurveyFigures(of: {
  readonly cameras: () => readonly SurveyCameraView[];
  /** The camera that the drones have, by the site's table; empty if they differ. */
  readonly usualCamera: () => string;
  readonly fastest_mps: () => number;
  readonly kept: Kept;
}) {
  const height = createLengthField(USUAL_HEIGHT_M);
  const [chosen, choose] = createSignal(of.kept.getItem(STORED_AS));
  const [isAboveGround, setAboveGround] = createSignal(false);
  const [front, setFront] = createSignal("75");
  const [sideways, setSideways] = createSignal("60");
  const [bearing, setBearing] = createSignal("");
  const [typedSpeed, typeSpeed] = createSignal("");
  const [typedInterval, typeInterval] = createSignal("");
  const camera = () => {
    const named = (name: string | null) => of.cameras().find((each) => each.name === name);
    return chosen() === "" ? null : (named(chosen()) ?? named(of.usualCamera()) ?? null);
  };
  const lens = (): Lens => camera() ?? OTHER;
  const flown = () => ({
    height_m: height.metres() ?? USUAL_HEIGHT_M,
    frontOverlap: (numberIn(front()) ?? 0) / 100,
    fastest_mps: of.fastest_mps(),
    stops: isAboveGround(),
  });
  const timer_s = () => camera()?.timer_s ?? [];
  const interval_s = () => {
    const typed = numberIn(typedInterval());
    if (timer_s().length === 0) return typed ?? USUAL_INTERVAL_S;
    return typed !== null && timer_s().includes(typed)
      ? typed
      : bestInterval(lens(), timer_s(), flown());
  };
  const speed_mps = () => numberIn(typedSpeed()) ?? mostSpeed(lens(), interval_s(), flown());
  return {
    height,
    camera,
    timer_s,
    interval_s,
    isAboveGround,
    setAboveGround,
    front: [front, setFront] as const,
    sideways: [sideways, setSideways] as const,
    bearing: [bearing, setBearing] as const,
    typeInterval,
    typeSpeed,
    chooseCamera: (name: string) => {
      choose(name);
      of.kept.setItem(STORED_AS, name);
    },
    speed_mps,
    /** Centimetres on the ground as text; empty while the camera's pixels are not known. */
    pixel: () => {
      const pixel_m = pixelAt(lens(), flown().height_m);
      return pixel_m === null ? "" : String(Number((100 * pixel_m).toFixed(2)));
    },
    typePixel: (text: string) => {
      const pixel_cm = numberIn(text);
      const height_m = pixel_cm === null ? null : heightFor(lens(), pixel_cm / 100);
      if (height_m !== null) height.set(height_m);
    },
    /** What a request has of them; null while one is not a number. */
    asked: () => {
      const height_m = height.metres();
      const [front_pc, side_pc] = [numberIn(front()), numberIn(sideways())];
      if (height_m === null || front_pc === null || side_pc === null) return null;
      return {
        ...(isAboveGround()
          ? { height_above_ground_m: height_m }
          : { height_above_takeoff_m: height_m }),
        speed_mps: speed_mps(),
        front_overlap: front_pc / 100,
        side_overlap: side_pc / 100,
        row_bearing_deg: numberIn(bearing()),
        camera: { model: camera()?.name ?? null, interval_s: interval_s() },
      };
    },
  };
}
