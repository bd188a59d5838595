import { Show } from "solid-js";
import { useConsole } from "../../console";
import { anothersLease } from "../../fleet/operatorLease";
import type { LeaseView } from "../../protocol";
import { formatAge } from "../../text/quantities";

/** The person who operates a vehicle, since when, and whether that person is there. */
export function OperatorLease(props: { lease: LeaseView }) {
  const { source, behindS } = useConsole();
  const isOwn = () => anothersLease(props.lease, source.person()) === null;
  return (
    <p class="wire-text">
      Operated by <strong>{isOwn() ? `${props.lease.person} (you)` : props.lease.person}</strong>{" "}
      <span class="muted">
        for {formatAge(props.lease.age_s + behindS())}
        <Show when={props.lease.absent_s !== null}>
          , not connected for {formatAge((props.lease.absent_s ?? 0) + behindS())}
        </Show>
      </span>
      <Show when={!isOwn()}>
        <br />
        <span class="muted">
          Your orders to move it are refused. Hover, return, land and all stop are accepted.
        </span>
      </Show>
    </p>
  );
}
