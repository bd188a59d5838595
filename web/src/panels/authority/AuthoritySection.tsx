import { createSignal, Show } from "solid-js";
import { useStation } from "../../console";
import { anothersLease } from "../../fleet/operatorLease";
import type { AuthorityHolder, AuthorityView, LeaseView } from "../../protocol";
import { text } from "../../text/catalogue";
import { personName, responseProblem } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { BRIEF_MS, GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";
import "./authority.css";
import { OperatorLease } from "./OperatorLease";

/** Who controls a vehicle, since when and why; take over, or hand over to the pilot. */
export function AuthoritySection(props: {
  serial: string;
  name: string;
  authority: AuthorityView;
  lease: LeaseView | null;
}) {
  const { source } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  const transfer = async (holder: AuthorityHolder, takeOver = false) => {
    setProblem(responseProblem(await source.vehicles.setAuthority(props.serial, holder, takeOver)));
  };
  const others = () => anothersLease(props.lease, source.person());
  const subject = () => JSON.stringify([props.serial, props.authority.holder, others()?.person]);
  return (
    <section class="section" aria-label={text.authority.name}>
      <AuthorityText authority={props.authority} />
      <Show when={props.lease}>{(lease) => <OperatorLease lease={lease()} />}</Show>
      <div class="section-buttons">
        <Show when={others()}>
          {(lease) => (
            <GuardButton
              label={text.authority.takeOverFrom(lease().person)}
              of={props.name}
              class="guard-grave"
              hold_ms={GUARD_MS}
              subject={subject()}
              onConfirm={() => void transfer("operator", true)}
            />
          )}
        </Show>
        <Show when={props.authority.holder !== "operator" && others() === null}>
          <GuardButton
            label={text.authority.takeOver}
            of={props.name}
            hold_ms={BRIEF_MS}
            subject={subject()}
            onConfirm={() => void transfer("operator")}
          />
        </Show>
        <Show when={props.authority.holder !== "pilot"}>
          <GuardButton
            label={text.authority.handOver}
            needs="pilot"
            of={props.name}
            hold_ms={BRIEF_MS}
            subject={subject()}
            onConfirm={() => void transfer("pilot")}
          />
        </Show>
      </div>
      <Problem text={problem()} />
    </section>
  );
}

function AuthorityText(props: { authority: AuthorityView }) {
  const { behindS } = useStation();
  const since = () => {
    const { age_s } = props.authority;
    return age_s === null
      ? text.authority.sinceStart
      : text.authority.since(formatAge(age_s + behindS()));
  };
  return (
    <p class="wire-text">
      <strong class={`authority authority-${props.authority.holder}`}>
        {text.authority.control[props.authority.holder]}
      </strong>
      <Show when={props.authority.holder_name !== ""}>
        {" "}
        ({personName(props.authority.holder_name)})
      </Show>{" "}
      <span class="muted">
        {since()}
        <Show when={props.authority.reason !== ""}>: {personName(props.authority.reason)}</Show>
      </span>
    </p>
  );
}
