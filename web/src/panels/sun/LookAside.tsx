import { createSignal, For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { LookAsideView } from "../../protocol";
import { responseProblem, vehicleLabel } from "../../text/names";
import { formatHeading } from "../../text/quantities";
import { formatLength } from "../../text/units";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";
import { isOver, MotionProgress } from "./MotionProgress";

/** How far the station flies it aside. */
const ASIDE_M = 25;

/** Has an imaging drone fly aside and back, to tell even sun from even shade; and its progress. */
export function LookAside() {
  const { fleet, source } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const imagers = () => fleet.vehicles.filter(({ is_imager: isImager }) => isImager);
  const isUnderWay = () =>
    [fleet.lookAside, fleet.moveUpwind].some((motion) => motion !== null && !isOver(motion));
  const order = async (serial: string) =>
    setProblem(responseProblem(await source.lookAside(serial)));
  const button = (label: string, name: string, serial: string) => (
    <GuardButton
      label={label}
      of={`fly ${name} ${formatLength(ASIDE_M)} aside and back`}
      hold_ms={GUARD_MS}
      subject={isUnderWay() ? "" : serial}
      onConfirm={() => void order(serial)}
    />
  );
  const labelFor = (name: string) => (imagers().length > 1 ? `Look aside: ${name}` : "Look aside");
  return (
    <section class="section" aria-label="Look aside">
      <p class="muted">
        Under an even sky, an imaging drone flies {formatLength(ASIDE_M)} aside and back, to tell
        sun from shade.
      </p>
      <For each={imagers()} fallback={button("Look aside", "the imaging drone", "")}>
        {(vehicle) =>
          button(labelFor(vehicleLabel(vehicle)), vehicleLabel(vehicle), vehicle.serial ?? "")
        }
      </For>
      <Problem text={problem()} />
      <Show when={fleet.lookAside}>
        {(view) => (
          <MotionProgress
            view={view()}
            stage={`${STAGES[view().stage] ?? view().stage}, bearing ${formatHeading(view().bearing_deg)}`}
            testId="look-aside"
          />
        )}
      </Show>
    </section>
  );
}

/** Stages as shown after the vehicle's name. */
const STAGES: Readonly<Partial<Record<LookAsideView["stage"], string>>> = {
  aside: "flies aside",
  waiting: "waits beside its place",
  back: "flies back",
  done: "looked aside and is back",
  stopped: "stopped its look aside",
};
