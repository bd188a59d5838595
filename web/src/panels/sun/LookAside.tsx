import { createSignal, For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { LookAsideView } from "../../protocol";
import { personName, responseProblem, vehicleLabel } from "../../text/names";
import { formatAge, formatHeading } from "../../text/quantities";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";

/** Has an imaging drone fly aside and back, to tell even sun from even shade; and its progress. */
export function LookAside() {
  const { fleet, source } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const imagers = () => fleet.vehicles.filter(({ is_imager: isImager }) => isImager);
  const isUnderWay = () => fleet.lookAside !== null && !isOver(fleet.lookAside);
  const order = async (serial: string) =>
    setProblem(responseProblem(await source.lookAside(serial)));
  const button = (label: string, name: string, serial: string) => (
    <GuardButton
      label={label}
      name={`Fly ${name} 25 m aside and back`}
      hold_ms={GUARD_MS}
      subject={isUnderWay() ? "" : serial}
      onConfirm={() => void order(serial)}
    />
  );
  const labelFor = (name: string) => (imagers().length > 1 ? `Look aside: ${name}` : "Look aside");
  return (
    <section class="section" aria-label="Look aside">
      <p class="muted">
        Under an even sky, an imaging drone flies 25&nbsp;m aside and back, to tell sun from shade.
      </p>
      <For each={imagers()} fallback={button("Look aside", "the imaging drone", "")}>
        {(vehicle) =>
          button(labelFor(vehicleLabel(vehicle)), vehicleLabel(vehicle), vehicle.serial ?? "")
        }
      </For>
      <Problem text={problem()} />
      <Show when={fleet.lookAside}>{(view) => <Progress view={view()} />}</Show>
    </section>
  );
}

function Progress(props: { view: LookAsideView }) {
  const { behindS } = useConsole();
  return (
    <p class="wire-text" data-testid="look-aside">
      <strong>{props.view.vehicle_name}</strong> {STAGES[props.view.stage]}, bearing{" "}
      {formatHeading(props.view.bearing_deg)}{" "}
      <span class="muted">
        since {formatAge(props.view.since_age_s + behindS())}, ordered by{" "}
        {personName(props.view.begun_by)}
      </span>
      <Show when={props.view.reason}>
        {(reason) => <span class="muted look-aside-reason">{reason()}</span>}
      </Show>
    </p>
  );
}

/** Stages as shown after the vehicle's name. */
const STAGES: Readonly<Record<LookAsideView["stage"], string>> = {
  aside: "flies aside",
  waiting: "waits beside its place",
  back: "flies back",
  done: "looked aside and is back",
  stopped: "stopped its look aside",
};

function isOver({ stage }: LookAsideView): boolean {
  return stage === "done" || stage === "stopped";
}
