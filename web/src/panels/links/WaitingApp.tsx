import { createSignal, Show } from "solid-js";
import { useStation } from "../../console";
import type { WaitingAppView } from "../../protocol";
import { text } from "../../text/catalogue";
import { responseProblem } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";

/** An app that the station's list does not admit: why, since when, and what to decide. */
export function WaitingApp(props: { linkId: number; address: string; waiting: WaitingAppView }) {
  const { source, behindS } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  const admit = async (lasting: "always" | "session") => {
    const { serial } = props.waiting;
    if (serial === null) return;
    setProblem(responseProblem(await source.station.admitApp(props.linkId, serial, lasting)));
  };
  const refuse = async () =>
    setProblem(responseProblem(await source.station.refuseApp(props.linkId)));
  // Another serial than the operator compared cancels a hold; without one nothing can be admitted.
  const subject = () => props.waiting.serial ?? "";
  const name = () => props.waiting.serial ?? text.names.link(props.linkId);
  return (
    <section class="waiting-app" aria-label={text.waitingApp.name(name())}>
      <p class="wire-text">
        {text.waitingApp.from(
          <strong>{props.waiting.serial ?? text.waitingApp.noSerial}</strong>,
          props.address,
          <span class="muted">
            {text.waitingApp.waits(
              formatAge(props.waiting.age_s + behindS()),
              props.waiting.reason,
            )}
          </span>,
        )}
      </p>
      <Show when={props.waiting.is_flying === true}>
        <p class="tone-error">{text.waitingApp.flies}</p>
      </Show>
      <p class="muted">{text.waitingApp.compare}</p>
      <div class="section-buttons">
        <GuardButton
          label={text.waitingApp.admit}
          of={text.waitingApp.admitOf(name())}
          hold_ms={GUARD_MS}
          subject={subject()}
          onConfirm={() => void admit("always")}
        />
        <GuardButton
          label={text.waitingApp.admitOnce}
          of={text.waitingApp.admitOnceOf(name())}
          hold_ms={GUARD_MS}
          subject={subject()}
          onConfirm={() => void admit("session")}
        />
        <GuardButton
          label={text.waitingApp.refuse}
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
