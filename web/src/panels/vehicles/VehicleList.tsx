import { createMemo, createSignal, For, Show } from "solid-js";
import { useConsole } from "../../console";
import {
  createListChoice,
  FILTERS,
  GROUPS,
  isSameList,
  type ListChoice,
  listVehicles,
  SORTS,
} from "../../fleet/vehicleOrder";
import { vehicleKey } from "../../fleet/vehicleStatus";
import { AppAddress } from "../links/AppAddress";
import { Empty, Panel } from "../Panel";
import { VehicleRow } from "./VehicleRow";
import "./vehicles.css";

/** From so many vehicles on, the list begins with its search. */
const MANY = 9;

/** All vehicles that have connected; they can be searched, sorted, filtered and grouped. */
export function VehicleList() {
  const { fleet, selection, behindS } = useConsole();
  const [choice, choose] = createListChoice();
  const [tools, setTools] = createSignal<boolean | null>(null);
  const [isFolded, setFolded] = createSignal(false);
  const hasTools = () => tools() ?? fleet.vehicles.length >= MANY;
  // Equal lists are one list: rows are replaced only when their order changes, and not while pressed.
  const groups = createMemo(
    () => listVehicles(fleet.vehicles, choice(), selection.has, behindS()),
    [],
    { equals: isSameList },
  );
  const shown = () => groups().flatMap(({ vehicles }) => vehicles.map(vehicleKey));
  const isAll = () => shown().length > 0 && shown().every(selection.has);
  return (
    <Panel
      title="Vehicles"
      class="vehicles"
      count={fleet.vehicles.length}
      actions={
        <>
          <button
            type="button"
            class="button button-quiet"
            aria-expanded={hasTools()}
            aria-label="Search, sort and filter"
            title="Search, sort and filter"
            onClick={() => setTools(!hasTools())}
          >
            ⌕
          </button>
          <button
            type="button"
            class="button button-quiet"
            disabled={fleet.vehicles.length === 0}
            onClick={() => (isAll() ? selection.clear() : selection.all(shown()))}
          >
            {isAll() ? "None" : "All"}
          </button>
          <button
            type="button"
            class="button button-quiet"
            aria-expanded={!isFolded()}
            aria-label={isFolded() ? "Show the vehicles" : "Fold the vehicles away"}
            onClick={() => setFolded(!isFolded())}
          >
            {isFolded() ? "▾" : "▴"}
          </button>
        </>
      }
    >
      <Show when={!isFolded()}>
        <Show when={hasTools()}>
          <Tools choice={choice()} onChoose={choose} />
        </Show>
        <Show when={fleet.vehicles.length > 0} fallback={<NoVehicles />}>
          <div class="vehicle-scroll">
            <For each={groups()} fallback={<p class="panel-empty">None matches.</p>}>
              {(group) => (
                <section aria-label={group.title || "Vehicles"}>
                  <Show when={group.title}>
                    {(title) => (
                      <h3 class="vehicle-group">
                        {title()} {group.vehicles.length}
                      </h3>
                    )}
                  </Show>
                  <ul>
                    <For each={group.vehicles}>{(vehicle) => <VehicleRow vehicle={vehicle} />}</For>
                  </ul>
                </section>
              )}
            </For>
          </div>
        </Show>
      </Show>
    </Panel>
  );
}

function Tools(props: { choice: ListChoice; onChoose: (next: Partial<ListChoice>) => void }) {
  return (
    <div class="vehicle-tools">
      <input
        class="field vehicle-search"
        type="search"
        aria-label="Search by number, name or serial"
        placeholder="Search"
        value={props.choice.search}
        onInput={(event) => props.onChoose({ search: event.currentTarget.value })}
      />
      <Choice
        label="Show"
        names={FILTERS}
        value={props.choice.filter}
        onChoose={(filter) => props.onChoose({ filter })}
      />
      <Choice
        label="Sort by"
        names={SORTS}
        value={props.choice.sort}
        onChoose={(sort) => props.onChoose({ sort })}
      />
      <Choice
        label="Group by"
        names={GROUPS}
        value={props.choice.group}
        onChoose={(group) => props.onChoose({ group })}
      />
    </div>
  );
}

function Choice<T extends string>(props: {
  label: string;
  names: Readonly<Record<T, string>>;
  value: T;
  onChoose: (value: T) => void;
}) {
  return (
    <select
      class="field"
      aria-label={props.label}
      title={props.label}
      value={props.value}
      onChange={(event) => props.onChoose(event.currentTarget.value as T)}
    >
      <For each={Object.entries<string>(props.names)}>
        {([name, text]) => <option value={name}>{text}</option>}
      </For>
    </select>
  );
}

function NoVehicles() {
  const { fleet } = useConsole();
  // Beyond loopback the section below has the address.
  const addresses = () => (fleet.station?.app_url ? [] : (fleet.station?.link_addresses ?? []));
  return (
    <>
      <Empty>
        No companion app connected.
        <Show when={addresses().length > 0}>
          {" "}
          App address: <span class="wire-text">{addresses().join(", ")}</span>
        </Show>
      </Empty>
      <AppAddress />
    </>
  );
}
