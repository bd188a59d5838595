import { type Accessor, createEffect, createMemo, createSignal, onCleanup } from "solid-js";
import type { OrderResult } from "../protocol";
import type { Clock } from "../source/clock";
import type { NamedOrder, Outcome, StationSource } from "../source/stationSource";
import { refusalText } from "../text/names";

/** What the gate says to an order that is not given yet. */
export type Judgement =
  | { readonly kind: "nothing" }
  | { readonly kind: "asking" }
  | { readonly kind: "allowed" }
  | { readonly kind: "refused"; readonly text: string };

/** Numbers are typed digit by digit: the gate is asked when they stand still. */
const SETTLED_MS = 250;
/** What is allowed now may not be so soon: vehicles move, batteries drain. */
const AGAIN_MS = 1000;

/** Asks the gate about an order for as long as there is one, anew whenever it changes. */
export function createJudgement(
  source: Pick<StationSource, "check">,
  clock: Clock,
  order: Accessor<NamedOrder | null>,
): Accessor<Judgement> {
  const [judgement, setJudgement] = createSignal<Judgement>({ kind: "nothing" });
  const written = createMemo(() => (order() === null ? "" : JSON.stringify(order())));
  createEffect(() => {
    const now = written();
    setJudgement({ kind: now === "" ? "nothing" : "asking" });
    if (now === "") return;
    const asked = JSON.parse(now) as NamedOrder;
    let isOver = false;
    let cancel = clock.after(SETTLED_MS, () => void ask());
    const ask = async () => {
      const outcome = await source.check(asked);
      if (isOver) return;
      setJudgement(judgementOf(outcome));
      cancel = clock.after(AGAIN_MS, () => void ask());
    };
    onCleanup(() => {
      isOver = true;
      cancel();
    });
  });
  return judgement;
}

function judgementOf(outcome: Outcome<readonly OrderResult[]>): Judgement {
  if (outcome.kind === "failed") return { kind: "refused", text: outcome.problem };
  const refused = outcome.value.find((result) => !result.accepted);
  if (refused !== undefined) {
    return { kind: "refused", text: refusalText(refused.rule, refused.reason) };
  }
  if (outcome.value.length > 0) return { kind: "allowed" };
  return { kind: "refused", text: "The station judged nothing. Try again." };
}
