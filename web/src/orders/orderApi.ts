import { type Accessor, createSignal } from "solid-js";
import type { NamedOrder, OrderResult, Outcome } from "../protocol";
import type { Clock } from "../source/clock";
import type { OrderRequests } from "../source/orderRequests";
import { text } from "../text/catalogue";
import { commandName } from "../text/names";

/** The last order sent and the station's answer. */
export interface OrderAnswer {
  readonly order: string;
  /** Labels of the vehicles addressed. */
  readonly labels: readonly string[];
  readonly outcome: Outcome<readonly OrderResult[]> | { readonly kind: "waiting" };
}

/** Sends orders through the source and keeps the last answer for display. */
export interface OrderApi {
  readonly lastAnswer: Accessor<OrderAnswer | null>;
  /** Sends an order; returns whether the station has accepted it for all its vehicles. */
  order(order: NamedOrder, labels: readonly string[]): Promise<boolean>;
  /** Sends takeoffs, one for each vehicle, and keeps their results as one answer. */
  takeOff(orders: readonly NamedOrder[], labels: readonly string[]): Promise<boolean>;
  allStop(): Promise<boolean>;
  /** Starts a return in layers; null means every vehicle in reach. */
  fleetReturn(serials: readonly string[] | null, labels: readonly string[]): Promise<boolean>;
  dismiss(): void;
}

/** An answer without refusals disappears after this time; the command list keeps the result. */
export const ACCEPTED_SHOWN_MS = 10_000;

type Orders = Pick<OrderRequests, "send" | "allStop" | "fleetReturn">;

export function createOrderApi(orders: Orders, clock: Clock): OrderApi {
  const [lastAnswer, setLastAnswer] = createSignal<OrderAnswer | null>(null);
  let newest = 0;

  async function run(
    order: string,
    labels: readonly string[],
    send: () => Promise<Outcome<readonly OrderResult[]>>,
  ): Promise<boolean> {
    newest += 1;
    const ownNumber = newest;
    setLastAnswer({ order, labels, outcome: { kind: "waiting" } });
    const outcome = await send();
    const isAccepted = isAllAccepted(outcome);
    // A late answer must not replace the answer to a newer order.
    if (ownNumber !== newest) return isAccepted;
    setLastAnswer({ order, labels, outcome });
    if (isAccepted) {
      clock.after(ACCEPTED_SHOWN_MS, () => {
        if (ownNumber === newest) setLastAnswer(null);
      });
    }
    return isAccepted;
  }

  return {
    lastAnswer,
    order: async (order, labels) => {
      if (order.serials.length === 0) return false;
      return run(commandName(order.order.kind), labels, () => orders.send(order));
    },
    takeOff: (takeoffs, labels) =>
      run(text.orders.takeOff, labels, async () =>
        joined(await Promise.all(takeoffs.map((one) => orders.send(one)))),
      ),
    allStop: () => run(text.orders.allStop, [text.orders.allFlying], () => orders.allStop()),
    fleetReturn: (serials, labels) =>
      run(text.orders.fleetReturn, labels, () => orders.fleetReturn(serials)),
    dismiss: () => setLastAnswer(null),
  };
}

/** The results of all; a request without an answer is what is told. */
function joined(
  outcomes: readonly Outcome<readonly OrderResult[]>[],
): Outcome<readonly OrderResult[]> {
  const failed = outcomes.find(({ kind }) => kind === "failed");
  if (failed !== undefined) return failed;
  const value = outcomes.flatMap((each) => (each.kind === "answered" ? each.value : []));
  return { kind: "answered", value };
}

function isAllAccepted(outcome: Outcome<readonly OrderResult[]>): boolean {
  return outcome.kind === "answered" && outcome.value.every((result) => result.accepted);
}
