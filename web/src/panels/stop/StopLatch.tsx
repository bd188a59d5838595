import { createSignal, Show } from "solid-js";
import { useStation } from "../../console";
import type { StopLatchView } from "../../protocol";
import { text } from "../../text/catalogue";
import { listNames, personName, responseProblem, vehicleLabel } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import "./stop.css";

/** Shown while an all stop is in force: who stopped when, which vehicles it holds, and the release. */
export function StopBanner() {
  const { fleet } = useStation();
  return <Show when={fleet.stopLatch}>{(latch) => <StopInForce latch={latch()} />}</Show>;
}

function StopInForce(props: { latch: StopLatchView }) {
  const { fleet, source, behindS } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  const held = () => fleet.vehicles.filter((vehicle) => vehicle.is_stopped).map(vehicleLabel);
  const names = () => (held().length > 0 ? listNames(held()) : text.stop.later);
  const release = async () => setProblem(responseProblem(await source.orders.releaseStop(null)));
  return (
    <div class="card notice stop-latch" role="alert">
      <SeverityMark severity="critical" size={22} />
      <p>
        <strong>{text.stop.inForce}</strong>{" "}
        {text.stop.inForceText(
          personName(props.latch.by),
          formatAge(props.latch.age_s + behindS()),
          held().length,
        )}
      </p>
      <GuardButton
        label={text.stop.releaseAll}
        of={text.stop.releaseAllOf(names())}
        class="guard-grave"
        hold_ms={GUARD_MS}
        subject={`${props.latch.by} ${names()}`}
        onConfirm={() => void release()}
      />
      <Problem text={problem()} />
    </div>
  );
}

/** The release of one vehicle from the all stop. */
export function StopSection(props: { serial: string; name: string }) {
  const { source } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  const release = async () =>
    setProblem(responseProblem(await source.orders.releaseStop([props.serial])));
  return (
    <section class="section" aria-label={text.stop.section}>
      <p>
        <strong class="tone-critical">{text.stop.stopped}</strong> {text.stop.stoppedText}
      </p>
      <GuardButton
        label={text.stop.release}
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
