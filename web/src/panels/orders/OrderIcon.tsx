import { Match, Switch } from "solid-js";
import type { OrderKind } from "../../orders/kinds";

/** A sign for each order, so that none is told by its colour or place alone. */
export function OrderIcon(props: { kind: OrderKind["kind"] }) {
  return (
    <svg class="order-icon" viewBox="0 0 24 24" width="28" height="28" aria-hidden="true">
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
