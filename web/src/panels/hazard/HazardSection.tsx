import { createSignal } from "solid-js";
import { useStation } from "../../console";
import type { HazardView } from "../../protocol";
import { text } from "../../text/catalogue";
import { responseProblem } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { formatLength } from "../../text/units";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";

/** A lost vehicle's hazard area, and the button to clear it. */
export function HazardSection(props: { hazard: HazardView; name: string }) {
  const { source, behindS } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  const clear = async () => {
    setProblem(responseProblem(await source.vehicles.dismissHazard(props.hazard.dismissal_name)));
  };
  return (
    <section class="section" aria-label={text.hazard.name}>
      <p>
        <strong class="tone-critical">
          {text.hazard.noTelemetry(formatAge(props.hazard.age_s + behindS()))}
        </strong>{" "}
        {text.hazard.where(formatLength(props.hazard.radius_m))}
      </p>
      <GuardButton
        label={text.hazard.clear}
        of={props.name}
        class="guard-grave"
        hold_ms={GUARD_MS}
        subject={props.hazard.dismissal_name}
        onConfirm={() => void clear()}
      />
      <p class="muted">{text.hazard.clearWhen}</p>
      <Problem text={problem()} />
    </section>
  );
}
