import { For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { OverlayKind } from "../../map/overlays";
import type { ForecastView, ShadeLineView } from "../../protocol";
import { formatAge, formatFraction } from "../../text/quantities";
import { Panel } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import "./sun.css";

const OVERLAYS: readonly (readonly [OverlayKind, string])[] = [
  ["none", "nothing"],
  ["shade", "shade now"],
  ["forecast", "sun to come"],
  ["cells", "survey's cells"],
];

/** What lies over the ground on the map, and how old and how sure it is. */
export function SunPanel() {
  const { fleet, overlay } = useConsole();
  return (
    <Panel title="Sun and shade">
      <fieldset class="section sun-choice">
        <legend>On the map</legend>
        <For each={OVERLAYS}>
          {([kind, words]) => (
            <label>
              <input
                type="radio"
                name="overlay"
                checked={overlay.kind() === kind}
                onChange={() => overlay.show(kind)}
              />
              {words}
            </label>
          )}
        </For>
      </fieldset>
      <Show when={fleet.shade} fallback={<p class="panel-empty">This site has no eye.</p>}>
        {(line) => <Line line={line()} />}
      </Show>
    </Panel>
  );
}

function Line(props: { line: ShadeLineView }) {
  const { behindS } = useConsole();
  const trouble = () => props.line.rejected ?? props.line.error;
  return (
    <div class="section">
      <Show when={props.line.map} fallback={<p class="muted">No shade has been read yet.</p>}>
        {(map) => (
          <p>
            In sun: {formatFraction(map().sunlit_share)} of what is known (
            {formatFraction(map().known_share)} of the view), seen{" "}
            {formatAge(map().captured_age_s + behindS())} ago, by {props.line.detection}
          </p>
        )}
      </Show>
      <Show when={props.line.forecast}>{(forecast) => <Ahead forecast={forecast()} />}</Show>
      <Show when={trouble()}>
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

/** The slider goes by the forecast's own leads: between them nothing else is known. */
function Ahead(props: { forecast: ForecastView }) {
  const { overlay } = useConsole();
  const index = () => {
    const at = props.forecast.lead_s.indexOf(overlay.lead_s());
    return at < 0 ? 0 : at;
  };
  const lead_s = () => props.forecast.lead_s[index()] ?? 0;
  const when = () => (lead_s() === 0 ? "Sun now" : `Sun in ${formatAge(lead_s())}`);
  const foreseen = () => props.forecast.foreseen_share[index()] ?? 0;
  return (
    <label class="sun-lead">
      <span>
        <strong>{when()}</strong>: {formatFraction(foreseen())} of the view foreseen, by{" "}
        {props.forecast.method}
      </span>
      <input
        type="range"
        min={0}
        max={props.forecast.lead_s.length - 1}
        step={1}
        value={index()}
        aria-valuetext={when()}
        onInput={(event) => {
          overlay.lookAhead(props.forecast.lead_s[Number(event.currentTarget.value)] ?? 0);
          overlay.show("forecast");
        }}
      />
    </label>
  );
}
