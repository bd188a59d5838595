import { For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { OverlayKind } from "../../map/overlays";
import type { ForecastView, GroundImageView, ShadeLineView } from "../../protocol";
import { formatAge, formatFraction, formatHeading, formatQuantity } from "../../text/quantities";
import { Panel } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import { LightShares } from "./LightShares";
import { LookAside } from "./LookAside";
import { UpwindPlace } from "./UpwindPlace";
import "./sun.css";

const OVERLAYS: readonly (readonly [OverlayKind, string])[] = [
  ["none", "No overlay"],
  ["shade", "Shade now"],
  ["forecast", "Sun forecast"],
  ["cells", "Coverage"],
];

/** Map overlay selection, and age and coverage of shade map and forecast. */
export function SunPanel() {
  const { fleet, overlay } = useConsole();
  return (
    <Panel title="Sun and shade">
      <fieldset class="section sun-choice">
        <legend>Map overlay</legend>
        <For each={OVERLAYS}>
          {([kind, label]) => (
            <label>
              <input
                type="radio"
                name="overlay"
                checked={overlay.kind() === kind}
                onChange={() => overlay.show(kind)}
              />
              {label}
            </label>
          )}
        </For>
      </fieldset>
      <Show when={fleet.shade} fallback={<p class="panel-empty">No imaging drone at this site.</p>}>
        {(line) => (
          <>
            <ShadeStatus line={line()} />
            <UpwindPlace />
            <LookAside />
          </>
        )}
      </Show>
    </Panel>
  );
}

function ShadeStatus(props: { line: ShadeLineView }) {
  const { behindS, fleet } = useConsole();
  const problem = () => props.line.rejected ?? props.line.error;
  return (
    <div class="section">
      <Show when={props.line.map} fallback={<p class="muted">No shade map yet.</p>}>
        {(map) => (
          <>
            <Show when={map().in_view} fallback={<p class="muted">No ground in view.</p>}>
              {(inView) => <LightShares inView={inView()} />}
            </Show>
            <p class="muted">
              of the ground in view, {formatAge(map().captured_age_s + behindS())} ago
              <Show when={fleet.groundImage}>
                {(image) => <>; exposure {exposure(image(), props.line)}</>}
              </Show>
            </p>
          </>
        )}
      </Show>
      <Show when={props.line.reference}>
        {(text) => <p class="muted wire-text">Land in full sun: {text()}.</p>}
      </Show>
      <Show when={props.line.forecast}>
        {(forecast) => (
          <>
            <ForecastLead forecast={forecast()} />
            <ForecastLegend />
          </>
        )}
      </Show>
      <Show when={problem()}>
        {(text) => (
          <p class="problem wire-text">
            <span class="tone-warning">
              <SeverityMark severity="warning" />
            </span>
            <span>{text()}</span>
          </p>
        )}
      </Show>
    </div>
  );
}

function exposure(image: GroundImageView, line: ShadeLineView): string {
  if (line.lock_problem) return "not locked";
  return image.exposure_locked ? "locked" : "automatic";
}

/** The shadows' motion in words. */
function motion(forecast: ForecastView): string {
  const { shadows_east_mps: east, shadows_north_mps: north } = forecast;
  if (east === null || north === null) return "The shadows' motion is not known.";
  const towards = ((Math.atan2(east, north) * 180) / Math.PI + 360) % 360;
  const speed = formatQuantity(Math.hypot(east, north), "m/s");
  return `Shadows move towards ${formatHeading(towards)} at ${speed}.`;
}

/** Slider over the leads the forecast provides. */
function ForecastLead(props: { forecast: ForecastView }) {
  const { overlay } = useConsole();
  const index = () => {
    const at = props.forecast.lead_s.indexOf(overlay.lead_s());
    return at < 0 ? 0 : at;
  };
  const lead_s = () => props.forecast.lead_s[index()] ?? 0;
  const when = () => (lead_s() === 0 ? "Sun now" : `Sun in ${formatAge(lead_s())}`);
  const predicted = () => props.forecast.predicted_share[index()] ?? 0;
  const right = () => props.forecast.right.find((each) => each.lead_s === lead_s());
  return (
    <label class="sun-lead">
      <span>
        <strong>{when()}</strong>: {formatFraction(predicted())} of the map predicted from clouds
        over ground in view
        <Show when={right()}>
          {(found) => <>; right lately: {formatFraction(found().right_share)} of cells</>}
        </Show>
      </span>
      <span class="muted">{motion(props.forecast)}</span>
      <input
        type="range"
        min={0}
        max={props.forecast.lead_s.length - 1}
        step={1}
        value={index()}
        aria-valuetext={when()}
        onInput={(event) => {
          overlay.setLead(props.forecast.lead_s[Number(event.currentTarget.value)] ?? 0);
          overlay.show("forecast");
        }}
      />
      <LeadScale leads={props.forecast.lead_s} />
    </label>
  );
}

/** The first, middle and last lead, where the slider has them. */
function LeadScale(props: { leads: readonly number[] }) {
  const ticks = () => {
    const last = props.leads.length - 1;
    return [0, Math.round(last / 2), last].map((index) => props.leads[index] ?? 0);
  };
  return (
    <span class="lead-scale muted" aria-hidden="true">
      <For each={ticks()}>
        {(lead_s) => <span>{lead_s === 0 ? "now" : `${lead_s / 60} min`}</span>}
      </For>
    </span>
  );
}

/** The forecast's colours and pattern on the map. */
function ForecastLegend() {
  return (
    <p class="forecast-legend">
      <span>shade</span>
      <span class="forecast-ramp" aria-hidden="true" />
      <span>sun</span>
      <span class="light-swatch is-unknown" aria-hidden="true" />
      <span>estimate: its clouds are not in view</span>
    </p>
  );
}
