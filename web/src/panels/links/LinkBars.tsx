import { createMemo, For, Show } from "solid-js";
import { useStation } from "../../console";
import { text } from "../../text/catalogue";
import "./links.css";

const BARS = [1, 2, 3, 4] as const;

/** How regularly a vehicle's telemetry arrives, as bars; nothing without a link. */
export function LinkBars(props: { linkId: number | null }) {
  const { fleet } = useStation();
  const figures = createMemo(
    () => fleet.links.find((link) => link.id === props.linkId)?.figures ?? null,
  );
  return (
    <Show when={figures()}>
      {(known) => (
        <span
          class="link-bars"
          classList={{ "is-poor": known().bars <= 1 }}
          role="img"
          aria-label={text.links.figures(known())}
          title={text.links.figures(known())}
        >
          <For each={BARS}>{(bar) => <span classList={{ "is-on": bar <= known().bars }} />}</For>
        </span>
      )}
    </Show>
  );
}
