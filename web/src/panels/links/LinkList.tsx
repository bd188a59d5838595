import { createMemo, For, Show } from "solid-js";
import { useStation } from "../../console";
import type { LinkView, Severity } from "../../protocol";
import { text } from "../../text/catalogue";
import { agedBy, formatAge, formatBytes } from "../../text/quantities";
import { Empty, Panel } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import "./links.css";
import { WaitingApp } from "./WaitingApp";

const STATUS: Readonly<Record<LinkView["status"], { severity: Severity | null; rank: number }>> = {
  waiting: { severity: "error", rank: -1 },
  conflict: { severity: "error", rank: 0 },
  unidentified: { severity: "warning", rank: 1 },
  identified: { severity: null, rank: 2 },
  closed: { severity: null, rank: 3 },
};

/** Connections of companion apps; those that wait, conflicts and unidentified ones first. */
export function LinkList() {
  const { fleet } = useStation();
  const sorted = createMemo(() =>
    [...fleet.links].sort((a, b) => STATUS[a.status].rank - STATUS[b.status].rank || b.id - a.id),
  );
  return (
    <Panel title={text.panels.titles.links} name="links" count={sorted().length}>
      <Show when={sorted().length > 0} fallback={<Empty>{text.links.none}</Empty>}>
        <ul>
          <For each={sorted()}>{(link) => <LinkRow link={link} />}</For>
        </ul>
      </Show>
    </Panel>
  );
}

/** One line per link, with expandable details. */
function LinkRow(props: { link: LinkView }) {
  const { behindS } = useStation();
  const status = () => STATUS[props.link.status];
  const serial = () =>
    props.link.claimed_serial ?? props.link.waiting?.serial ?? text.links.noSerial;
  const lastAge = () => formatAge(agedBy(props.link.last_packet_age_s, behindS()));
  return (
    <li class="row link">
      <details>
        <summary class="row-line">
          <strong>{text.links.link(props.link.id)}</strong>
          <span class="muted link-claim">{serial()}</span>
          <span class={`severity push tone-${status().severity ?? "info"}`}>
            <Show when={status().severity}>
              {(severity) => <SeverityMark severity={severity()} />}
            </Show>
            <Show when={faults(props.link) !== ""}>
              <span class="tone-warning">{text.links.faults}</span>
            </Show>
            {text.links.states[props.link.status]}
          </span>
        </summary>
        <p class="wire-text">{text.links.serial(serial())}</p>
        <p class="muted wire-text">
          {text.links.traffic(
            props.link.remote_address,
            props.link.packets_received,
            formatBytes(props.link.bytes_received),
            lastAge(),
          )}
        </p>
        <Show when={props.link.figures}>
          {(figures) => <p class="muted">{text.links.figures(figures())}</p>}
        </Show>
        <Show when={faults(props.link)}>{(counts) => <p class="tone-warning">{counts()}</p>}</Show>
        <Show when={props.link.ignored_answers > 0}>
          <p class="tone-warning">{text.links.ignoredAnswers(props.link.ignored_answers)}</p>
        </Show>
        <Show when={props.link.closed_reason}>
          {(reason) => <p class="wire-text">{text.links.closed(reason())}</p>}
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
  const counts = [
    [link.bad_hash, text.links.badChecksum],
    [link.bad_size, text.links.badSize],
    [link.unknown_pid, text.links.unknownType],
    [link.ignored_reports, text.links.invalid],
    [link.bytes_skipped, text.links.skipped],
  ] as const;
  return counts
    .filter(([count]) => count > 0)
    .map(([count, named]) => named(count))
    .join(", ");
}
