import { For, Show } from "solid-js";
import { useOrders, useStation } from "../../console";
import { targetsKey } from "../../orders/targets";
import type { FleetReturnView, ReturningView } from "../../protocol";
import { text } from "../../text/catalogue";
import { listNames, personName } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { formatLength, withLengthUnit } from "../../text/units";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Panel } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import "./return.css";

/** Return in layers: starts the fleet's return at separate heights and shows its progress. */
export function FleetReturn() {
  const { fleet } = useStation();
  const { orderApi, targets } = useOrders();
  const hasTargets = () => targets().serials.length > 0;
  const all = () => (fleet.vehicles.some(({ serial }) => serial !== null) ? "all" : "");
  return (
    <Panel title={text.panels.titles.return} name="return">
      <div class="section">
        <p class="muted">{text.fleetReturn.how}</p>
        <div class="section-buttons">
          <GuardButton
            label={text.fleetReturn.all}
            of={text.fleetReturn.allOf}
            hold_ms={GUARD_MS}
            subject={all()}
            onConfirm={() => void orderApi.fleetReturn(null, [text.fleetReturn.inReach])}
          />
          <Show when={hasTargets()}>
            <GuardButton
              label={text.fleetReturn.selected}
              of={text.fleetReturn.selectedOf(listNames(targets().labels))}
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
  const { behindS } = useStation();
  const count = () => props.view.vehicles.length;
  return (
    <section class="section" aria-label={text.fleetReturn.progress}>
      <p>
        <strong>
          {props.view.is_over
            ? text.fleetReturn.finished(landedCount(props.view), count())
            : text.fleetReturn.inProgress(landedCount(props.view), count())}
        </strong>{" "}
        <span class="muted wire-text">
          {text.fleetReturn.started(
            formatAge(props.view.age_s + behindS()),
            personName(props.view.called_by),
          )}
        </span>
      </p>
      <progress
        class="return-bar"
        max={Math.max(1, count())}
        value={landedCount(props.view)}
        aria-label={text.fleetReturn.landed}
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
  const { behindS } = useStation();
  const height = () => {
    const height_m = props.vehicle.layer_height_above_takeoff_m;
    return height_m === null ? null : formatLength(height_m);
  };
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
        <strong>{props.vehicle.vehicle_name}</strong> {text.fleetReturn.stages[props.vehicle.stage]}{" "}
        <span class="muted">
          {text.fleetReturn.since(
            formatAge(props.vehicle.since_age_s + behindS()),
            height(),
            props.vehicle.pad || null,
          )}
        </span>
        <Show when={props.vehicle.reason}>
          {(reason) => <span class="return-reason">{withLengthUnit(reason())}</span>}
        </Show>
      </span>
    </li>
  );
}

/** Whether an operator must act: the station does not fly this vehicle home. */
export function needsOperator({ stage }: ReturningView): boolean {
  return stage === "excluded";
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
    { title: text.fleetReturn.notIncluded, vehicles: excluded },
    ...waves.map((wave) => ({
      title: text.fleetReturn.wave(wave),
      vehicles: others.filter((vehicle) => vehicle.wave === wave),
    })),
    { title: text.fleetReturn.notScheduled, vehicles: others.filter(({ wave }) => wave === null) },
  ];
  return groups.filter((group) => group.vehicles.length > 0);
}
