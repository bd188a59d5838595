import { createSignal, Show } from "solid-js";
import { useConsole } from "../../console";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";
import { SeverityMark } from "../SeverityMark";

/** Shown while the separation hold is off and close vehicles only raise an alarm. */
export function SeparationBanner() {
  const { fleet } = useConsole();
  return (
    <Show when={fleet.station?.separation_hold_on === false}>
      <div class="card notice separation-off" role="alert">
        <SeverityMark severity="warning" size={22} />
        <p>
          <strong>Separation hold is OFF.</strong> Vehicles that come too close raise an alarm but
          are not stopped.
        </p>
        <SeparationSwitch />
      </div>
    </Show>
  );
}

/** On with one press, off only with a held button. */
export function SeparationSwitch() {
  const { source, fleet, lacks } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const isOn = () => fleet.station?.separation_hold_on ?? true;
  const turn = async (on: boolean) => {
    const outcome = await source.setSeparationHold(on);
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
            Switch separation hold on
          </button>
        }
      >
        <GuardButton
          label="Switch separation hold off"
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
