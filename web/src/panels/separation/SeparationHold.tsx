import { createSignal, Show } from "solid-js";
import { useStation } from "../../console";
import { text } from "../../text/catalogue";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";
import { SeverityMark } from "../SeverityMark";

/** Shown while the separation hold is off and close vehicles only raise an alarm. */
export function SeparationBanner() {
  const { fleet } = useStation();
  return (
    <Show when={fleet.station?.separation_hold_on === false}>
      <div class="card notice separation-off" role="alert">
        <SeverityMark severity="warning" size={22} />
        <p>
          <strong>{text.separation.isOff}</strong> {text.separation.offText}
        </p>
        <SeparationSwitch />
      </div>
    </Show>
  );
}

/** On with one press, off only with a held button. */
export function SeparationSwitch() {
  const { source, fleet, lacks } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  const isOn = () => fleet.station?.separation_hold_on ?? true;
  const turn = async (on: boolean) => {
    const outcome = await source.station.setSeparationHold(on);
    setProblem(outcome.kind === "failed" ? outcome.problem : null);
  };
  return (
    <>
      <Show
        when={isOn()}
        fallback={
          <button
            type="button"
            class="button"
            disabled={lacks("operator") !== null}
            title={lacks("operator") ?? undefined}
            onClick={() => void turn(true)}
          >
            {text.separation.switchOn}
          </button>
        }
      >
        <GuardButton
          label={text.separation.switchOff}
          needs="admin"
          class="guard-grave"
          hold_ms={GUARD_MS}
          subject="off"
          onConfirm={() => void turn(false)}
        />
      </Show>
      <Problem text={problem()} />
    </>
  );
}
