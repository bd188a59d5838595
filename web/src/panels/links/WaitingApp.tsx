import { createSignal, Show } from "solid-js";
import { useConsole } from "../../console";
import type { WaitingAppView } from "../../protocol";
import { responseProblem } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";

/** An app that the station's list does not admit: why, since when, and what to decide. */
export function WaitingApp(props: { linkId: number; address: string; waiting: WaitingAppView }) {
  const { source, behindS } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const admit = async (lasting: "always" | "session") => {
    const { serial } = props.waiting;
    if (serial === null) return;
    setProblem(responseProblem(await source.admitApp(props.linkId, serial, lasting)));
  };
  const refuse = async () => setProblem(responseProblem(await source.refuseApp(props.linkId)));
  // Another serial than the operator compared cancels a hold; without one nothing can be admitted.
  const subject = () => props.waiting.serial ?? "";
  const name = () => props.waiting.serial ?? `link ${props.linkId}`;
  return (
    <section class="waiting-app" aria-label={`Admit ${name()}`}>
      <p class="wire-text">
        <strong>{props.waiting.serial ?? "No serial number yet"}</strong> from {props.address}{" "}
        <span class="muted">
          waits for {formatAge(props.waiting.age_s + behindS())}: {props.waiting.reason}
        </span>
      </p>
      <Show when={props.waiting.is_flying === true}>
        <p class="tone-error">Reports flight: others keep clear of it, and stops reach it.</p>
      </Show>
      <p class="muted">An app's serial is not authenticated: compare it with the aircraft.</p>
      <div class="section-buttons">
        <GuardButton
          label="Admit"
          of={`${name()} for good, from its present address`}
          hold_ms={GUARD_MS}
          subject={subject()}
          onConfirm={() => void admit("always")}
        />
        <GuardButton
          label="Admit for this run"
          of={`${name()} until the station stops`}
          hold_ms={GUARD_MS}
          subject={subject()}
          onConfirm={() => void admit("session")}
        />
        <GuardButton
          label="Refuse for 5 min"
          of={name()}
          hold_ms={GUARD_MS}
          subject={`${props.linkId} ${subject()}`}
          onConfirm={() => void refuse()}
        />
      </div>
      <Problem text={problem()} />
    </section>
  );
}
