import { For, Match, onCleanup, onMount, Show, Switch } from "solid-js";
import { useConsole } from "../../console";
import { createHoldTimer, type HoldTimer } from "../../orders/holdToConfirm";
import { ORDER_KINDS, type OrderKind, targetsKey } from "../../orders/targets";
import { listNames } from "../../text/names";
import { LastAnswer } from "./OrderAnswer";
import { HoldButton } from "./OrderButton";
import { holdByKey } from "./shortcuts";
import "./orders.css";

interface HeldOrder {
  readonly order: OrderKind;
  readonly timer: HoldTimer;
}

/** Hover, return and land for the selected vehicles, which are named before and while one holds. */
export function OrderBar() {
  const { targets, desk, clock } = useConsole();
  const held: HeldOrder[] = ORDER_KINDS.map((order) => ({
    order,
    timer: createHoldTimer(
      clock,
      order.hold_ms,
      () => targetsKey(targets()),
      () => {
        const { serials, labels } = targets();
        void desk.order({ serials, order: { kind: order.kind } }, labels);
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
  return (
    <section class="orders" aria-label="Orders to the selected vehicles">
      <LastAnswer />
      <p class="orders-to wire-text" aria-live="polite">
        <ToWhom holding={holding()} />
      </p>
      <div class="orders-buttons">
        <For each={held}>
          {({ order, timer }) => (
            <HoldButton order={order} timer={timer} labels={targets().labels} />
          )}
        </For>
      </div>
      <p class="muted orders-note">
        Return home first climbs to the aircraft's own go-home height.
      </p>
    </section>
  );
}

function ToWhom(props: { holding: OrderKind | null }) {
  const { targets } = useConsole();
  const names = () => listNames(targets().labels);
  return (
    <>
      <Switch fallback={<>Select one or more vehicles to give them an order.</>}>
        <Match when={props.holding !== null && targets().labels.length > 0}>
          Keep holding to <strong>{props.holding?.verb}</strong>: <strong>{names()}</strong>
        </Match>
        <Match when={targets().labels.length > 0}>
          Orders go to <strong>{names()}</strong>
        </Match>
      </Switch>
      <Show when={targets().unreachable.length > 0}>
        <span class="tone-warning">
          {" "}
          Not to {listNames(targets().unreachable)}: unidentified, only ALL STOP reaches it.
        </span>
      </Show>
    </>
  );
}
