import { createSignal } from "solid-js";
import { useConsole } from "../../console";
import type { HazardView } from "../../protocol";
import { wordProblem } from "../../text/names";
import { formatAge, formatQuantity } from "../../text/quantities";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";

/** That a vehicle may be anywhere in its circle, and the word of somebody who knows better. */
export function HazardSection(props: { hazard: HazardView; name: string }) {
  const { source, behindS } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const dismiss = async () => {
    setProblem(wordProblem(await source.dismissHazard(props.hazard.dismissed_as)));
  };
  return (
    <section class="section" aria-label="Where it may be">
      <p>
        <strong class="tone-critical">
          Not heard for {formatAge(props.hazard.age_s + behindS())}.
        </strong>{" "}
        It may be anywhere within {formatQuantity(props.hazard.radius_m, "m", 0)} of where it was
        last seen, or on its way home. Others keep away from there until it is heard again.
      </p>
      <GuardButton
        label="I know where it is: dismiss the hazard"
        name={`Dismiss the hazard of ${props.name}`}
        class="guard-grave"
        hold_ms={GUARD_MS}
        subject={props.hazard.dismissed_as}
        onConfirm={() => void dismiss()}
      />
      <p class="muted">Only when somebody has seen the aircraft down, or holds it by its sticks.</p>
      <Problem text={problem()} />
    </section>
  );
}
