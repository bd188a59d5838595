import { createMemo, createSignal, For, Show } from "solid-js";
import { useOrders, useStation } from "../../console";
import {
  createListChoice,
  firstFound,
  isSameList,
  type ListChoice,
  listVehicles,
} from "../../fleet/vehicleOrder";
import { vehicleKey } from "../../fleet/vehicleStatus";
import { text } from "../../text/catalogue";
import { AppAddress } from "../links/AppAddress";
import { Empty, Panel } from "../Panel";
import { VehicleRow } from "./VehicleRow";
import "./vehicles.css";

/** From so many vehicles on, the list begins with its search. */
const MANY = 9;

/** All vehicles that have connected; they can be searched, sorted, filtered and grouped. */
export function VehicleList() {
  const { fleet, behindS } = useStation();
  const { selection } = useOrders();
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
  // By title: a new order moves rows, and replaces none.
  const titles = createMemo(() => groups().map(({ title }) => title), [], { equals: isSameText });
  const membersOf = (title: string) =>
    groups().find((group) => group.title === title)?.vehicles ?? [];
  const shown = () => groups().flatMap(({ vehicles }) => vehicles.map(vehicleKey));
  const isAll = () => shown().length > 0 && shown().every(selection.has);
  return (
    <Panel
      title={text.page.vehicles}
      class="vehicles"
      count={fleet.vehicles.length}
      actions={
        <>
          <button
            type="button"
            class="button button-quiet"
            aria-expanded={hasTools()}
            aria-label={text.vehicles.tools}
            title={text.vehicles.tools}
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
            {isAll() ? text.vehicles.none : text.vehicles.all}
          </button>
          <button
            type="button"
            class="button button-quiet"
            aria-expanded={!isFolded()}
            aria-label={isFolded() ? text.vehicles.show : text.vehicles.fold}
            onClick={() => setFolded(!isFolded())}
          >
            {isFolded() ? "▾" : "▴"}
          </button>
        </>
      }
    >
      <Show when={!isFolded()}>
        <Show when={hasTools()}>
          <Tools
            choice={choice()}
            onChoose={choose}
            onEnter={() => {
              const vehicle = firstFound(groups(), choice().search);
              if (vehicle !== null) selection.only(vehicleKey(vehicle));
            }}
          />
        </Show>
        <Show when={fleet.vehicles.length > 0} fallback={<NoVehicles />}>
          <div class="vehicle-scroll">
            <For each={titles()} fallback={<p class="panel-empty">{text.vehicles.noneMatches}</p>}>
              {(title) => (
                <section aria-label={title || text.page.vehicles}>
                  <Show when={title}>
                    <h3 class="vehicle-group">
                      {title} {membersOf(title).length}
                    </h3>
                  </Show>
                  <ul>
                    <For each={membersOf(title)}>
                      {(vehicle) => <VehicleRow vehicle={vehicle} />}
                    </For>
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

function isSameText(a: readonly string[], b: readonly string[]): boolean {
  return a.length === b.length && a.every((one, index) => one === b[index]);
}

function Tools(props: {
  choice: ListChoice;
  onChoose: (next: Partial<ListChoice>) => void;
  onEnter: () => void;
}) {
  return (
    <div class="vehicle-tools">
      <input
        class="field vehicle-search"
        type="search"
        aria-label={text.vehicles.searchName}
        placeholder={text.vehicles.search}
        value={props.choice.search}
        onInput={(event) => props.onChoose({ search: event.currentTarget.value })}
        onKeyDown={(event) => event.key === "Enter" && props.onEnter()}
      />
      <Choice
        label={text.vehicles.filter}
        names={text.vehicles.filters}
        value={props.choice.filter}
        onChoose={(filter) => props.onChoose({ filter })}
      />
      <Choice
        label={text.vehicles.sort}
        names={text.vehicles.sorts}
        value={props.choice.sort}
        onChoose={(sort) => props.onChoose({ sort })}
      />
      <Choice
        label={text.vehicles.group}
        names={text.vehicles.groups}
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
        {([value, name]) => <option value={value}>{name}</option>}
      </For>
    </select>
  );
}

function NoVehicles() {
  const { fleet } = useStation();
  // Beyond loopback the section below has the address.
  const addresses = () => (fleet.station?.app_url ? [] : (fleet.station?.link_addresses ?? []));
  return (
    <>
      <Empty>
        {text.vehicles.noApp}
        <Show when={addresses().length > 0}>
          {" "}
          {text.vehicles.appAddress} <span class="wire-text">{addresses().join(", ")}</span>
        </Show>
      </Empty>
      <AppAddress />
    </>
  );
}
