import { createSignal, Show } from "solid-js";
import { useConsole } from "../../console";
import type { LookAsideView } from "../../protocol";
import { issuerName, responseProblem, vehicleLabel } from "../../text/names";
import { formatAge, formatHeading } from "../../text/quantities";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";

/** Has the imaging drone fly aside and back, to tell even sun from even shade; and its progress. */
export function LookAside() {
  const { fleet, source } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const imager = () => fleet.vehicles.find(({ is_imager: isImager }) => isImager) ?? null;
  const name = () => {
    const vehicle = imager();
    return vehicle === null ? "the imaging drone" : vehicleLabel(vehicle);
  };
  const isUnderWay = () => fleet.lookAside !== null && !isOver(fleet.lookAside);
  const subject = () => (isUnderWay() ? "" : (imager()?.serial ?? ""));
  const order = async () => setProblem(responseProblem(await source.lookAside()));
  return (
    <section class="section" aria-label="Look aside">
      <p class="muted">
        Under an even sky, {name()} flies 25&nbsp;m aside and back, to tell sun from shade.
      </p>
      <GuardButton
        label="Look aside"
        name={`Fly ${name()} 25 m aside and back`}
        hold_ms={GUARD_MS}
        subject={subject()}
        onConfirm={() => void order()}
      />
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
        {issuerName(props.view.begun_by)}
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
