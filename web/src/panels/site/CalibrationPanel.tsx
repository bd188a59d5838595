import { createMemo, createSignal, For, onCleanup, Show } from "solid-js";
import { useMapModes, useSiteEditing, useStation } from "../../console";
import { type FrozenFrame, isComplete, type MarkedPoint } from "../../site/calibration";
import { cornerOf, cornerText } from "../../site/siteFeatures";
import { text } from "../../text/catalogue";
import { formatQuantity } from "../../text/quantities";
import { Empty, Panel, Problem } from "../Panel";
import { NoticeLine } from "./NoticeLine";
import "./calibration.css";

/** How many times as long as they are residuals are drawn. */
const LENGTHENED = 10;
const ZOOMS = [1, 2, 4] as const;
const STEPS: Readonly<Record<string, readonly [col: number, row: number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

/** Places an imaging drone's camera: points marked on one of its frames and on the map, with their residuals. */
export function CalibrationPanel() {
  const { fleet, lacks } = useStation();
  const { calibration } = useSiteEditing();
  // Without its panel a press on the map would still place points.
  onCleanup(() => calibration.leave());
  const imagers = () => fleet.site?.imager_serials ?? [];
  return (
    <Panel title={text.panels.titles.calibration} name="calibration" class="site calibration">
      <Show when={imagers().length > 0} fallback={<Empty>{text.calibration.noImager}</Empty>}>
        <div class="section">
          <div class="section-buttons">
            <For each={imagers()}>
              {(serial) => (
                <button
                  type="button"
                  class="button"
                  disabled={calibration.isBusy() || lacks("operator") !== null}
                  title={lacks("operator") ?? undefined}
                  onClick={() => void calibration.freeze(serial)}
                >
                  {freezeLabel(calibration.isOn(), imagers().length > 1 ? serial : null)}
                </button>
              )}
            </For>
          </div>
          <NoticeLine notice={calibration.notice()} />
        </div>
        {/* By the frame: another one has another picture. */}
        <Show when={calibration.frame()} keyed>
          {(frame) => (
            <>
              <Frame frame={frame} />
              <Result />
              <Points surveyed={frame.surveyed.length} />
            </>
          )}
        </Show>
      </Show>
    </Panel>
  );
}

/** With the serial where there are several. */
function freezeLabel(isOn: boolean, serial: string | null): string {
  const { freeze, freezeOf, freezeAnother, freezeAnotherOf } = text.calibration;
  if (serial === null) return isOn ? freezeAnother : freeze;
  return (isOn ? freezeAnotherOf : freezeOf)(serial);
}

/** The frozen frame: a press marks the selected point, arrow keys move a point by a pixel. */
function Frame(props: { frame: FrozenFrame }) {
  const { calibration } = useSiteEditing();
  const [zoom, setZoom] = createSignal(0);
  const url = URL.createObjectURL(props.frame.picture);
  onCleanup(() => URL.revokeObjectURL(url));
  const share = ({ col, row }: { col: number; row: number }) => ({
    left: `${((col + 0.5) / props.frame.cols) * 100}%`,
    top: `${((row + 0.5) / props.frame.rows) * 100}%`,
  });
  const mark = (event: MouseEvent & { currentTarget: HTMLElement }) => {
    const { width, height, left, top } = event.currentTarget.getBoundingClientRect();
    calibration.markFrame({
      col: ((event.clientX - left) / width) * props.frame.cols - 0.5,
      row: ((event.clientY - top) / height) * props.frame.rows - 0.5,
    });
  };
  const press = (event: KeyboardEvent, point: MarkedPoint) => {
    if (event.key === "Delete") calibration.remove(point.id);
    const step = STEPS[event.key];
    if (step === undefined) return;
    event.preventDefault();
    // The page's keys are not meant.
    event.stopPropagation();
    const by = event.shiftKey ? 10 : 1;
    calibration.nudge(point.id, step[0] * by, step[1] * by);
  };
  const middle = () => ({ col: (props.frame.cols - 1) / 2, row: (props.frame.rows - 1) / 2 });
  return (
    <section class="section" aria-label={text.calibration.frame}>
      <p role="status">{hint(calibration.selected())}</p>
      <section class="frame-view" tabindex="0" aria-label={text.calibration.frameView}>
        <div class="frame-picture" style={{ width: `${100 * (ZOOMS[zoom()] ?? 1)}%` }}>
          {/* biome-ignore lint/a11y/useKeyWithClickEvents: the button below marks without a pointer */}
          <img src={url} alt={text.calibration.picture} onClick={mark} />
          <Residuals frame={props.frame} />
          <For each={calibration.points().filter(({ pixel }) => pixel !== null)}>
            {(point) => (
              <button
                type="button"
                class="frame-point"
                classList={{ "is-selected": calibration.selected()?.id === point.id }}
                style={share(point.pixel ?? middle())}
                aria-label={text.calibration.point(point.name)}
                aria-pressed={calibration.selected()?.id === point.id}
                onClick={() => calibration.select(point.id)}
                onKeyDown={(event) => press(event, point)}
              >
                <span>{point.name}</span>
              </button>
            )}
          </For>
        </div>
      </section>
      <div class="frame-tools">
        <button
          type="button"
          class="button"
          aria-label={text.calibration.enlarge}
          disabled={zoom() === ZOOMS.length - 1}
          onClick={() => setZoom(zoom() + 1)}
        >
          +
        </button>
        <button
          type="button"
          class="button"
          aria-label={text.calibration.reduce}
          disabled={zoom() === 0}
          onClick={() => setZoom(zoom() - 1)}
        >
          −
        </button>
        <button type="button" class="button" onClick={() => calibration.markFrame(middle())}>
          {text.calibration.markCentre}
        </button>
        <MapCentreButton />
      </div>
    </section>
  );
}

function MapCentreButton() {
  const { mapCentre } = useMapModes();
  const { calibration } = useSiteEditing();
  const place = () => {
    const centre = mapCentre();
    if (centre !== null) calibration.aim({ lon: centre.lon, lat: centre.lat });
  };
  return (
    <button type="button" class="button" onClick={place}>
      {text.calibration.placeAtCentre}
    </button>
  );
}

function hint(point: MarkedPoint | null): string {
  if (point === null) return text.calibration.pressThing;
  if (point.pixel === null) return text.calibration.pressFrame(point.name);
  if (point.place === null) return text.calibration.pressMap(point.name);
  return text.calibration.pressNext(point.name);
}

/** From each marked point towards where the solved camera sees it. */
function Residuals(props: { frame: FrozenFrame }) {
  const { calibration } = useSiteEditing();
  const lines = createMemo(() =>
    (calibration.fit()?.residuals ?? []).flatMap(({ name, col_px, row_px }) => {
      const pixel = calibration.points().find((one) => one.name === name)?.pixel;
      if (pixel === undefined || pixel === null) return [];
      const [col, row] = [pixel.col + 0.5, pixel.row + 0.5];
      return [[col, row, col - LENGTHENED * col_px, row - LENGTHENED * row_px] as const];
    }),
  );
  return (
    <svg
      class="frame-residuals"
      viewBox={`0 0 ${props.frame.cols} ${props.frame.rows}`}
      preserveAspectRatio="none"
      aria-hidden="true"
    >
      <For each={lines()}>{([x1, y1, x2, y2]) => <line x1={x1} y1={y1} x2={x2} y2={y2} />}</For>
    </svg>
  );
}

function Points(props: { surveyed: number }) {
  const { calibration } = useSiteEditing();
  return (
    <section class="section" aria-label={text.calibration.points}>
      <Show when={props.surveyed > 0}>
        <button type="button" class="button" onClick={() => calibration.useSurveyed()}>
          {text.calibration.useSurveyed(props.surveyed)}
        </button>
      </Show>
      <Show when={calibration.points().length > 0}>
        <ul class="point-list" aria-label={text.calibration.points}>
          <For each={calibration.points()}>{(point) => <PointRow point={point} />}</For>
        </ul>
      </Show>
      <Show when={calibration.selected()}>{(point) => <PointForm point={point()} />}</Show>
    </section>
  );
}

function PointRow(props: { point: MarkedPoint }) {
  const { calibration } = useSiteEditing();
  const residual = () =>
    calibration.fit()?.residuals.find(({ name }) => name === props.point.name) ?? null;
  const state = () => {
    if (props.point.pixel === null) return text.calibration.notOnFrame;
    if (props.point.place === null) return text.calibration.notOnMap;
    const found = residual();
    if (found === null) return "";
    const size = formatQuantity(Math.hypot(found.col_px, found.row_px), "px", 1);
    return found.ground_m === null ? size : `${size} · ${formatQuantity(found.ground_m, "m", 2)}`;
  };
  return (
    <li>
      <button
        type="button"
        class="button button-quiet site-pick"
        aria-pressed={calibration.selected()?.id === props.point.id}
        onClick={() => calibration.select(props.point.id)}
      >
        <span class="wire-text">{props.point.name}</span>
        <span class="push">{state()}</span>
      </button>
      <button
        type="button"
        class="button button-quiet"
        aria-label={text.calibration.remove(props.point.name)}
        onClick={() => calibration.remove(props.point.id)}
      >
        ✕
      </button>
    </li>
  );
}

/** The selected point's values, for exact ones and for the keyboard. */
function PointForm(props: { point: MarkedPoint }) {
  const { calibration } = useSiteEditing();
  const set = (change: Parameters<typeof calibration.change>[1]) =>
    calibration.change(props.point.id, change);
  return (
    <div class="point-form">
      <label>
        {text.calibration.place}
        <input
          class="field"
          value={props.point.place === null ? "" : cornerText(props.point.place)}
          onChange={(event) => {
            const place = cornerOf(event.currentTarget.value);
            if (place !== null) set({ place });
            else event.currentTarget.value = "";
          }}
        />
      </label>
      <label>
        {text.calibration.altitude}
        <input
          class="field"
          inputmode="decimal"
          placeholder={text.calibration.onGround}
          value={props.point.altitude_m ?? ""}
          onChange={(event) => {
            const typed = event.currentTarget.value.trim();
            const value = Number(typed);
            set({ altitude_m: typed === "" || !Number.isFinite(value) ? null : value });
          }}
        />
      </label>
    </div>
  );
}

function Result() {
  const { lacks } = useStation();
  const { calibration } = useSiteEditing();
  const missing = () => calibration.points().filter((point) => !isComplete(point));
  const reason = () => calibration.fit()?.reason ?? null;
  const why = () => {
    const [first] = missing();
    if (lacks("operator") !== null) return lacks("operator");
    if (first !== undefined) return text.calibration.completeFirst(first.name);
    return calibration.fit()?.accepted === true ? null : text.calibration.noCamera;
  };
  return (
    <section class="section" aria-label={text.calibration.result}>
      <p role="status" class="calibration-result">
        {summary(calibration.fit())}
      </p>
      <Problem text={reason()} />
      <button
        type="button"
        class="button site-save"
        disabled={why() !== null || calibration.isBusy()}
        title={why() ?? undefined}
        onClick={() => void calibration.accept()}
      >
        {text.calibration.accept}
      </button>
    </section>
  );
}

function summary(fit: ReturnType<ReturnType<typeof useSiteEditing>["calibration"]["fit"]>): string {
  if (fit === null || fit.rms_px === null) return "";
  const height = formatQuantity(fit.height_above_ground_m ?? 0, "m", 1);
  const tilt = formatQuantity(fit.tilt_deg ?? 0, "°", 1);
  return text.calibration.summary(formatQuantity(fit.rms_px, "px", 2), height, tilt);
}
