import { Show } from "solid-js";
import { useStation } from "../../console";
import { anothersLease } from "../../fleet/operatorLease";
import type { LeaseView } from "../../protocol";
import { text } from "../../text/catalogue";
import { formatAge } from "../../text/quantities";

/** The person who operates a vehicle, since when, and whether that person is there. */
export function OperatorLease(props: { lease: LeaseView }) {
  const { source, behindS } = useStation();
  const isOwn = () => anothersLease(props.lease, source.person()) === null;
  const since = () => {
    const age = formatAge(props.lease.age_s + behindS());
    const { absent_s } = props.lease;
    return absent_s === null
      ? text.authority.operatedFor(age)
      : text.authority.absent(age, formatAge(absent_s + behindS()));
  };
  return (
    <p class="wire-text">
      {text.authority.operatedBy(
        <strong>{isOwn() ? text.authority.you(props.lease.person) : props.lease.person}</strong>,
      )}{" "}
      <span class="muted">{since()}</span>
      <Show when={!isOwn()}>
        <br />
        <span class="muted">{text.authority.refused}</span>
      </Show>
    </p>
  );
}
