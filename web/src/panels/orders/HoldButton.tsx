import { createEffect, Show } from "solid-js";
import type { HoldTimer } from "../../orders/holdTimer";
import type { OrderKind } from "../../orders/kinds";
import { listNames } from "../../words/names";
import { holdHandlers } from "../guard/holdHandlers";
import { OrderIcon } from "./OrderIcon";

/** A button that acts only when it is held, by pointer or keyboard, until its bar is full. */
export function HoldButton(props: {
  order: OrderKind;
  timer: HoldTimer;
  labels: readonly string[];
}) {
  const isDisabled = () => props.labels.length === 0;
  createEffect(() => {
    if (isDisabled()) props.timer.cancel();
  });
  return (
    <button
      type="button"
      class={`order order-${props.order.kind}`}
      classList={{ "is-holding": props.timer.kind() === "holding" }}
      aria-disabled={isDisabled()}
      aria-label={accessibleName(props.order, props.labels)}
      title={props.order.note}
      aria-description={props.order.note}
      aria-keyshortcuts={`Shift+${props.order.key}`}
      style={{ "--held": props.timer.progress() }}
      {...holdHandlers(props.timer, isDisabled)}
    >
      <OrderIcon kind={props.order.kind} />
      <span class="order-text">
        <strong>{props.order.label}</strong>
        <Show when={props.order.hold_ms >= 1000} fallback={<small>hold briefly</small>}>
          <small>hold {props.order.hold_ms / 1000} s</small>
        </Show>
      </span>
    </button>
  );
}

function accessibleName(order: OrderKind, labels: readonly string[]): string {
  if (labels.length === 0) return `${order.label}: select vehicles first`;
  return `${order.label} ${listNames(labels)}: hold for ${order.hold_ms / 1000} seconds`;
}
