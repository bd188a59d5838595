import { createSignal, createUniqueId, Show } from "solid-js";
import { useConsole } from "../../console";
import { wordProblem } from "../../text/names";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";

/** A reason shorter than this tells nobody anything afterwards. */
const LEAST_REASON = 8;

/** Lets a vehicle fly missions although its checklist is not passed: with a typed reason, and held. */
export function Override(props: { serial: string; name: string; onTaken: () => void }) {
  const { source } = useConsole();
  const [reason, setReason] = createSignal("");
  const [problem, setProblem] = createSignal<string | null>(null);
  const field = createUniqueId();
  const typed = () => reason().trim();
  const isEnough = () => typed().length >= LEAST_REASON;
  // Not in the JSX: what is chosen there is a computation, and a held button reads it outside all owners.
  const subject = () => (isEnough() ? JSON.stringify([props.serial, typed()]) : "");
  const override = async () => {
    const outcome = await source.overridePreflight(props.serial, typed());
    setProblem(wordProblem(outcome));
    if (wordProblem(outcome) === null) props.onTaken();
  };
  return (
    <div class="override">
      <label for={field}>Fly missions all the same, because</label>
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
        label="Override the checklist"
        name={`Override the checklist of ${props.name}`}
        class="guard-grave"
        hold_ms={GUARD_MS}
        subject={subject()}
        onConfirm={() => void override()}
      />
      <Show when={!isEnough()}>
        <p class="muted">Type a reason first. It is kept in the audit.</p>
      </Show>
      <Problem text={problem()} />
    </div>
  );
}
