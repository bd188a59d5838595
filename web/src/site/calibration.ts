import { type Accessor, createMemo, createSignal } from "solid-js";
import type { LonLat } from "../map/localGrid";
import type { CalibrationView, ControlPointView } from "../protocol";
import type { Clock } from "../source/clock";
import type { SiteRequests } from "../source/siteRequests";
import { text } from "../text/catalogue";
import type { Notice } from "./savedDraft";

/*
 * Theory of operation. A frame of the imaging drone is frozen by the station, which keeps its telemetry. Points
 * are marked here: a press on the frame and one on the map make one, in either order. What a press sets belongs
 * to the selected point; once that has both, a press on the frame begins the next. After each change the station
 * solves the camera's pose by the points that have both, and answers with the residual of each, or with
 * the reason why they give no pose.
 */

export interface Pixel {
  readonly col: number;
  readonly row: number;
}

/** A control point being marked. */
export interface MarkedPoint {
  readonly id: number;
  readonly name: string;
  readonly pixel: Pixel | null;
  readonly place: LonLat | null;
  /** Above the WGS84 ellipsoid; null: on the site's ground. */
  readonly altitude_m: number | null;
}

export interface FrozenFrame {
  readonly serial: string;
  readonly id: number;
  readonly cols: number;
  readonly rows: number;
  readonly picture: Blob;
  readonly surveyed: readonly ControlPointView[];
}

export interface Calibration {
  /** A frame is frozen: presses on the map place points. */
  readonly isOn: Accessor<boolean>;
  readonly isBusy: Accessor<boolean>;
  readonly frame: Accessor<FrozenFrame | null>;
  readonly points: Accessor<readonly MarkedPoint[]>;
  readonly selected: Accessor<MarkedPoint | null>;
  /** The newest answer about these points; null while one is awaited. */
  readonly fit: Accessor<CalibrationView | null>;
  readonly notice: Accessor<Omit<Notice, "about"> | null>;
  /** How often this page has saved points. */
  readonly saves: Accessor<number>;
  freeze(serial: string): Promise<void>;
  /** Forgets the frame and its points. */
  leave(): void;
  select(id: number | null): void;
  markFrame(pixel: Pixel): void;
  /** A press on the map. */
  aim(at: LonLat): void;
  change(id: number, change: Partial<Omit<MarkedPoint, "id">>): void;
  /** Moves a point on the frame, not beyond its rim. */
  nudge(id: number, cols: number, rows: number): void;
  remove(id: number): void;
  useSurveyed(): void;
  accept(): Promise<void>;
}

const FIT_AFTER_MS = 300;

export function isComplete(point: MarkedPoint): boolean {
  return point.pixel !== null && point.place !== null;
}

export function createCalibration(site: SiteRequests, clock: Clock): Calibration {
  const [isBusy, setBusy] = createSignal(false);
  const [frame, setFrame] = createSignal<FrozenFrame | null>(null);
  const [points, setPoints] = createSignal<readonly MarkedPoint[]>([]);
  const [selectedId, setSelectedId] = createSignal<number | null>(null);
  const [fit, setFit] = createSignal<CalibrationView | null>(null);
  const [notice, setNotice] = createSignal<Omit<Notice, "about"> | null>(null);
  const [saves, setSaves] = createSignal(0);
  const selected = createMemo(() => points().find(({ id }) => id === selectedId()) ?? null);
  let nextId = 1;
  let fits = 0;
  let cancelFit = () => {};

  const request = () => ({
    serial: frame()?.serial ?? "",
    frame_id: frame()?.id ?? 0,
    points: points().filter(isComplete).map(viewOf),
  });
  const solveSoon = () => {
    cancelFit();
    fits += 1;
    setFit(null);
    const number = fits;
    if (!points().some(isComplete)) return;
    cancelFit = clock.after(FIT_AFTER_MS, async () => {
      const outcome = await site.fitCalibration(request());
      if (number !== fits) return;
      if (outcome.kind === "answered") setFit(outcome.value);
      else setNotice({ text: outcome.problem, isProblem: true });
    });
  };
  const set = (next: readonly MarkedPoint[]) => {
    setNotice(null);
    setPoints(next);
    solveSoon();
  };
  const change: Calibration["change"] = (id, changed) =>
    set(points().map((one) => (one.id === id ? { ...one, ...changed } : one)));
  const add = (part: Partial<MarkedPoint>) => {
    const one = { name: freeName(points()), pixel: null, place: null, altitude_m: null };
    const made = { ...one, ...part, id: nextId++ };
    set([...points(), made]);
    setSelectedId(made.id);
  };
  const leave = () => {
    setFrame(null);
    set([]);
    setSelectedId(null);
  };

  return {
    isOn: () => frame() !== null,
    isBusy,
    frame,
    points,
    selected,
    fit,
    notice,
    saves,
    freeze: async (serial) => {
      setBusy(true);
      setNotice(null);
      const frozen = await frozenFrame(site, serial);
      setBusy(false);
      if (typeof frozen === "string") setNotice({ text: frozen, isProblem: true });
      else {
        leave();
        setFrame(frozen);
      }
    },
    leave,
    select: setSelectedId,
    markFrame: (pixel) => {
      const one = selected();
      if (one === null || isComplete(one)) add({ pixel });
      else {
        change(one.id, { pixel });
        // Of surveyed points the next one is marked.
        const next = points().find((point) => point.pixel === null);
        if (one.place !== null && next !== undefined) setSelectedId(next.id);
      }
    },
    aim: (place) => {
      const one = selected();
      // The ground's height there is another one.
      if (one === null) add({ place });
      else change(one.id, { place, altitude_m: null });
    },
    change,
    nudge: (id, cols, rows) => {
      const [size, one] = [frame(), points().find((point) => point.id === id)];
      if (size === null || one === undefined || one.pixel === null) return;
      const { col, row } = one.pixel;
      const pixel = {
        col: within(col + cols, size.cols - 1),
        row: within(row + rows, size.rows - 1),
      };
      change(id, { pixel });
    },
    remove: (id) => set(points().filter((one) => one.id !== id)),
    useSurveyed: () => {
      const known = new Set(points().map(({ name }) => name));
      const surveyed = (frame()?.surveyed ?? []).filter(({ name }) => !known.has(name));
      const added = surveyed.map((one) => ({ ...pointOf(one), id: nextId++ }));
      set([...points(), ...added]);
      setSelectedId(added[0]?.id ?? selectedId());
    },
    accept: async () => {
      if (isBusy()) return;
      setBusy(true);
      const outcome = await site.calibrate(request());
      setBusy(false);
      const reason = outcome.kind === "failed" ? outcome.problem : outcome.value.reason;
      if (reason !== null) {
        setNotice({ text: text.draft.notSaved(reason), isProblem: true });
        return;
      }
      leave();
      setSaves(saves() + 1);
      setNotice({ text: text.calibration.saved, isProblem: false });
    },
  };
}

/** The frame with its picture, or why it was not kept. */
async function frozenFrame(site: SiteRequests, serial: string): Promise<FrozenFrame | string> {
  const outcome = await site.freeze(serial);
  if (outcome.kind === "failed") return outcome.problem;
  const { frame_id, reason, cols, rows, surveyed } = outcome.value;
  if (frame_id === null) return reason ?? text.requests.noReason;
  const picture = await site.frozenPicture(serial);
  if (picture.kind === "failed") return picture.problem;
  if (picture.value.frameId !== frame_id) return text.calibration.frozeMeanwhile;
  return { serial, id: frame_id, cols, rows, picture: picture.value.blob, surveyed };
}

function viewOf({ name, pixel, place, altitude_m }: MarkedPoint): ControlPointView {
  return {
    name,
    latitude_deg: place?.lat ?? 0,
    longitude_deg: place?.lon ?? 0,
    altitude_m,
    col_px: pixel?.col ?? null,
    row_px: pixel?.row ?? null,
  };
}

function pointOf(view: ControlPointView): Omit<MarkedPoint, "id"> {
  const place = { lon: view.longitude_deg, lat: view.latitude_deg };
  return { name: view.name, pixel: null, place, altitude_m: view.altitude_m ?? null };
}

function freeName(points: readonly MarkedPoint[]): string {
  const known = new Set(points.map(({ name }) => name));
  let number = 1;
  while (known.has(`P${number}`)) number += 1;
  return `P${number}`;
}

function within(value: number, most: number): number {
  return Math.min(Math.max(value, 0), most);
}
