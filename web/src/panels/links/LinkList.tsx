import { createMemo, For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { LinkView, Severity } from "../../protocol";
import { agedBy, formatAge, formatBytes } from "../../text/quantities";
import { Empty, Panel } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import "./links.css";
import { WaitingApp } from "./WaitingApp";

const STATUS: Readonly<
  Record<LinkView["status"], { word: string; severity: Severity | null; rank: number }>
> = {
  waiting: { word: "Waiting", severity: "error", rank: -1 },
  conflict: { word: "Conflict", severity: "error", rank: 0 },
  unidentified: { word: "Unidentified", severity: "warning", rank: 1 },
  identified: { word: "Identified", severity: null, rank: 2 },
  closed: { word: "Closed", severity: null, rank: 3 },
};

/** Connections of companion apps; those that wait, conflicts and unidentified ones first. */
export function LinkList() {
  const { fleet } = useConsole();
  const sorted = createMemo(() =>
    [...fleet.links].sort((a, b) => STATUS[a.status].rank - STATUS[b.status].rank || b.id - a.id),
  );
  return (
    <Panel title="Links" name="links" count={sorted().length}>
      <Show when={sorted().length > 0} fallback={<Empty>No app connected.</Empty>}>
        <ul>
          <For each={sorted()}>{(link) => <LinkRow link={link} />}</For>
        </ul>
      </Show>
    </Panel>
  );
}

/** One line per link, with expandable details. */
function LinkRow(props: { link: LinkView }) {
  const { behindS } = useConsole();
  const status = () => STATUS[props.link.status];
  const serial = () =>
    props.link.claimed_serial ?? props.link.waiting?.serial ?? "no serial number yet";
  const lastAge = () => formatAge(agedBy(props.link.last_packet_age_s, behindS()));
  return (
    <li class="row link">
      <details>
        <summary class="row-line">
          <strong>Link {props.link.id}</strong>
          <span class="muted link-claim">{serial()}</span>
          <span class={`severity push tone-${status().severity ?? "info"}`}>
            <Show when={status().severity}>
              {(severity) => <SeverityMark severity={severity()} />}
            </Show>
            <Show when={faults(props.link) !== ""}>
              <span class="tone-warning">faults</span>
            </Show>
            {status().word}
          </span>
        </summary>
        <p class="wire-text">Serial number: {serial()}</p>
        <p class="muted wire-text">
          {props.link.remote_address}, {props.link.packets_received} packets,{" "}
          {formatBytes(props.link.bytes_received)}, last {lastAge()} ago
        </p>
        <Show when={faults(props.link)}>{(text) => <p class="tone-warning">{text()}</p>}</Show>
        <Show when={props.link.ignored_answers > 0}>
          <p class="tone-warning">
            {props.link.ignored_answers} answers ignored: they may belong to another command
          </p>
        </Show>
        <Show when={props.link.closed_reason}>
          {(reason) => <p class="wire-text">Closed: {reason()}</p>}
        </Show>
      </details>
      <Show when={props.link.waiting}>
        {(waiting) => (
          <WaitingApp
            linkId={props.link.id}
            address={props.link.remote_address}
            waiting={waiting()}
          />
        )}
      </Show>
    </li>
  );
}

/** Protocol errors of a link as text; empty without any. */
export function faults(link: LinkView): string {
  const counts: readonly (readonly [number, string])[] = [
    [link.bad_hash, "bad checksum"],
    [link.bad_size, "bad size"],
    [link.unknown_pid, "unknown packet type"],
    [link.ignored_reports, "invalid content"],
    [link.bytes_skipped, "bytes skipped"],
  ];
  return counts
    .filter(([count]) => count > 0)
    .map(([count, name]) => `${count} ${name}`)
    .join(", ");
}
