import { For, Show } from "solid-js";
import { useConsole } from "../console";
import { Popover } from "../panels/Popover";
import type { OverlayKind } from "./overlays";

/** What can lie over the ground image, with the legend of each. */
const OVERLAYS: readonly (readonly [OverlayKind, string])[] = [
  ["none", "No overlay"],
  ["shade", "Shade now"],
  ["forecast", "Sun forecast"],
  ["cells", "Coverage"],
];

const LEGENDS: Readonly<Record<OverlayKind, readonly (readonly [string, string])[]>> = {
  none: [],
  shade: [
    ["is-sun", "sun"],
    ["is-shade", "shade"],
    ["is-unknown", "not known"],
  ],
  forecast: [
    ["is-sun", "sun"],
    ["is-shade", "shade"],
    ["is-unknown", "not known: an estimate"],
  ],
  cells: [
    ["is-sun", "photographed in sun"],
    ["is-shade-lines", "photographed in shade"],
    ["is-unknown", "photographed, light unknown"],
  ],
};

/** Chooses the overlay of the map, and explains its colours. */
export function LayersButton() {
  const { overlay } = useConsole();
  return (
    <Popover class="layers" label="Map overlay" title="Map overlay" button={<LayersIcon />}>
      {() => (
        <fieldset class="card layers-list">
          <legend class="hidden-but-read">Map overlay</legend>
          <For each={OVERLAYS}>
            {([kind, label]) => (
              <label>
                <input
                  type="radio"
                  name="overlay"
                  checked={overlay.kind() === kind}
                  onChange={() => overlay.show(kind)}
                />
                {label}
              </label>
            )}
          </For>
          <Legend kind={overlay.kind()} />
        </fieldset>
      )}
    </Popover>
  );
}

export function Legend(props: { kind: OverlayKind }) {
  return (
    <Show when={LEGENDS[props.kind].length > 0}>
      <ul class="legend" aria-label="Legend">
        <For each={LEGENDS[props.kind]}>
          {([look, text]) => (
            <li>
              <span class={`light-swatch ${look}`} aria-hidden="true" />
              {text}
            </li>
          )}
        </For>
      </ul>
    </Show>
  );
}

function LayersIcon() {
  return (
    <svg class="fit-icon" viewBox="0 0 24 24" width="22" height="22" aria-hidden="true">
      <path d="M12 3 2.5 8.5 12 14l9.5-5.5zM2.5 13.5 12 19l9.5-5.5" />
    </svg>
  );
}
