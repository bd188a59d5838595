import { createSignal } from "solid-js";
import { useConsole } from "../../console";
import type { HazardView } from "../../protocol";
import { responseProblem } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { formatLength } from "../../text/units";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";

/** A lost vehicle's hazard area, and the button to clear it. */
export function HazardSection(props: { hazard: HazardView; name: string }) {
  const { source, behindS } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const clear = async () => {
    setProblem(responseProblem(await source.dismissHazard(props.hazard.dismissal_name)));
  };
  return (
    <section class="section" aria-label="Hazard area">
      <p>
        <strong class="tone-critical">
          No telemetry for {formatAge(props.hazard.age_s + behindS())}.
        </strong>{" "}
        The vehicle may be anywhere within {formatLength(props.hazard.radius_m)} of its last
        position, or on its way home. Other vehicles keep clear until telemetry returns.
      </p>
      <GuardButton
        label="Clear hazard area"
        of={props.name}
        class="guard-grave"
        hold_ms={GUARD_MS}
        subject={props.hazard.dismissal_name}
        onConfirm={() => void clear()}
      />
      <p class="muted">Only if the aircraft is confirmed on the ground or under manual control.</p>
      <Problem text={problem()} />
    </section>
  );
}
