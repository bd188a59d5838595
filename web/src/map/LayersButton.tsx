import { For, onMount, Show } from "solid-js";
import { useMapModes } from "../console";
import { Popover } from "../panels/Popover";
import type { BaseMapView } from "../protocol";
import { coverageText, isIncomplete } from "../text/baseMaps";
import { text } from "../text/catalogue";
import type { OverlayKind } from "./overlays";

/** What can lie over the ground image, with the legend of each. */
const OVERLAYS: readonly OverlayKind[] = ["none", "shade", "forecast", "cells"];

const LEGENDS: Readonly<Record<OverlayKind, readonly (readonly [string, string])[]>> = {
  none: [],
  shade: [
    ["is-sun", text.layers.sun],
    ["is-shade", text.layers.shade],
    ["is-unknown", text.layers.unknown],
  ],
  forecast: [
    ["is-sun", text.layers.sun],
    ["is-shade", text.layers.shade],
    ["is-unknown", text.layers.estimated],
  ],
  cells: [
    ["is-sun", text.layers.inSun],
    ["is-shade-lines", text.layers.inShade],
    ["is-unknown", text.layers.lightUnknown],
  ],
};

/** Chooses the overlay, with its colours explained, and the base map, with what it covers. */
export function LayersButton() {
  return (
    <Popover
      class="layers"
      label={text.layers.name}
      title={text.layers.name}
      button={<LayersIcon />}
    >
      {() => (
        <div class="card layers-list">
          <OverlayChoice />
          <BaseMapChoice />
          <p class="muted">{text.layers.ato}</p>
        </div>
      )}
    </Popover>
  );
}

function OverlayChoice() {
  const { overlay } = useMapModes();
  return (
    <fieldset>
      <legend class="hidden-but-read">{text.layers.overlay}</legend>
      <For each={OVERLAYS}>
        {(kind) => (
          <label>
            <input
              type="radio"
              name="overlay"
              checked={overlay.kind() === kind}
              onChange={() => overlay.show(kind)}
            />
            {text.layers.overlays[kind]}
          </label>
        )}
      </For>
      <Legend kind={overlay.kind()} />
    </fieldset>
  );
}

/** The maps of the site's folder; read again whenever the list is opened. */
function BaseMapChoice() {
  const { baseMaps } = useMapModes();
  onMount(() => void baseMaps.refresh());
  return (
    <fieldset class="base-maps">
      <legend>{text.layers.map}</legend>
      <Show when={(baseMaps.maps() ?? []).length > 0}>
        <label>
          <input
            type="radio"
            name="base-map"
            checked={baseMaps.shown() === null}
            onChange={() => baseMaps.choose(null)}
          />
          {text.layers.none}
        </label>
      </Show>
      <For each={baseMaps.maps() ?? []}>{(base) => <BaseMapLine base={base} />}</For>
      <Show when={baseMaps.note()}>{(note) => <p class="base-map-note">{note()}</p>}</Show>
      <Show when={baseMaps.maps() === null && baseMaps.note() === null}>
        <p class="base-map-note">{text.layers.looking}</p>
      </Show>
    </fieldset>
  );
}

function BaseMapLine(props: { base: BaseMapView }) {
  const { baseMaps } = useMapModes();
  return (
    <label classList={{ "is-unusable": props.base.problem !== null }}>
      <input
        type="radio"
        name="base-map"
        disabled={props.base.problem !== null}
        checked={baseMaps.shown()?.name === props.base.name}
        onChange={() => baseMaps.choose(props.base.name)}
      />
      <span class="wire-text">
        {props.base.title}
        <small classList={{ "tone-warning": isIncomplete(props.base) }}>
          {coverageText(props.base)}
        </small>
      </span>
    </label>
  );
}

export function Legend(props: { kind: OverlayKind }) {
  return (
    <Show when={LEGENDS[props.kind].length > 0}>
      <ul class="legend" aria-label={text.layers.legend}>
        <For each={LEGENDS[props.kind]}>
          {([look, light]) => (
            <li>
              <span class={`light-swatch ${look}`} aria-hidden="true" />
              {light}
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
