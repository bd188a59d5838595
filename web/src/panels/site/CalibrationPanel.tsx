import { createMemo, createSignal, For, onCleanup, Show } from "solid-js";
import { useConsole } from "../../console";
import { type FrozenFrame, isComplete, type MarkedPoint } from "../../site/calibration";
import { cornerOf, cornerText } from "../../site/siteFeatures";
import { plural } from "../../text/names";
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
  const { calibration, fleet, lacks } = useConsole();
  // Without its panel a press on the map would still place points.
  onCleanup(() => calibration.leave());
  const imagers = () => fleet.site?.imager_serials ?? [];
  return (
    <Panel title="Calibrate camera" name="calibration" class="site calibration">
      <Show
        when={imagers().length > 0}
        fallback={<Empty>The site has no imaging drone: give it an [imager] first.</Empty>}
      >
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
                  {calibration.isOn() ? "Freeze another frame" : "Freeze a frame"}
                  <Show when={imagers().length > 1}> of {serial}</Show>
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

/** The frozen frame: a press marks the selected point, arrow keys move a point by a pixel. */
function Frame(props: { frame: FrozenFrame }) {
  const { calibration } = useConsole();
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
    <section class="section" aria-label="Frozen frame">
      <p role="status">{hint(calibration.selected())}</p>
      <section class="frame-view" tabindex="0" aria-label="Frame, scrolls when enlarged">
        <div class="frame-picture" style={{ width: `${100 * (ZOOMS[zoom()] ?? 1)}%` }}>
          {/* biome-ignore lint/a11y/useKeyWithClickEvents: the button below marks without a pointer */}
          <img src={url} alt="The frozen frame of the imaging drone" onClick={mark} />
          <Residuals frame={props.frame} />
          <For each={calibration.points().filter(({ pixel }) => pixel !== null)}>
            {(point) => (
              <button
                type="button"
                class="frame-point"
                classList={{ "is-selected": calibration.selected()?.id === point.id }}
                style={share(point.pixel ?? middle())}
                aria-label={`${point.name} on the frame`}
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
          aria-label="Enlarge the frame"
          disabled={zoom() === ZOOMS.length - 1}
          onClick={() => setZoom(zoom() + 1)}
        >
          +
        </button>
        <button
          type="button"
          class="button"
          aria-label="Reduce the frame"
          disabled={zoom() === 0}
          onClick={() => setZoom(zoom() - 1)}
        >
          −
        </button>
        <button type="button" class="button" onClick={() => calibration.markFrame(middle())}>
          Mark frame centre
        </button>
        <MapCentreButton />
      </div>
    </section>
  );
}

function MapCentreButton() {
  const { calibration, mapCentre } = useConsole();
  const place = () => {
    const centre = mapCentre();
    if (centre !== null) calibration.aim({ lon: centre.lon, lat: centre.lat });
  };
  return (
    <button type="button" class="button" onClick={place}>
      Place at map centre
    </button>
  );
}

function hint(point: MarkedPoint | null): string {
  if (point === null) return "Press a thing on the frame that can be found on the map.";
  if (point.pixel === null) return `Press ${point.name} on the frame.`;
  if (point.place === null) return `Press ${point.name} on the map.`;
  return `${point.name}: press the next point on the frame; a press on the map moves ${point.name}.`;
}

/** From each marked point towards where the solved camera sees it. */
function Residuals(props: { frame: FrozenFrame }) {
  const { calibration } = useConsole();
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
  const { calibration } = useConsole();
  return (
    <section class="section" aria-label="Control points">
      <Show when={props.surveyed > 0}>
        <button type="button" class="button" onClick={() => calibration.useSurveyed()}>
          Use the site's {plural(props.surveyed, "surveyed point")}
        </button>
      </Show>
      <Show when={calibration.points().length > 0}>
        <ul class="point-list" aria-label="Control points">
          <For each={calibration.points()}>{(point) => <PointRow point={point} />}</For>
        </ul>
      </Show>
      <Show when={calibration.selected()}>{(point) => <PointForm point={point()} />}</Show>
    </section>
  );
}

function PointRow(props: { point: MarkedPoint }) {
  const { calibration } = useConsole();
  const residual = () =>
    calibration.fit()?.residuals.find(({ name }) => name === props.point.name) ?? null;
  const text = () => {
    if (props.point.pixel === null) return "not on the frame yet";
    if (props.point.place === null) return "not on the map yet";
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
        <span class="push">{text()}</span>
      </button>
      <button
        type="button"
        class="button button-quiet"
        aria-label={`Delete ${props.point.name}`}
        onClick={() => calibration.remove(props.point.id)}
      >
        ✕
      </button>
    </li>
  );
}

/** The selected point's values, for exact ones and for the keyboard. */
function PointForm(props: { point: MarkedPoint }) {
  const { calibration } = useConsole();
  const set = (change: Parameters<typeof calibration.change>[1]) =>
    calibration.change(props.point.id, change);
  return (
    <div class="point-form">
      <label>
        Latitude, longitude
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
        Altitude (WGS84), m
        <input
          class="field"
          inputmode="decimal"
          placeholder="ground"
          value={props.point.altitude_m ?? ""}
          onChange={(event) => {
            const text = event.currentTarget.value.trim();
            const value = Number(text);
            set({ altitude_m: text === "" || !Number.isFinite(value) ? null : value });
          }}
        />
      </label>
    </div>
  );
}

function Result() {
  const { calibration, lacks } = useConsole();
  const missing = () => calibration.points().filter((point) => !isComplete(point));
  const reason = () => calibration.fit()?.reason ?? null;
  const why = () => {
    const [first] = missing();
    if (lacks("operator") !== null) return lacks("operator");
    if (first !== undefined) return `Mark or delete ${first.name} first`;
    return calibration.fit()?.accepted === true ? null : "There is no camera by these points yet";
  };
  return (
    <section class="section" aria-label="Result">
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
        Accept and save
      </button>
    </section>
  );
}

function summary(fit: ReturnType<ReturnType<typeof useConsole>["calibration"]["fit"]>): string {
  if (fit === null || fit.rms_px === null) return "";
  const height = formatQuantity(fit.height_above_ground_m ?? 0, "m", 1);
  const tilt = formatQuantity(fit.tilt_deg ?? 0, "°", 1);
  return `RMS ${formatQuantity(fit.rms_px, "px", 2)} · ${height} above ground · ${tilt} off straight down`;
}
