import { createEffect, Match, Show, Switch } from "solid-js";
import { useStation } from "../../console";
import type { HoldTimer } from "../../orders/holdToConfirm";
import type { OrderKind } from "../../orders/targets";
import { text } from "../../text/catalogue";
import { listNames } from "../../text/names";
import { buttonName, holdHandlers, holdHint } from "../guard/GuardButton";

/** An order button that acts when held, by pointer or keyboard, until its bar is full. */
export function OrderButton(props: {
  order: OrderKind;
  timer: HoldTimer;
  labels: readonly string[];
}) {
  const { lacks } = useStation();
  const lack = () => lacks("pilot");
  const label = () => text.orders.labels[props.order.kind];
  const isDisabled = () => props.labels.length === 0 || lack() !== null;
  const hint = () => {
    if (lack() !== null) return text.guard.needs(text.roles.pilot);
    return holdHint(props.order.hold_ms);
  };
  const recipients = () =>
    props.labels.length === 0 ? text.orders.selectFirst : listNames(props.labels);
  createEffect(() => {
    if (isDisabled()) props.timer.cancel();
  });
  return (
    <button
      type="button"
      class={`button order order-${props.order.kind}`}
      classList={{ "is-holding": props.timer.kind() === "holding" }}
      aria-disabled={isDisabled()}
      aria-label={buttonName(label(), hint(), recipients())}
      title={lack() ?? text.orders.notes[props.order.kind]}
      aria-description={lack() ?? text.orders.notes[props.order.kind]}
      aria-keyshortcuts={`Shift+${props.order.key}`}
      style={{ "--held": props.timer.progress() }}
      {...handlers(props.order, props.timer, isDisabled)}
    >
      <OrderIcon kind={props.order.kind} />
      <span class="order-text">
        {label()} <Show when={hint()}>{(how) => <small>{how()}</small>}</Show>
      </span>
    </button>
  );
}

/** One press is a click, so that a finger that slides off gives no order. */
function handlers(order: OrderKind, timer: HoldTimer, isDisabled: () => boolean) {
  if (order.hold_ms > 0) return holdHandlers(timer, isDisabled);
  const press = () => {
    if (isDisabled()) return;
    timer.press();
    timer.release();
  };
  return { onClick: press };
}

/** An icon for each order, so that orders differ by more than colour and position. */
export function OrderIcon(props: { kind: OrderKind["kind"] }) {
  return (
    <svg class="order-icon" viewBox="0 0 24 24" width="20" height="20" aria-hidden="true">
      <Switch>
        <Match when={props.kind === "hover"}>
          <path d="M8 4v16M16 4v16" />
        </Match>
        <Match when={props.kind === "return_home"}>
          <path d="M3 12 12 4l9 8M6 10v10h12V10" />
        </Match>
        <Match when={props.kind === "land"}>
          <path d="M12 3v12M6.5 10 12 15.5 17.5 10M4 21h16" />
        </Match>
      </Switch>
    </svg>
  );
}
