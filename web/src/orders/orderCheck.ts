import { type Accessor, createEffect, createMemo, createSignal, onCleanup } from "solid-js";
import type { NamedOrder, OrderResult, Outcome } from "../protocol";
import type { Clock } from "../source/clock";
import type { OrderRequests } from "../source/orderRequests";
import { text } from "../text/catalogue";
import { refusalText } from "../text/names";

/** The safety gate's result for an order that has not been sent. */
export type OrderCheck =
  | { readonly kind: "none" }
  | { readonly kind: "pending" }
  | { readonly kind: "allowed" }
  | { readonly kind: "refused"; readonly text: string };

/** Wait this long after the last change: numbers are typed digit by digit. */
const DEBOUNCE_MS = 250;
/** Repeat interval: vehicles move and batteries drain, so a result ages. */
const REPEAT_MS = 1000;

/** Checks an order with the safety gate when it changes and then once a second; null stops checking. */
export function createOrderCheck(
  orders: Pick<OrderRequests, "check">,
  clock: Clock,
  order: Accessor<NamedOrder | null>,
): Accessor<OrderCheck> {
  const [check, setJudgement] = createSignal<OrderCheck>({ kind: "none" });
  const serialized = createMemo(() => (order() === null ? "" : JSON.stringify(order())));
  createEffect(() => {
    const current = serialized();
    setJudgement({ kind: current === "" ? "none" : "pending" });
    if (current === "") return;
    const order = JSON.parse(current) as NamedOrder;
    let isCancelled = false;
    let cancel = clock.after(DEBOUNCE_MS, () => void send());
    const send = async () => {
      const outcome = await orders.check(order);
      if (isCancelled) return;
      setJudgement(checkOf(outcome));
      cancel = clock.after(REPEAT_MS, () => void send());
    };
    onCleanup(() => {
      isCancelled = true;
      cancel();
    });
  });
  return check;
}

function checkOf(outcome: Outcome<readonly OrderResult[]>): OrderCheck {
  if (outcome.kind === "failed") return { kind: "refused", text: outcome.problem };
  const refused = outcome.value.find((result) => !result.accepted);
  if (refused !== undefined) {
    return { kind: "refused", text: refusalText(refused.reason) };
  }
  if (outcome.value.length > 0) return { kind: "allowed" };
  return { kind: "refused", text: text.orders.noCheck };
}
