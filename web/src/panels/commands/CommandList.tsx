import { For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { CommandView } from "../../protocol";
import { commandName, noteText, PHASE_NAMES, phaseTone } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { Empty, Panel } from "../Panel";
import "./commands.css";

/**
 * Commands and what became of them, the newest first, as the station sorts them. Their ids do not tell
 * the order: those that the station gives by itself are negative.
 */
export function CommandList() {
  const { fleet } = useConsole();
  return (
    <Panel title="Commands" count={fleet.commands.length}>
      <Show when={fleet.commands.length > 0} fallback={<Empty>No commands yet.</Empty>}>
        <ol>
          <For each={fleet.commands}>{(command) => <CommandRow command={command} />}</For>
        </ol>
      </Show>
    </Panel>
  );
}

function CommandRow(props: { command: CommandView }) {
  const { behindS } = useConsole();
  return (
    <li class="row command" data-testid={`command-${props.command.id}`}>
      <div class="row-line">
        <strong class="wire-text">
          {commandName(props.command.kind)} {props.command.vehicle_name}
        </strong>
        <span class={`phase phase-${phaseTone(props.command)} push`} data-testid="phase">
          {PHASE_NAMES[props.command.phase]}
        </span>
      </div>
      <Life command={props.command} />
      <p class="muted wire-text">
        #{props.command.id} by {props.command.issued_by},{" "}
        {formatAge(props.command.age_s + behindS())} ago
        <Show when={props.command.times_sent > 1}>, sent {props.command.times_sent} times</Show>
        <Show when={props.command.takeoff}>, takeoff allowed</Show>
        <Show when={props.command.sent_altitudes}>{(text) => <>, altitudes {text()}</>}</Show>
      </p>
      <Show when={props.command.part}>
        {(part) => (
          <p>
            Mission: <strong>{part()}</strong>
          </p>
        )}
      </Show>
      <Show when={props.command.repairs.length > 0}>
        <Repairs repairs={props.command.repairs} />
      </Show>
      <Show when={!isNotedInLife(props.command)}>
        <p class="wire-text">{noteText(props.command.phase, props.command.note)}</p>
      </Show>
    </li>
  );
}

/** What the station changed in a mission so that the aircraft takes it. */
function Repairs(props: { repairs: readonly string[] }) {
  return (
    <details class="repairs wire-text">
      <summary>
        Repaired before sending: {props.repairs.length}{" "}
        {props.repairs.length === 1 ? "change" : "changes"}
      </summary>
      <ul>
        <For each={props.repairs}>{(repair) => <li>{repair}</li>}</For>
      </ul>
    </details>
  );
}

/** Whether the command's own note stands beside one of its phases already. */
function isNotedInLife(command: CommandView): boolean {
  return command.note === "" || command.history.some((phase) => phase.note === command.note);
}

/** The phases a command went through, each with how long after the order it came and its note. */
function Life(props: { command: CommandView }) {
  return (
    <ol class="life wire-text" aria-label="Its life so far">
      <For each={props.command.history}>
        {(phase) => (
          <li>
            {PHASE_NAMES[phase.phase].toLowerCase()}{" "}
            <span class="muted">+{formatAge(props.command.age_s - phase.age_s)}</span>
            <Show when={phase.note !== ""}> ({noteText(phase.phase, phase.note)})</Show>
          </li>
        )}
      </For>
    </ol>
  );
}
