import { For, Show } from "solid-js";
import { useConsole } from "../../console";
import { vehicleKey } from "../../fleet/vehicleStatus";
import { Empty, Panel } from "../Panel";
import { VehicleRow } from "./VehicleRow";
import "./vehicles.css";

/** All vehicles that have connected, by number. */
export function VehicleList() {
  const { fleet, selection } = useConsole();
  const all = () => fleet.vehicles.map(vehicleKey);
  const isAll = () => all().length > 0 && all().length === selection.keys().length;
  return (
    <Panel
      title="Vehicles"
      count={fleet.vehicles.length}
      actions={
        <button
          type="button"
          class="button"
          disabled={fleet.vehicles.length === 0}
          onClick={() => (isAll() ? selection.clear() : selection.all(all()))}
        >
          {isAll() ? "Clear selection" : "Select all"}
        </button>
      }
    >
      <Show when={fleet.vehicles.length > 0} fallback={<NoVehicles />}>
        <ul>
          <For each={fleet.vehicles}>{(vehicle) => <VehicleRow vehicle={vehicle} />}</For>
        </ul>
      </Show>
    </Panel>
  );
}

function NoVehicles() {
  const { fleet } = useConsole();
  const addresses = () => fleet.station?.link_addresses ?? [];
  return (
    <Empty>
      No companion app connected.
      <Show when={addresses().length > 0}>
        {" "}
        App address: <span class="wire-text">{addresses().join(", ")}</span>
      </Show>
    </Empty>
  );
}
