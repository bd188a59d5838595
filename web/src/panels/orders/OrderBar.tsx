import { createMemo, For, Match, onCleanup, onMount, Show, Switch } from "solid-js";
import { useMapModes, useOrders, usePage, useStation } from "../../console";
import { selectedVehicles } from "../../fleet/selection";
import { createHoldTimer, type HoldTimer } from "../../orders/holdToConfirm";
import { TAKEOFF_HEIGHT_M, takeoffOrder } from "../../orders/takeOff";
import { ORDER_KINDS, type OrderKind, targetsKey } from "../../orders/targets";
import { text } from "../../text/catalogue";
import { listSome, vehicleLabel } from "../../text/names";
import { formatLength } from "../../text/units";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { OrderButton } from "./OrderButton";
import { holdByKey } from "./shortcuts";
import "./orders.css";

interface HeldOrder {
  readonly order: OrderKind;
  readonly timer: HoldTimer;
}

/** Hover, return and land for the selected vehicles, with their names shown before and during a hold. */
export function OrderBar() {
  const { clock } = useStation();
  const { targets, orderApi } = useOrders();
  const { flyHere, missionDraft } = useMapModes();
  const { panels } = usePage();
  const held: HeldOrder[] = ORDER_KINDS.map((order) => ({
    order,
    timer: createHoldTimer(
      clock,
      order.hold_ms,
      () => targetsKey(targets()),
      () => {
        const { serials, labels } = targets();
        void orderApi.order({ serials, order: { kind: order.kind } }, labels);
      },
    ),
  }));
  const holding = () => held.find(({ timer }) => timer.kind() === "holding")?.order ?? null;
  onMount(() => {
    const stop = holdByKey(
      window,
      held.map(({ order, timer }) => ({ key: order.key, timer })),
    );
    onCleanup(stop);
  });
  const hasTargets = () => targets().labels.length + targets().unreachable.length > 0;
  return (
    <section
      class="card orders"
      classList={{ "is-idle": !hasTargets() }}
      aria-label={text.orders.name}
    >
      <p class="orders-to wire-text" aria-live="polite">
        <Recipients holding={holding()} />
      </p>
      <div class="orders-buttons">
        <For each={held}>
          {({ order, timer }) => (
            <OrderButton order={order} timer={timer} labels={targets().labels} />
          )}
        </For>
        <Show when={!missionDraft.isOn()}>
          <TakeOff />
        </Show>
        <button
          type="button"
          class="button orders-goto"
          aria-pressed={flyHere.isOn()}
          disabled={flyHere.vehicle() === null}
          aria-label={text.orders.flyHere}
          title={flyHere.vehicle() === null ? text.orders.flyHereOff : text.orders.flyHereHint}
          onClick={() => flyHere.toggle()}
        >
          {text.orders.flyHere}
        </button>
        <button
          type="button"
          class="button button-quiet orders-mission"
          aria-pressed={missionDraft.isOn()}
          aria-disabled={missionDraft.lack() !== null}
          title={missionDraft.lack() ?? text.mission.hint}
          aria-description={missionDraft.lack() ?? text.mission.hint}
          onClick={() => missionDraft.toggle()}
        >
          {text.mission.button}
        </button>
        <button
          type="button"
          class="button button-quiet orders-details"
          aria-expanded={panels.isOpen("vehicle")}
          title={text.orders.detailsHint}
          onClick={() => panels.toggle("vehicle")}
        >
          {text.orders.details}
        </button>
      </div>
    </section>
  );
}

/** For the selected vehicles that stand on the ground; the button is there only for those. */
function TakeOff() {
  const { fleet } = useStation();
  const { selection, orderApi } = useOrders();
  const standing = createMemo(() =>
    selectedVehicles(fleet.vehicles, selection).flatMap((vehicle) => {
      const order = takeoffOrder(vehicle);
      return order === null ? [] : [{ order, label: vehicleLabel(vehicle) }];
    }),
  );
  const labels = () => standing().map(({ label }) => label);
  return (
    <Show when={standing().length > 0}>
      <div class="orders-takeoff">
        <GuardButton
          label={text.orders.takeOffTo(formatLength(TAKEOFF_HEIGHT_M))}
          of={listSome(labels(), NAMES_SHOWN)}
          needs="pilot"
          hold_ms={GUARD_MS}
          subject={JSON.stringify(labels())}
          onConfirm={() =>
            void orderApi.takeOff(
              standing().map(({ order }) => order),
              labels(),
            )
          }
        />
      </div>
    </Show>
  );
}

/** So many names are read at a glance. */
const NAMES_SHOWN = 3;

function Recipients(props: { holding: OrderKind | null }) {
  const { targets } = useOrders();
  const names = () => listSome(targets().labels, NAMES_SHOWN);
  return (
    <>
      <Switch fallback={text.orders.none}>
        <Match when={targets().labels.length > 0 ? props.holding : null}>
          {(holding) =>
            text.orders.keepHolding(
              <strong>{text.orders.verbs[holding().kind]}</strong>,
              <strong>{names()}</strong>,
            )
          }
        </Match>
        <Match when={targets().labels.length > 0}>
          {text.orders.selected(<strong>{names()}</strong>)}
        </Match>
      </Switch>
      <Show when={targets().unreachable.length > 0}>
        <span class="tone-warning">
          {" "}
          {text.orders.notSentTo(listSome(targets().unreachable, NAMES_SHOWN))}
        </span>
      </Show>
    </>
  );
}
