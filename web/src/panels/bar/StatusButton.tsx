import { createMemo, createSignal, createUniqueId, For, Show } from "solid-js";
import { useConsole } from "../../console";
import { type Readiness, readiness } from "../../fleet/readiness";
import { SeverityMark } from "../SeverityMark";

/** Readiness of station and fleet as a label; a press shows all reasons. */
export function StatusButton() {
  const { source, behindS } = useConsole();
  const [isOpen, setOpen] = createSignal(false);
  const panel = createUniqueId();
  const now = createMemo(() => readiness(source.state(), source.connection(), behindS()));
  const closeOnEscape = (event: KeyboardEvent) => {
    if (event.key !== "Escape" || !isOpen()) return;
    event.stopPropagation();
    setOpen(false);
  };
  return (
    <div class="state">
      <button
        type="button"
        class={`status-button tone-ground-${now().severity ?? "good"}`}
        aria-expanded={isOpen()}
        onKeyDown={closeOnEscape}
        aria-controls={panel}
        onClick={() => setOpen(!isOpen())}
      >
        <SeverityMark severity={now().severity} size={26} />
        <span class="status-text" data-testid="status-label">
          {now().label}
        </span>
        <span class="status-count">{count(now())}</span>
      </button>
      <Show when={isOpen()}>
        <Reasons id={panel} readiness={now()} />
      </Show>
    </div>
  );
}

function count(readiness: Readiness): string {
  const total = readiness.reasons.length;
  if (total === 0) return "details";
  return total === 1 ? "1 reason" : `${total} reasons`;
}

function Reasons(props: { id: string; readiness: Readiness }) {
  return (
    <section id={props.id} class="status-reasons" aria-label="Reasons">
      <Show
        when={props.readiness.reasons.length > 0}
        fallback={<p>All vehicles connected, no problems</p>}
      >
        <ul>
          <For each={props.readiness.reasons}>
            {(reason) => (
              <li class={`tone-${reason.severity}`}>
                <SeverityMark severity={reason.severity} />
                <span class="wire-text">
                  <Show when={reason.vehicleName}>{(name) => <strong>{name()}: </strong>}</Show>
                  {reason.text}
                </span>
              </li>
            )}
          </For>
        </ul>
      </Show>
    </section>
  );
}
