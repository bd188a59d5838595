import { Match, Switch } from "solid-js";
import type { OrderCheck } from "../../orders/orderCheck";
import { text } from "../../text/catalogue";
import { SeverityMark } from "../SeverityMark";

/** The safety gate's result before an order is confirmed, or what the order still lacks. */
export function CheckResult(props: { check: OrderCheck; lack: string | null }) {
  const refusal = () => (props.check.kind === "refused" ? props.check.text : null);
  return (
    <div class="fly-check wire-text" role="status">
      <Switch>
        <Match when={refusal()}>
          {(why) => (
            <p class="check">
              <span class="tone-error">
                <SeverityMark severity="error" />
              </span>
              <span>{why()}</span>
            </p>
          )}
        </Match>
        <Match when={props.check.kind === "allowed"}>
          <p class="check">
            <span class="tone-good">
              <SeverityMark severity={null} />
            </span>
            <span>{text.fly.allowed}</span>
          </p>
        </Match>
        <Match when={props.check.kind === "pending"}>
          <p class="muted">{text.fly.checking}</p>
        </Match>
        <Match when={props.lack}>{(lack) => <p class="muted">{lack()}</p>}</Match>
      </Switch>
    </div>
  );
}
