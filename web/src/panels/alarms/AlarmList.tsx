import { createMemo, createSignal, For, Show } from "solid-js";
import { useConsole } from "../../console";
import { sortAlarms } from "../../fleet/severity";
import type { AlarmView } from "../../protocol";
import { alarmText } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { Empty, Panel } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import "./alarms.css";

/** The alarms of station and vehicles, worst first. */
export function AlarmList() {
  const { fleet } = useConsole();
  const sorted = createMemo(() => sortAlarms(fleet.alarms));
  return (
    <Panel title="Alarms" count={sorted().length}>
      <Show when={sorted().length > 0} fallback={<Empty>No alarms.</Empty>}>
        <ul aria-live="assertive" aria-relevant="additions">
          <For each={sorted()}>{(alarm) => <AlarmRow alarm={alarm} />}</For>
        </ul>
      </Show>
    </Panel>
  );
}

function AlarmRow(props: { alarm: AlarmView }) {
  const { source, behindS, lacks } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const acknowledge = async () => {
    const outcome = await source.acknowledge(props.alarm.id);
    setProblem(outcome.kind === "failed" ? outcome.problem : null);
  };
  const text = () => alarmText(props.alarm);
  const subject = () => props.alarm.vehicle_name || "Station";
  return (
    <li
      class={`row alarm alarm-${props.alarm.severity}`}
      classList={{ "is-acknowledged": props.alarm.is_acknowledged }}
    >
      <span class={`tone-${props.alarm.severity}`}>
        <SeverityMark severity={props.alarm.severity} size={26} />
      </span>
      <div class="alarm-text wire-text">
        <p>
          <strong>{subject()}:</strong> {text()}
        </p>
        <p class="muted" aria-live="off">
          {formatAge(props.alarm.raised_age_s + behindS())} ago
          {props.alarm.is_active ? "" : ", ended"}
          {props.alarm.is_acknowledged ? ", acknowledged" : ""}
        </p>
        <Show when={problem()}>{(text) => <p class="tone-error">{text()}</p>}</Show>
      </div>
      <Show when={!props.alarm.is_acknowledged}>
        <button
          type="button"
          class="button"
          aria-label={`Acknowledge ${subject()}: ${text()}`}
          disabled={lacks("operator") !== null}
          title={lacks("operator") ?? undefined}
          onClick={() => void acknowledge()}
        >
          Ack
        </button>
      </Show>
    </li>
  );
}
