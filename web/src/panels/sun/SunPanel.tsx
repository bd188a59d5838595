import { Show } from "solid-js";
import { useConsole } from "../../console";
import type { ForecastView, GroundImageView, ShadeLineView } from "../../protocol";
import { formatAge, formatHeading, formatQuantity } from "../../text/quantities";
import { Panel } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import { LightShares } from "./LightShares";
import { LookAside } from "./LookAside";
import { UpwindPlace } from "./UpwindPlace";
import "./sun.css";

/** What the imaging drone sees of sun and shade, and where it would see more. */
export function SunPanel() {
  const { fleet } = useConsole();
  return (
    <Panel title="Imaging drone" name="sun">
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
        {(forecast) => <p class="muted">{motion(forecast())}</p>}
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
  if (east === null || north === null) return "Motion of the shadows unknown.";
  const towards = ((Math.atan2(east, north) * 180) / Math.PI + 360) % 360;
  const speed = formatQuantity(Math.hypot(east, north), "m/s");
  return `Shadows move at ${speed}, bearing ${formatHeading(towards)}.`;
}
