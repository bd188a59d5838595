import { For, Show } from "solid-js";
import { useStation } from "../../console";
import type { LightSensorView } from "../../protocol";
import { text } from "../../text/catalogue";
import { isSensorLive } from "../../text/light";
import { agedBy, formatAge, formatFraction, formatQuantity } from "../../text/quantities";
import { Warning } from "../Panel";

/** Light sensors at the field: what each shows, and what the shade map says where it is. */
export function LightSensors() {
  const { fleet, behindS } = useStation();
  return (
    <Show when={fleet.lightSensors}>
      {(lights) => (
        <div class="section">
          <h3>{text.lightSensors.title}</h3>
          <ul class="light-sensors">
            <For each={lights().sensors}>{(sensor) => <LightSensor sensor={sensor} />}</For>
          </ul>
          <Warning
            text={
              lights().problem &&
              text.lightSensors.problem(
                lights().problem,
                formatAge(agedBy(lights().problem_age_s, behindS())),
              )
            }
          />
        </div>
      )}
    </Show>
  );
}

function LightSensor(props: { sensor: LightSensorView }) {
  const { behindS } = useStation();
  const isLive = () => isSensorLive(props.sensor, behindS());
  const value = () => formatQuantity(props.sensor.value, "", 0).trim();
  const stale = () => {
    const ageS = props.sensor.age_s + behindS();
    return text.lightSensors[ageS < 0 ? "ahead" : "stale"](formatAge(Math.abs(ageS)));
  };
  return (
    <li classList={{ "is-stale": !isLive() }}>
      <span class={`light-swatch is-${isLive() ? props.sensor.shows : "unknown"}`} />
      <span class="wire-text light-sensor-name">{props.sensor.name}</span>
      <span class="number">{isLive() ? value() : stale()}</span>
      <span class="muted light-sensor-map">
        <Show when={isLive()}>{text.lightSensors.shows[props.sensor.shows]}</Show>{" "}
        {
          text.lightSensors.map[
            props.sensor.latitude_deg === null ? "nowhere" : props.sensor.map_says
          ]
        }{" "}
        <Show when={props.sensor.compared > 0}>
          {text.lightSensors.right(
            formatFraction(props.sensor.right / props.sensor.compared),
            props.sensor.compared,
          )}
        </Show>
      </span>
    </li>
  );
}
