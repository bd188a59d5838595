import { For } from "solid-js";
import type { LightSharesView } from "../../protocol";
import { text } from "../../text/catalogue";
import { type LightPercents, lightPercents } from "../../text/light";

const LIGHTS: readonly (keyof LightPercents)[] = ["sun", "shade", "unknown"];

/** Shares of the ground in view as a bar, with the colours and patterns that the map uses. */
export function LightShares(props: { inView: LightSharesView }) {
  const percents = () => lightPercents(props.inView);
  return (
    <>
      <div class="light-bar" aria-hidden="true">
        <For each={LIGHTS}>
          {(light) => <span class={`is-${light}`} style={{ width: `${percents()[light]}%` }} />}
        </For>
      </div>
      <ul class="light-legend" aria-label={text.sun.shares}>
        <For each={LIGHTS}>
          {(light) => (
            <li>
              <span class={`light-swatch is-${light}`} aria-hidden="true" />
              {text.sun.lights[light](`${percents()[light]}\u00a0%`)}
            </li>
          )}
        </For>
      </ul>
    </>
  );
}
