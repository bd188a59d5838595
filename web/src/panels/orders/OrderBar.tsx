import { For, Match, onCleanup, onMount, Show, Switch } from "solid-js";
import { useConsole } from "../../console";
import { createHoldTimer, type HoldTimer } from "../../orders/holdToConfirm";
import { ORDER_KINDS, type OrderKind, targetsKey } from "../../orders/targets";
import { listNames } from "../../text/names";
import { AnswerNotice } from "./AnswerNotice";
import { OrderButton } from "./OrderButton";
import { holdByKey } from "./shortcuts";
import "./orders.css";

interface HeldOrder {
  readonly order: OrderKind;
  readonly timer: HoldTimer;
}

/** Hover, return and land for the selected vehicles, with their names shown before and during a hold. */
export function OrderBar() {
  const { targets, orderApi, clock } = useConsole();
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
  return (
    <section class="orders" aria-label="Orders to the selected vehicles">
      <AnswerNotice />
      <p class="orders-to wire-text" aria-live="polite">
        <Recipients holding={holding()} />
      </p>
      <div class="orders-buttons">
        <For each={held}>
          {({ order, timer }) => (
            <OrderButton order={order} timer={timer} labels={targets().labels} />
          )}
        </For>
      </div>
      <p class="muted orders-note">Return home climbs to the aircraft's go-home height first.</p>
    </section>
  );
}

function Recipients(props: { holding: OrderKind | null }) {
  const { targets } = useConsole();
  const names = () => listNames(targets().labels);
  return (
    <>
      <Switch fallback={<>Select one or more vehicles to command.</>}>
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
          Not sent to {listNames(targets().unreachable)}: unidentified, ALL STOP only.
        </span>
      </Show>
    </>
  );
}
