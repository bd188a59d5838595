import { type Accessor, createMemo, createSignal } from "solid-js";
import type { LonLat } from "../map/localGrid";
import type { NewZone, ZoneKind } from "../protocol";
import { createLengthField, type LengthField, numberIn } from "../text/units";
import { ZONE_KINDS } from "../text/zones";

const RADIUS_M = 20;

/** As many as the station takes. */
const MOST_CORNERS = 64;

export type ZoneShape = "circle" | "outline";

/** A temporary zone being drawn: presses on the map set its centre, or add corners. */
export interface ZoneDraft {
  readonly isOn: Accessor<boolean>;
  readonly kind: Accessor<ZoneKind>;
  readonly shape: Accessor<ZoneShape>;
  /** The centre of a circle, or the corners of an outline so far. */
  readonly points: Accessor<readonly LonLat[]>;
  /** Of a circle. */
  readonly radius: LengthField;
  /** As typed: minutes (empty: until ended), and words (empty: the kind's own). */
  readonly minutes: Accessor<string>;
  readonly reason: Accessor<string>;
  /** What to send; null while a part is missing or not a number. */
  readonly zone: Accessor<NewZone | null>;
  /** The radius in metres of a circle; null for an outline or while it is not a number. */
  readonly radius_m: Accessor<number | null>;
  toggle(): void;
  /** Removes the points, else leaves the mode. Returns false when neither was set. */
  clear(): boolean;
  leave(): void;
  aim(at: LonLat): void;
  undo(): void;
  setKind(kind: ZoneKind): void;
  setShape(shape: ZoneShape): void;
  setMinutes(text: string): void;
  setReason(text: string): void;
}

export function createZoneDraft(): ZoneDraft {
  const [isOn, setOn] = createSignal(false);
  const [kind, setKind] = createSignal<ZoneKind>("person");
  const [shape, setShape] = createSignal<ZoneShape>("circle");
  const [points, setPoints] = createSignal<readonly LonLat[]>([]);
  const radius = createLengthField(RADIUS_M);
  const [minutes, setMinutes] = createSignal("");
  const [reason, setReason] = createSignal("");
  const radius_m = createMemo(() => (shape() === "circle" ? radius.metres() : null));
  const leave = () => {
    setPoints([]);
    setReason("");
    setOn(false);
  };
  const zone = createMemo<NewZone | null>(() => {
    const place = placed(shape(), points(), radius_m());
    const lasts = numberIn(minutes());
    if (place === null || (minutes().trim() !== "" && lasts === null)) return null;
    return {
      kind: kind(),
      reason: reason().trim() || ZONE_KINDS[kind()].reason,
      lasts_s: lasts === null ? null : lasts * 60,
      ...place,
    };
  });
  return {
    isOn,
    kind,
    shape,
    points,
    radius,
    minutes,
    reason,
    zone,
    radius_m,
    toggle: () => (isOn() ? leave() : setOn(true)),
    clear: () => {
      if (!isOn()) return false;
      if (points().length === 0) leave();
      else setPoints([]);
      return true;
    },
    leave,
    aim: (at) => {
      if (!isOn()) return;
      if (shape() === "circle") setPoints([at]);
      else if (points().length < MOST_CORNERS) setPoints([...points(), at]);
    },
    undo: () => setPoints(points().slice(0, -1)),
    setKind,
    setShape: (next) => {
      setShape(next);
      setPoints(points().slice(0, 1));
    },
    setMinutes,
    setReason,
  };
}

function placed(
  shape: ZoneShape,
  points: readonly LonLat[],
  radius_m: number | null,
): Pick<NewZone, "circle" | "outline"> | null {
  const places = points.map(({ lat, lon }) => ({ latitude_deg: lat, longitude_deg: lon }));
  if (shape === "outline") return places.length < 3 ? null : { outline: places };
  const [centre] = places;
  if (centre === undefined || radius_m === null || radius_m <= 0) return null;
  return { circle: { ...centre, radius_m } };
}
