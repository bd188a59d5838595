import { createSignal, For, Show } from "solid-js";
import { useStation } from "../../console";
import type { SideStepView } from "../../protocol";
import { text } from "../../text/catalogue";
import { responseProblem, vehicleLabel } from "../../text/names";
import { formatHeading } from "../../text/quantities";
import { formatLength } from "../../text/units";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";
import { isOver, MotionProgress } from "./MotionProgress";

/** How far the station flies it aside. */
const ASIDE_M = 25;

/** Has an imaging drone fly aside and back, to tell whether a uniform scene is all sun or all shade; and its progress. */
export function SideStep() {
  const { fleet, source } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  const imagers = () => fleet.vehicles.filter(({ is_imager: isImager }) => isImager);
  const isUnderWay = () =>
    [fleet.sideStep, fleet.moveUpwind, fleet.imagerRelief].some(
      (motion) => motion !== null && !isOver(motion),
    );
  const order = async (serial: string) =>
    setProblem(responseProblem(await source.orders.sideStep(serial)));
  const button = (label: string, name: string, serial: string) => (
    <GuardButton
      label={label}
      of={text.sideStep.buttonOf(name, formatLength(ASIDE_M))}
      hold_ms={GUARD_MS}
      subject={isUnderWay() ? "" : serial}
      onConfirm={() => void order(serial)}
    />
  );
  const labelFor = (name: string) =>
    imagers().length > 1 ? text.sideStep.buttonFor(name) : text.sideStep.button;
  return (
    <section class="section" aria-label={text.sideStep.name}>
      <p class="muted">{text.sideStep.how(formatLength(ASIDE_M))}</p>
      <For each={imagers()} fallback={button(text.sideStep.button, text.sideStep.imager, "")}>
        {(vehicle) =>
          button(labelFor(vehicleLabel(vehicle)), vehicleLabel(vehicle), vehicle.serial ?? "")
        }
      </For>
      <Problem text={problem()} />
      <Show when={fleet.sideStep}>
        {(view) => <MotionProgress view={view()} stage={stageText(view())} testId="side-step" />}
      </Show>
    </section>
  );
}

/** A stage as shown after the vehicle's name. */
function stageText({ stage, bearing_deg }: SideStepView): string {
  return text.sideStep.stages[stage]?.(formatHeading(bearing_deg)) ?? stage;
}
