import { createMemo, Show } from "solid-js";
import { useConsole } from "../../console";
import { anothersLease } from "../../fleet/operatorLease";
import { hasBatteryWarning } from "../../fleet/readiness";
import { badgeText, stalenessNow, vehicleKey, vehicleStatus } from "../../fleet/vehicleStatus";
import type { VehicleView } from "../../protocol";
import { vehicleLabel } from "../../text/names";
import {
  agedBy,
  formatAge,
  formatFraction,
  formatQuantity,
  groundSpeedMps,
} from "../../text/quantities";
import { colourOf } from "../../theme/theme";
import { SeverityMark } from "../SeverityMark";

/** One vehicle: a checkbox that adds it to the selection, and a body that selects only it. */
export function VehicleRow(props: { vehicle: VehicleView }) {
  const { selection, source, behindS } = useConsole();
  const vehicle = () => props.vehicle;
  const key = () => vehicleKey(vehicle());
  const status = createMemo(() => vehicleStatus(vehicle(), behindS()));
  const isStale = () => stalenessNow(vehicle(), behindS()) !== "live";
  const isSelected = () => selection.has(key());
  return (
    <li
      class="row vehicle own-colour"
      classList={{ "is-stale": isStale(), "is-selected": isSelected() }}
      style={{ "--own": colourOf(key()) }}
    >
      <label class="vehicle-box">
        <input
          type="checkbox"
          checked={isSelected()}
          aria-label={`Add ${vehicleLabel(vehicle())} to the selection`}
          onChange={() => selection.toggle(key())}
        />
      </label>
      <button
        type="button"
        class="vehicle-body"
        aria-pressed={isSelected()}
        onClick={() => selection.only(key())}
      >
        <span class="row-line">
          <span class="badge">{badgeText(vehicle())}</span>
          <strong class="vehicle-name">{vehicle().name}</strong>
          <Show when={vehicle().is_simulated}>
            <span class="tag tag-simulated">SIM</span>
          </Show>
          <Show when={vehicle().is_imager}>
            <span class="tag vehicle-imager" title="Imaging drone">
              IMAGER
            </span>
          </Show>
          <Show when={vehicle().is_stopped}>
            <span class="tag tag-stopped" title="Held by an all stop">
              STOPPED
            </span>
          </Show>
          <Show when={anothersLease(vehicle().lease, source.person())}>
            {(lease) => (
              <span class="tag vehicle-operator" title={`Operated by ${lease().person}`}>
                {lease().person}
              </span>
            )}
          </Show>
          <span class={`severity push tone-${status().severity ?? "good"}`}>
            <Show when={status().severity}>
              {(severity) => <SeverityMark severity={severity()} />}
            </Show>
            {status().activity}
          </span>
        </span>
        <span class="row-line vehicle-figures">
          <Figures vehicle={vehicle()} />
          <span class="push vehicle-age" title="Telemetry age">
            {formatAge(agedBy(vehicle().telemetry_age_s, behindS()))}
          </span>
        </span>
      </button>
    </li>
  );
}

function Figures(props: { vehicle: VehicleView }) {
  const speed = () => {
    const { north_mps, east_mps } = props.vehicle.velocity_ned;
    return groundSpeedMps(north_mps, east_mps);
  };
  return (
    <>
      <span title="Height above takeoff">
        ↥ {formatQuantity(props.vehicle.height_above_takeoff_m.value, "m", 0)}
      </span>
      <span title="Speed over ground">{formatQuantity(speed(), "m/s", 1)}</span>
      <span title="Battery" classList={{ "vehicle-battery-low": hasBatteryWarning(props.vehicle) }}>
        ▮ {formatFraction(props.vehicle.battery_fraction.value)}
      </span>
    </>
  );
}
