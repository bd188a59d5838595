import { Show } from "solid-js";
import { useStation } from "../../console";
import type { ForecastView, GroundImageView, ShadeLineView } from "../../protocol";
import { text } from "../../text/catalogue";
import { formatAge, formatHeading, formatQuantity } from "../../text/quantities";
import { Panel, Warning } from "../Panel";
import { LightSensors } from "./LightSensors";
import { LightShares } from "./LightShares";
import { SideStep } from "./SideStep";
import { UpwindPlace } from "./UpwindPlace";
import "./sun.css";

/** What the imaging drone sees of sun and shade, and where it would see more. */
export function SunPanel() {
  const { fleet } = useStation();
  return (
    <Panel title={text.panels.titles.sun} name="sun">
      <Show when={fleet.shade} fallback={<p class="panel-empty">{text.sun.none}</p>}>
        {(line) => (
          <>
            <ShadeStatus line={line()} />
            <UpwindPlace />
            <SideStep />
          </>
        )}
      </Show>
      <LightSensors />
    </Panel>
  );
}

function ShadeStatus(props: { line: ShadeLineView }) {
  const { behindS, fleet } = useStation();
  const problem = () => props.line.rejected ?? props.line.error;
  return (
    <div class="section">
      <Show when={props.line.map} fallback={<p class="muted">{text.sun.noMap}</p>}>
        {(map) => (
          <>
            <Show when={map().in_view} fallback={<p class="muted">{text.sun.noGround}</p>}>
              {(inView) => <LightShares inView={inView()} />}
            </Show>
            <p class="muted">
              {text.sun.inView(
                formatAge(map().captured_age_s + behindS()),
                exposure(fleet.groundImage, props.line),
              )}
            </p>
          </>
        )}
      </Show>
      <Show when={props.line.reference}>
        {(what) => <p class="muted wire-text">{text.sun.reference(what())}</p>}
      </Show>
      <Show when={props.line.forecast}>
        {(forecast) => <p class="muted">{motion(forecast())}</p>}
      </Show>
      <Warning text={problem()} />
    </div>
  );
}

/** How the newest ground image was exposed; null without one. */
function exposure(image: GroundImageView | null, line: ShadeLineView) {
  if (image === null) return null;
  if (line.lock_problem) return "notLocked";
  return image.exposure_locked ? "locked" : "automatic";
}

/** The shadows' motion in words. */
function motion(forecast: ForecastView): string {
  const { shadows_east_mps: east, shadows_north_mps: north } = forecast;
  if (east === null || north === null) return text.sun.motionUnknown;
  const towards = ((Math.atan2(east, north) * 180) / Math.PI + 360) % 360;
  const speed = formatQuantity(Math.hypot(east, north), "m/s");
  return text.sun.motion(speed, formatHeading(towards));
}
