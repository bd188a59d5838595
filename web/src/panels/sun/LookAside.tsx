import { createSignal, For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { LookAsideView } from "../../protocol";
import { text } from "../../text/catalogue";
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
    [fleet.lookAside, fleet.moveUpwind, fleet.imagerRelief].some(
      (motion) => motion !== null && !isOver(motion),
    );
  const order = async (serial: string) =>
    setProblem(responseProblem(await source.orders.lookAside(serial)));
  const button = (label: string, name: string, serial: string) => (
    <GuardButton
      label={label}
      of={text.lookAside.buttonOf(name, formatLength(ASIDE_M))}
      hold_ms={GUARD_MS}
      subject={isUnderWay() ? "" : serial}
      onConfirm={() => void order(serial)}
    />
  );
  const labelFor = (name: string) =>
    imagers().length > 1 ? text.lookAside.buttonFor(name) : text.lookAside.button;
  return (
    <section class="section" aria-label={text.lookAside.name}>
      <p class="muted">{text.lookAside.how(formatLength(ASIDE_M))}</p>
      <For each={imagers()} fallback={button(text.lookAside.button, text.lookAside.imager, "")}>
        {(vehicle) =>
          button(labelFor(vehicleLabel(vehicle)), vehicleLabel(vehicle), vehicle.serial ?? "")
        }
      </For>
      <Problem text={problem()} />
      <Show when={fleet.lookAside}>
        {(view) => <MotionProgress view={view()} stage={stageText(view())} testId="look-aside" />}
      </Show>
    </section>
  );
}

/** A stage as shown after the vehicle's name. */
function stageText({ stage, bearing_deg }: LookAsideView): string {
  return text.lookAside.stages[stage]?.(formatHeading(bearing_deg)) ?? stage;
}
