import { createSignal, createUniqueId, Show } from "solid-js";
import { useStation } from "../../console";
import { text } from "../../text/catalogue";
import { responseProblem } from "../../text/names";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";

/** Shortest accepted reason: anything shorter is useless in the audit log. */
const MIN_REASON_LENGTH = 8;

/** Overrides a failed checklist, with a typed reason and a held button. */
export function Override(props: { serial: string; name: string; onAccepted: () => void }) {
  const { source } = useStation();
  const [reason, setReason] = createSignal("");
  const [problem, setProblem] = createSignal<string | null>(null);
  const field = createUniqueId();
  const typed = () => reason().trim();
  const isEnough = () => typed().length >= MIN_REASON_LENGTH;
  // Not inline in the JSX, where it would be a computation that a held button reads outside any owner.
  const subject = () => (isEnough() ? JSON.stringify([props.serial, typed()]) : "");
  const override = async () => {
    const outcome = await source.vehicles.overridePreflight(props.serial, typed());
    setProblem(responseProblem(outcome));
    if (responseProblem(outcome) === null) props.onAccepted();
  };
  return (
    <div class="override">
      <label for={field}>{text.preflight.reason}</label>
      <input
        id={field}
        class="field"
        type="text"
        autocomplete="off"
        maxLength={500}
        value={reason()}
        onInput={(event) => setReason(event.currentTarget.value)}
      />
      <GuardButton
        needs="admin"
        label={text.preflight.override}
        of={props.name}
        class="guard-grave"
        hold_ms={GUARD_MS}
        subject={subject()}
        onConfirm={() => void override()}
      />
      <Show when={!isEnough()}>
        <p class="muted">{text.preflight.enterReason(MIN_REASON_LENGTH)}</p>
      </Show>
      <Problem text={problem()} />
    </div>
  );
}
