import { createMemo, createSignal, For, Show } from "solid-js";
import { useStation } from "../../console";
import { type AlarmGroup, groupAlarms, isAlarmNow } from "../../fleet/alarmGroups";
import type { AlarmView } from "../../protocol";
import { kindOf } from "../../sound/alarmSound";
import { text } from "../../text/catalogue";
import { alarmText } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { Empty, Panel } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import { MuteButton, SoundControls } from "./SoundControls";
import "./alarms.css";

/** The alarms of station and vehicles by cause: active ones worst first, ended ones collapsed. */
export function AlarmList() {
  const { fleet } = useStation();
  const groups = createMemo(() => groupAlarms(fleet.alarms));
  const ended = () => groups().filter(({ isActive }) => !isActive);
  return (
    <Panel
      title={text.panels.titles.alarms}
      name="alarms"
      class="alarms"
      count={fleet.alarms.filter(isAlarmNow).length}
    >
      <SoundControls />
      <Show when={groups().length > ended().length} fallback={<Empty>{text.alarms.none}</Empty>}>
        <Groups groups={groups().filter(({ isActive }) => isActive)} isAnnounced={true} />
      </Show>
      <Show when={ended().length > 0}>
        <details class="alarm-ended">
          <summary>
            {text.alarms.ended(fleet.alarms.filter((one) => !one.is_active).length)}
          </summary>
          <Groups groups={ended()} isAnnounced={false} />
        </details>
      </Show>
    </Panel>
  );
}

function Groups(props: { groups: readonly AlarmGroup[]; isAnnounced: boolean }) {
  // Rows by key: a button stays the same element while alarms come and go.
  const keys = createMemo(() => props.groups.map(({ key }) => key), [], { equals: sameKeys });
  return (
    <ul aria-live={props.isAnnounced ? "assertive" : "off"} aria-relevant="additions">
      <For each={keys()}>
        {(key) => (
          <Show when={props.groups.find((group) => group.key === key)}>
            {(group) => <GroupRow group={group()} />}
          </Show>
        )}
      </For>
    </ul>
  );
}

function sameKeys(a: readonly string[], b: readonly string[]): boolean {
  return a.length === b.length && a.every((key, index) => key === b[index]);
}

function GroupRow(props: { group: AlarmGroup }) {
  const { source, lacks } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  const acknowledge = async () => {
    const open = props.group.alarms.filter((alarm) => !alarm.is_acknowledged);
    const outcomes = await Promise.all(open.map(({ id }) => source.station.acknowledge(id)));
    const failed = outcomes.find((outcome) => outcome.kind === "failed");
    setProblem(failed?.kind === "failed" ? failed.problem : null);
  };
  return (
    <li
      class={`row alarm alarm-${props.group.severity}`}
      classList={{
        "is-acknowledged": props.group.isAcknowledged,
        "is-over": !props.group.isActive,
      }}
    >
      <span class={`alarm-mark tone-${props.group.severity}`}>
        <SeverityMark severity={props.group.severity} size={22} />
      </span>
      <div class="alarm-text wire-text">
        <p>
          <strong>{props.group.title}</strong>
        </p>
        <div class="row-line">
          <Since group={props.group} />
          <div class="bar-space" />
          <Show when={props.group.alarms.some(isAlarmNow)}>
            <MuteButton kind={kindOf(props.group)} />
          </Show>
          <Show when={!props.group.isAcknowledged}>
            <button
              type="button"
              class="button alarm-ack"
              aria-label={text.alarms.acknowledge(props.group.title)}
              disabled={lacks("operator") !== null}
              title={lacks("operator") ?? text.alarms.acknowledgeHint}
              onClick={() => void acknowledge()}
            >
              {text.alarms.ok}
            </button>
          </Show>
        </div>
        <Show when={props.group.alarms.length > 1}>
          <Members alarms={props.group.alarms} />
        </Show>
        <Show when={problem()}>{(why) => <p class="tone-error">{why()}</p>}</Show>
      </div>
    </li>
  );
}

function Since(props: { group: AlarmGroup }) {
  const { behindS } = useStation();
  const newest = () => (props.group.alarms[0]?.raised_age_s ?? 0) + behindS();
  return (
    <p class="muted" aria-live="off">
      {text.alarms.since(formatAge(newest()), props.group.isActive, props.group.isAcknowledged)}
    </p>
  );
}

function Members(props: { alarms: readonly AlarmView[] }) {
  return (
    <details class="alarm-members">
      <summary>{text.alarms.showEach}</summary>
      <ul>
        <For each={props.alarms}>
          {(alarm) => (
            <li>
              {alarm.vehicle_name || text.names.station}: {alarmText(alarm)}
            </li>
          )}
        </For>
      </ul>
    </details>
  );
}
