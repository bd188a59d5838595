import { createSignal, Show } from "solid-js";
import { useConsole } from "../../console";
import type { StopLatchView } from "../../protocol";
import { listNames, personName, responseProblem, vehicleLabel } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import "./stop.css";

/** Shown while an all stop is in force: who stopped when, which vehicles it holds, and the release. */
export function StopBanner() {
  const { fleet } = useConsole();
  return <Show when={fleet.stopLatch}>{(latch) => <StopInForce latch={latch()} />}</Show>;
}

function StopInForce(props: { latch: StopLatchView }) {
  const { fleet, source, behindS } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const held = () => fleet.vehicles.filter((vehicle) => vehicle.is_stopped).map(vehicleLabel);
  const names = () => (held().length > 0 ? listNames(held()) : "vehicles that connect later");
  const release = async () => setProblem(responseProblem(await source.releaseStop(null)));
  return (
    <div class="card notice stop-latch" role="alert">
      <SeverityMark severity="critical" size={22} />
      <p>
        <strong>All stop in force</strong> by {personName(props.latch.by)},{" "}
        {formatAge(props.latch.age_s + behindS())} ago. {heldText(held().length)}: only hover,
        return and land are sent. An operator or an administrator can release it.
      </p>
      <GuardButton
        label="Release all"
        of={`the all stop of ${names()}`}
        class="guard-grave"
        hold_ms={GUARD_MS}
        subject={`${props.latch.by} ${names()}`}
        onConfirm={() => void release()}
      />
      <Problem text={problem()} />
    </div>
  );
}

function heldText(count: number): string {
  if (count === 0) return "Vehicles that connect later";
  return count === 1 ? "1 drone" : `${count} drones`;
}

/** The release of one vehicle from the all stop. */
export function StopSection(props: { serial: string; name: string }) {
  const { source } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const release = async () => setProblem(responseProblem(await source.releaseStop([props.serial])));
  return (
    <section class="section" aria-label="All stop">
      <p>
        <strong class="tone-critical">Stopped.</strong> An all stop holds this vehicle. A release
        sends nothing, and nothing resumes.
      </p>
      <GuardButton
        label="Release this vehicle"
        of={props.name}
        class="guard-grave"
        hold_ms={GUARD_MS}
        subject={props.serial}
        onConfirm={() => void release()}
      />
      <Problem text={problem()} />
    </section>
  );
}
