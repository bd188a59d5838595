import { createEffect, createMemo, createSignal, For, Show } from "solid-js";
import { useOrders, useStation } from "../../console";
import { summarise } from "../../orders/answers";
import type { OrderAnswer } from "../../orders/orderApi";
import { text } from "../../text/catalogue";
import { listNames } from "../../text/names";
import { SeverityMark } from "../SeverityMark";

/** The answer to the last order in one line over the map; the names on demand. */
export function AnswerNotice() {
  const { orderApi } = useOrders();
  return (
    <Show when={orderApi.lastAnswer()}>
      {(answer) => (
        <div class="card toast" role="status">
          <Answer answer={answer()} />
          <button
            type="button"
            class="button button-quiet"
            aria-label={text.answers.dismiss}
            onClick={() => orderApi.dismiss()}
          >
            ✕
          </button>
        </div>
      )}
    </Show>
  );
}

/** An answer in one line, with the names behind its counts. */
export function Answer(props: { answer: OrderAnswer }) {
  const { fleet } = useStation();
  const [isOpen, setOpen] = createSignal(false);
  const summary = createMemo(() => summarise(props.answer, fleet.commands, fleet.vehicles));
  const isWaiting = () => props.answer.outcome.kind === "waiting";
  // A new order's answer begins in one line.
  createEffect(() => {
    if (isWaiting()) setOpen(false);
  });
  return (
    <div class="toast-text">
      <p class="toast-line">
        <Show when={!isWaiting()}>
          <span class={`tone-${summary().severity ?? "good"}`}>
            <SeverityMark severity={summary().severity} />
          </span>
        </Show>
        <span class="wire-text">{summary().text}</span>
        <Show when={summary().lines.length > 0}>
          <button
            type="button"
            class="button button-quiet toast-names"
            aria-expanded={isOpen()}
            onClick={() => setOpen(!isOpen())}
          >
            {text.answers.names}
          </button>
        </Show>
      </p>
      <Show when={isOpen()}>
        <ul class="toast-lines wire-text">
          <For each={summary().lines}>
            {(line) => (
              <li>
                <span class={line.severity === null ? "muted" : `tone-${line.severity}`}>
                  {line.title}:
                </span>{" "}
                {listNames(line.names)}
              </li>
            )}
          </For>
        </ul>
      </Show>
    </div>
  );
}
