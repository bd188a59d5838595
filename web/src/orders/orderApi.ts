import { type Accessor, createSignal } from "solid-js";
import type { OrderResult } from "../protocol";
import type { Clock } from "../source/clock";
import type { NamedOrder, Outcome, StationSource } from "../source/stationSource";
import { commandName } from "../text/names";

/** What was asked last and what the station said to it. */
export interface Answer {
  readonly what: string;
  /** The vehicles named; `all` for all stop. */
  readonly labels: readonly string[];
  readonly outcome: Outcome<readonly OrderResult[]> | { readonly kind: "waiting" };
}

/** Gives orders through the source and keeps the last answer for the screen. */
export interface Desk {
  readonly last: Accessor<Answer | null>;
  order(order: NamedOrder, labels: readonly string[]): Promise<void>;
  allStop(): Promise<void>;
  /** Calls vehicles home in layers; null: every one in reach. */
  fleetReturn(serials: readonly string[] | null, labels: readonly string[]): Promise<void>;
  dismiss(): void;
}

/** An answer without a refusal goes by itself after this; the commands' list tells on. */
export const ALL_WELL_FOR_MS = 10_000;

type Asks = Pick<StationSource, "order" | "allStop" | "fleetReturn">;

export function createDesk(source: Asks, clock: Clock): Desk {
  const [last, setLast] = createSignal<Answer | null>(null);
  let newest = 0;

  async function run(
    what: string,
    labels: readonly string[],
    ask: () => Promise<Outcome<readonly OrderResult[]>>,
  ): Promise<void> {
    newest += 1;
    const own = newest;
    setLast({ what, labels, outcome: { kind: "waiting" } });
    const outcome = await ask();
    // A slow answer must not stand under a newer order.
    if (own !== newest) return;
    setLast({ what, labels, outcome });
    if (isAllWell(outcome)) {
      clock.after(ALL_WELL_FOR_MS, () => {
        if (own === newest) setLast(null);
      });
    }
  }

  return {
    last,
    order: async (order, labels) => {
      if (order.serials.length === 0) return;
      await run(commandName(order.order.kind), labels, () => source.order(order));
    },
    allStop: () => run("All stop", ["all flying vehicles"], () => source.allStop()),
    fleetReturn: (serials, labels) =>
      run("Return in layers, first hold", labels, () => source.fleetReturn(serials)),
    dismiss: () => setLast(null),
  };
}

function isAllWell(outcome: Outcome<readonly OrderResult[]>): boolean {
  return outcome.kind === "answered" && outcome.value.every((result) => result.accepted);
}
