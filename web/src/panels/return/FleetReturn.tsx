import { For, Show } from "solid-js";
import { useConsole } from "../../console";
import { targetsKey } from "../../orders/targets";
import type { FleetReturnView, ReturningView } from "../../protocol";
import { listNames, personName } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { formatLength } from "../../text/units";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Panel } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import "./return.css";

/** Return in layers: starts the fleet's return at separate heights and shows its progress. */
export function FleetReturn() {
  const { fleet, orderApi, targets } = useConsole();
  const hasTargets = () => targets().serials.length > 0;
  const all = () => (fleet.vehicles.some(({ serial }) => serial !== null) ? "all" : "");
  return (
    <Panel title="Return in layers" name="return">
      <div class="section">
        <p class="muted">
          Each vehicle holds first, then flies home at its own height and lands; one vehicle at a
          time per pad.
        </p>
        <div class="section-buttons">
          <GuardButton
            label="Return all"
            of="every vehicle, in layers"
            hold_ms={GUARD_MS}
            subject={all()}
            onConfirm={() => void orderApi.fleetReturn(null, ["all vehicles in reach"])}
          />
          <Show when={hasTargets()}>
            <GuardButton
              label="Return selected"
              of={`${listNames(targets().labels)}, in layers`}
              hold_ms={GUARD_MS}
              subject={targetsKey(targets())}
              onConfirm={() => void orderApi.fleetReturn(targets().serials, targets().labels)}
            />
          </Show>
        </div>
      </div>
      <Show when={fleet.fleetReturn}>{(view) => <Progress view={view()} />}</Show>
    </Panel>
  );
}

function Progress(props: { view: FleetReturnView }) {
  const { behindS } = useConsole();
  const count = () => props.view.vehicles.length;
  return (
    <section class="section" aria-label="Progress of the return">
      <p>
        <strong>
          {props.view.is_over ? "Finished" : "In progress"}: {landedCount(props.view)} of {count()}{" "}
          landed
        </strong>{" "}
        <span class="muted wire-text">
          Started {formatAge(props.view.age_s + behindS())} ago by{" "}
          {personName(props.view.called_by)}
        </span>
      </p>
      <progress
        class="return-bar"
        max={Math.max(1, count())}
        value={landedCount(props.view)}
        aria-label="Vehicles landed"
      />
      <For each={groupByWave(props.view)}>
        {(group) => (
          <section aria-label={group.title}>
            <h3 class="return-group">{group.title}</h3>
            <ul>
              <For each={group.vehicles}>{(vehicle) => <Returning vehicle={vehicle} />}</For>
            </ul>
          </section>
        )}
      </For>
    </section>
  );
}

function Returning(props: { vehicle: ReturningView }) {
  const { behindS } = useConsole();
  return (
    <li class="check" data-testid={`returning-${props.vehicle.serial}`}>
      <Show
        when={needsOperator(props.vehicle)}
        fallback={<span class="return-dot" aria-hidden="true" />}
      >
        <span class="tone-error">
          <SeverityMark severity="error" />
        </span>
      </Show>
      <span class="wire-text">
        <strong>{props.vehicle.vehicle_name}</strong> {STAGES[props.vehicle.stage]}{" "}
        <span class="muted">
          for {formatAge(props.vehicle.since_age_s + behindS())}
          <Where vehicle={props.vehicle} />
        </span>
        <Show when={props.vehicle.reason}>
          {(reason) => <span class="return-reason">{reason()}</span>}
        </Show>
      </span>
    </li>
  );
}

function Where(props: { vehicle: ReturningView }) {
  const height = () => props.vehicle.layer_height_above_takeoff_m;
  return (
    <>
      <Show when={height() !== null}>, {formatLength(height())} above takeoff</Show>
      <Show when={props.vehicle.pad}>{(pad) => <>, pad {pad()}</>}</Show>
    </>
  );
}

/** Stages as shown after the vehicle's name. */
export const STAGES: Readonly<Record<ReturningView["stage"], string>> = {
  stopping: "stopping",
  waiting: "waiting",
  ordered: "return ordered",
  flying: "flying home",
  landed: "landed",
  released: "under other control",
  left_out: "not included",
};

/** Whether an operator must act: the station does not fly this vehicle home. */
export function needsOperator({ stage }: ReturningView): boolean {
  return stage === "left_out";
}

export function landedCount(view: FleetReturnView): number {
  return view.vehicles.filter(({ stage }) => stage === "landed").length;
}

/** Vehicles under one heading. */
export interface ReturnGroup {
  readonly title: string;
  readonly vehicles: readonly ReturningView[];
}

/** Vehicles not included first, since they need an operator; then by wave, then unscheduled ones. */
export function groupByWave({ vehicles }: FleetReturnView): readonly ReturnGroup[] {
  const excluded = vehicles.filter(needsOperator);
  const others = vehicles.filter((vehicle) => !needsOperator(vehicle));
  const waves = [...new Set(others.flatMap(({ wave }) => wave ?? []))].sort((a, b) => a - b);
  const groups = [
    { title: "Not included: operator action needed", vehicles: excluded },
    ...waves.map((wave) => ({
      title: `Wave ${wave}`,
      vehicles: others.filter((vehicle) => vehicle.wave === wave),
    })),
    { title: "Not scheduled yet", vehicles: others.filter(({ wave }) => wave === null) },
  ];
  return groups.filter((group) => group.vehicles.length > 0);
}
