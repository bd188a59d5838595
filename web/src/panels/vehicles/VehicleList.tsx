import { For, Show } from "solid-js";
import { useConsole } from "../../console";
import { vehicleKey } from "../../fleet/vehicleStatus";
import { Empty, Panel } from "../Panel";
import { VehicleRow } from "./VehicleRow";
import "./vehicles.css";

/** Every vehicle that ever connected, in the order of their numbers. */
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
          {isAll() ? "Select none" : "Select all"}
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
      No companion app has connected.
      <Show when={addresses().length > 0}>
        {" "}
        The station listens on <span class="wire-text">{addresses().join(", ")}</span>.
      </Show>
    </Empty>
  );
}
