import { For, Show } from "solid-js";
import { useConsole } from "../../console";
import { targetsKey } from "../../orders/targets";
import type { FleetReturnView, ReturningView } from "../../protocol";
import { listNames } from "../../text/names";
import { formatAge, formatQuantity } from "../../text/quantities";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Panel } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import "./return.css";

/** The whole fleet home as landing missions, each at a height of its own; and how far it has come. */
export function FleetReturn() {
  const { fleet, desk, targets } = useConsole();
  const isSome = () => targets().serials.length > 0;
  const all = () => (fleet.vehicles.some(({ serial }) => serial !== null) ? "all" : "");
  return (
    <Panel title="Return in layers">
      <div class="section">
        <p class="muted">
          Each vehicle first holds, then flies home and lands by itself, at a height of its own and
          one at a time at each pad.
        </p>
        <div class="section-buttons">
          <GuardButton
            label="All vehicles home"
            name="Return all vehicles in layers"
            hold_ms={GUARD_MS}
            subject={all()}
            onConfirm={() => void desk.fleetReturn(null, ["all vehicles in reach"])}
          />
          <Show when={isSome()}>
            <GuardButton
              label="Selected home"
              name={`Return ${listNames(targets().labels)} in layers`}
              hold_ms={GUARD_MS}
              subject={targetsKey(targets())}
              onConfirm={() => void desk.fleetReturn(targets().serials, targets().labels)}
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
    <section class="section" aria-label="How far the return has come">
      <p>
        <strong>
          {props.view.is_over ? "Over" : "Under way"}: {doneCount(props.view)} of {count()} landed
        </strong>{" "}
        <span class="muted wire-text">
          called {formatAge(props.view.age_s + behindS())} ago by {props.view.called_by}
        </span>
      </p>
      <progress
        class="return-bar"
        max={Math.max(1, count())}
        value={doneCount(props.view)}
        aria-label="Vehicles landed"
      />
      <For each={stagesInTurn(props.view)}>
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
      <Show when={isStuck(props.vehicle)} fallback={<span class="return-dot" aria-hidden="true" />}>
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
      <Show when={height() !== null}>, at {formatQuantity(height(), "m", 0)} above takeoff</Show>
      <Show when={props.vehicle.pad}>{(pad) => <>, to {pad()}</>}</Show>
    </>
  );
}

/** A stage as it is read after the vehicle's name. */
export const STAGES: Readonly<Record<ReturningView["stage"], string>> = {
  stopping: "stops",
  waiting: "waits",
  ordered: "is told to fly home",
  flying: "flies home",
  landed: "has landed",
  released: "is led by somebody else",
  left_out: "is left out",
};

/** Whether somebody must see to it: nobody flies it home. */
export function isStuck({ stage }: ReturningView): boolean {
  return stage === "left_out";
}

export function doneCount(view: FleetReturnView): number {
  return view.vehicles.filter(({ stage }) => stage === "landed").length;
}

/** Vehicles under one heading. */
export interface ReturnGroup {
  readonly title: string;
  readonly vehicles: readonly ReturningView[];
}

/** Those left out first, for they need somebody; then wave after wave, then those without a wave. */
export function stagesInTurn({ vehicles }: FleetReturnView): readonly ReturnGroup[] {
  const stuck = vehicles.filter(isStuck);
  const others = vehicles.filter((vehicle) => !isStuck(vehicle));
  const waves = [...new Set(others.flatMap(({ wave }) => wave ?? []))].sort((a, b) => a - b);
  const groups = [
    { title: "Left out: see to these", vehicles: stuck },
    ...waves.map((wave) => ({
      title: `Wave ${wave}`,
      vehicles: others.filter((vehicle) => vehicle.wave === wave),
    })),
    { title: "No wave yet", vehicles: others.filter(({ wave }) => wave === null) },
  ];
  return groups.filter((group) => group.vehicles.length > 0);
}
