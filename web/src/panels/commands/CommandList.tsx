import { For, Show } from "solid-js";
import { useStation } from "../../console";
import type { CommandView } from "../../protocol";
import { text } from "../../text/catalogue";
import {
  capitalised,
  commandName,
  personName,
  phaseTone,
  ruleTitle,
  withoutNumbers,
} from "../../text/names";
import { formatAge } from "../../text/quantities";
import { Empty, Panel } from "../Panel";
import "./commands.css";

/**
 * Commands and their phases, newest first as sorted by the station. Ids do not give the order: the
 * station's own commands have negative ids.
 */
export function CommandList() {
  const { fleet } = useStation();
  return (
    <Panel title={text.panels.titles.orders} name="orders" count={fleet.commands.length}>
      <Show when={fleet.commands.length > 0} fallback={<Empty>{text.commands.none}</Empty>}>
        <ol>
          <For each={fleet.commands}>{(command) => <CommandRow command={command} />}</For>
        </ol>
      </Show>
    </Panel>
  );
}

function CommandRow(props: { command: CommandView }) {
  const { behindS } = useStation();
  return (
    <li class="row command" data-testid={`command-${props.command.id}`}>
      <div class="row-line">
        <strong class="wire-text">
          {commandName(props.command.kind)} {props.command.vehicle_name}
        </strong>
        <span class={`phase phase-${phaseTone(props.command)} push`} data-testid="phase">
          {text.commands.phases[props.command.phase]}
        </span>
      </div>
      <PhaseHistory command={props.command} />
      <p class="muted wire-text">
        {text.commands.issued({
          person: capitalised(personName(props.command.issued_by)),
          age: formatAge(props.command.age_s + behindS()),
          timesSent: props.command.times_sent,
          takeoff: props.command.takeoff,
          altitudes: props.command.sent_altitudes,
        })}
      </p>
      <Show when={props.command.part}>
        {(part) => <p>{text.commands.mission(<strong>{part()}</strong>)}</p>}
      </Show>
      <Show when={props.command.repairs.length > 0}>
        <Repairs repairs={props.command.repairs} />
      </Show>
      <Show when={!isNoteInHistory(props.command)}>
        <p class="wire-text" title={ruleTitle(props.command.rule)}>
          {withoutNumbers(props.command.note)}
        </p>
      </Show>
    </li>
  );
}

/** Changes the station made to a mission so that the aircraft accepts it. */
function Repairs(props: { repairs: readonly string[] }) {
  return (
    <details class="repairs wire-text">
      <summary>{text.commands.adjusted(props.repairs.length)}</summary>
      <ul>
        <For each={props.repairs}>{(repair) => <li>{repair}</li>}</For>
      </ul>
    </details>
  );
}

/** Whether the command's note is already shown with one of its phases. */
function isNoteInHistory(command: CommandView): boolean {
  return command.note === "" || command.history.some((phase) => phase.note === command.note);
}

/** A phase's note without the phase's own name before it: "by order 5" of "Replaced by order 5". */
function noteBesideName(shown: CommandView["history"][number]): string {
  const name = text.commands.phases[shown.phase];
  const isNamed = shown.note.startsWith(`${name} `);
  return withoutNumbers(isNamed ? shown.note.slice(name.length + 1) : shown.note);
}

/** A command's phases, each with its time since the order and its note. */
function PhaseHistory(props: { command: CommandView }) {
  return (
    <ol
      class="command-history wire-text"
      aria-label={text.commands.history}
      title={ruleTitle(props.command.rule)}
    >
      <For each={props.command.history}>
        {(phase) => (
          <li>
            {text.commands.phaseInHistory(phase.phase)}{" "}
            <span class="muted">+{formatAge(props.command.age_s - phase.age_s)}</span>
            <Show when={phase.note !== ""}> ({noteBesideName(phase)})</Show>
          </li>
        )}
      </For>
    </ol>
  );
}
