import { createMemo, Show } from "solid-js";
import { useOrders, useStation } from "../../console";
import { doing, surveyPart } from "../../fleet/activity";
import { anothersLease } from "../../fleet/operatorLease";
import { hasBatteryWarning } from "../../fleet/readiness";
import {
  badgeText,
  simulation,
  stalenessNow,
  vehicleKey,
  vehicleStatus,
} from "../../fleet/vehicleStatus";
import type { VehicleView } from "../../protocol";
import { text } from "../../text/catalogue";
import { vehicleLabel } from "../../text/names";
import { agedBy, formatAge, formatFraction } from "../../text/quantities";
import { colourOf, lookClasses } from "../../theme/theme";
import { LinkBars } from "../links/LinkBars";

/** One vehicle in two lines: its badge adds it to the selection, the rest selects only it. */
export function VehicleRow(props: { vehicle: VehicleView }) {
  const { fleet, behindS } = useStation();
  const { selection } = useOrders();
  const vehicle = () => props.vehicle;
  const key = () => vehicleKey(vehicle());
  const status = createMemo(() => vehicleStatus(vehicle(), behindS()));
  const isStale = () => stalenessNow(vehicle(), behindS()) !== "live";
  const isSelected = () => selection.has(key());
  const isMixed = () => simulation(fleet.vehicles) === "mixed";
  const part = () => surveyPart(fleet.surveys, vehicle().serial);
  return (
    <li
      class={`vehicle own-colour ${lookClasses(key())}`}
      classList={{ "is-stale": isStale(), "is-selected": isSelected() }}
      style={{ "--own": colourOf(key()) }}
    >
      <label class="vehicle-box" title={text.vehicles.selectHint}>
        <input
          type="checkbox"
          class="hidden-but-read"
          checked={isSelected()}
          aria-label={text.vehicles.select(vehicleLabel(vehicle()))}
          onChange={() => selection.toggle(key())}
        />
        <span class="badge">{badgeText(vehicle())}</span>
      </label>
      <button
        type="button"
        class="vehicle-body"
        aria-pressed={isSelected()}
        onClick={() => selection.only(key())}
      >
        <span class="vehicle-name">
          {vehicle().name}
          <Show when={isMixed() && vehicle().is_simulated}>
            {" "}
            <span class="tag tag-simulated">{text.vehicles.simulated}</span>
          </Show>
        </span>
        <Battery vehicle={vehicle()} />
        <span
          class={`vehicle-doing tone-${status().severity ?? "none"}`}
          title={text.vehicles.doingHint(doing(vehicle(), part(), behindS()))}
        >
          {doing(vehicle(), part(), behindS())}
          <Show when={vehicle().conflict_link_ids.length > 0}>
            {" "}
            · {text.vehicles.serialConflict}
          </Show>
          <Operator vehicle={vehicle()} />
        </span>
        <Show when={isStale()}>
          <span class="hidden-but-read">
            {text.vehicles.telemetryAge(formatAge(agedBy(vehicle().telemetry_age_s, behindS())))}
          </span>
        </Show>
      </button>
    </li>
  );
}

function Battery(props: { vehicle: VehicleView }) {
  const fraction = () => props.vehicle.battery_fraction.value;
  return (
    <span
      class="vehicle-battery"
      classList={{ "is-low": hasBatteryWarning(props.vehicle) }}
      title={text.vehicles.battery}
    >
      <LinkBars linkId={props.vehicle.link_id} />
      {formatFraction(fraction())}
      <span class="vehicle-meter" aria-hidden="true">
        <span style={{ width: `${Math.round(100 * (fraction() ?? 0))}%` }} />
      </span>
    </span>
  );
}

/** Another person who operates it: orders to move it are refused. */
function Operator(props: { vehicle: VehicleView }) {
  const { source } = useStation();
  return (
    <Show when={anothersLease(props.vehicle.lease, source.person())}>
      {(lease) => (
        <span class="vehicle-operator" title={text.vehicles.operatedBy(lease().person)}>
          {" "}
          · {lease().person}
        </span>
      )}
    </Show>
  );
}
