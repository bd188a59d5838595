import { createEffect, createMemo, createSignal, For, Index, on, Show } from "solid-js";
import { useSiteEditing } from "../../console";
import type { LonLat } from "../../map/localGrid";
import { valuesOf } from "../../protocol/values";
import { LEAST_CORNERS } from "../../site/siteDraft";
import {
  type Attribute,
  cornerOf,
  cornerText,
  type DraftFeature,
  featureName,
  isDraggable,
  LAYERS,
  MOST_DRAGGED,
  type Ring,
} from "../../site/siteFeatures";
import { text } from "../../text/catalogue";
import { lengthText, lengthUnit, metresOf, numberIn } from "../../text/units";

/** Corners listed at once: a surveyed outline has hundreds. */
const LISTED = 20;

/** The selected feature: name, heights, and its corners as coordinates, for the keyboard or exact values. */
export function FeatureForm(props: { feature: DraftFeature }) {
  const { siteDraft } = useSiteEditing();
  const kind = () => LAYERS[props.feature.layer];
  const set = (key: string, value: Attribute) =>
    siteDraft.setProperty(props.feature.id, key, value);
  return (
    <section
      class="section site-form"
      aria-label={text.feature.selected(featureName(props.feature))}
    >
      <TextField
        label={text.feature.name}
        value={props.feature.properties["name"] ?? ""}
        onChange={(typed) => set("name", typed.trim() || null)}
      />
      <Show when={kind().hasHeights}>
        <LengthInput feature={props.feature} name="floor_m" label={text.feature.floor} />
        <LengthInput feature={props.feature} name="ceiling_m" label={text.feature.ceiling} />
        <label class="site-wide">
          {text.feature.datum}
          <select
            class="field"
            value={String(props.feature.properties["datum"] ?? "ground")}
            onChange={(event) => set("datum", event.currentTarget.value)}
          >
            <For each={valuesOf(text.feature.datums)}>
              {(datum) => <option value={datum}>{text.feature.datums[datum]}</option>}
            </For>
          </select>
        </label>
      </Show>
      <Show when={kind().isPoint}>
        <LengthInput feature={props.feature} name="altitude_m" label={text.feature.altitude} />
        <TextField
          label={text.feature.serial}
          value={props.feature.properties["serial"] ?? ""}
          onChange={(typed) => set("serial", typed.trim() || null)}
        />
      </Show>
      <Show when={!isDraggable(props.feature)}>
        <p class="site-wide">{text.feature.tooManyCorners(MOST_DRAGGED)}</p>
      </Show>
      <Index each={props.feature.rings}>
        {(ring, index) => <Corners feature={props.feature} ring={ring()} index={index} />}
      </Index>
      <div class="section-buttons site-wide">
        <Show when={!kind().isPoint}>
          <button
            type="button"
            class="button"
            onClick={() => siteDraft.draw({ layer: props.feature.layer, hole: true })}
          >
            {text.feature.drawHole}
          </button>
        </Show>
        <button
          type="button"
          class="button"
          onClick={() => siteDraft.removeRing(props.feature.id, 0)}
        >
          {text.feature.remove(featureName(props.feature))}
        </button>
      </div>
    </section>
  );
}

function TextField(props: { label: string; value: Attribute; onChange: (text: string) => void }) {
  return (
    <label class="site-wide">
      {props.label}
      <input
        class="field"
        type="text"
        maxlength={100}
        value={String(props.value)}
        onChange={(event) => props.onChange(event.currentTarget.value)}
      />
    </label>
  );
}

/** A length in the chosen unit or, empty, nothing. The draft has metres. */
function LengthInput(props: { feature: DraftFeature; name: string; label: string }) {
  const { siteDraft } = useSiteEditing();
  const shown = () => {
    const length_m = props.feature.properties[props.name] ?? "";
    return typeof length_m === "number" ? lengthText(length_m) : String(length_m);
  };
  const change = (typed: string) => {
    const value = numberIn(typed);
    if (value === null && typed.trim() !== "") return false;
    siteDraft.setProperty(props.feature.id, props.name, value === null ? null : metresOf(value));
    return true;
  };
  return (
    // biome-ignore lint/a11y/noLabelWithoutControl: its control is the component's
    <label>
      {props.label}, {lengthUnit()}
      <CheckedField text={shown()} inputmode="decimal" onChange={change} />
    </label>
  );
}

/** What cannot be read (`onChange` returns false) stays in the field, marked, until there is a new text. */
function CheckedField(props: {
  text: string;
  inputmode: "decimal" | "text";
  label?: string;
  onChange: (text: string) => boolean;
}) {
  const [isBad, setBad] = createSignal(false);
  const shown = createMemo(() => props.text);
  createEffect(on(shown, () => setBad(false)));
  return (
    <input
      class="field"
      type="text"
      inputmode={props.inputmode}
      aria-label={props.label}
      aria-invalid={isBad()}
      value={shown()}
      onChange={(event) => setBad(!props.onChange(event.currentTarget.value))}
    />
  );
}

/** The corners of one ring, a page at a time; each is a field with latitude and longitude. */
function Corners(props: { feature: DraftFeature; ring: Ring; index: number }) {
  const { siteDraft } = useSiteEditing();
  const [first, setFirst] = createSignal(0);
  const isPoint = () => LAYERS[props.feature.layer].isPoint;
  const title = () => {
    if (isPoint()) return text.feature.place;
    const corners = props.ring.length;
    return props.index === 0
      ? text.feature.outline(corners)
      : text.feature.hole(props.index, corners);
  };
  const start = () => Math.min(first(), Math.max(0, props.ring.length - 1));
  const shown = () => props.ring.slice(start(), start() + LISTED);
  const put = (ring: Ring) => siteDraft.setRing(props.feature.id, props.index, ring);
  const move = (at: number, to: LonLat) => put(props.ring.map((one, i) => (i === at ? to : one)));
  const insert = (after: number) => {
    const [one, next] = [props.ring[after], props.ring[(after + 1) % props.ring.length]];
    if (one === undefined || next === undefined) return;
    const middle = { lon: (one.lon + next.lon) / 2, lat: (one.lat + next.lat) / 2 };
    put([...props.ring.slice(0, after + 1), middle, ...props.ring.slice(after + 1)]);
  };
  return (
    <details class="site-wide site-corners" open={isPoint()}>
      <summary>{title()}</summary>
      <Show when={props.index > 0}>
        <button
          type="button"
          class="button"
          onClick={() => siteDraft.removeRing(props.feature.id, props.index)}
        >
          {text.feature.removeHole(props.index)}
        </button>
      </Show>
      <p class="muted">{text.feature.cornersAre}</p>
      <ol>
        <Index each={shown()}>
          {(corner, offset) => (
            <Corner
              number={start() + offset + 1}
              corner={corner()}
              isAlone={isPoint()}
              canGo={props.ring.length > LEAST_CORNERS}
              onMove={(to) => move(start() + offset, to)}
              onInsert={() => insert(start() + offset)}
              onRemove={() => put(props.ring.filter((_, i) => i !== start() + offset))}
            />
          )}
        </Index>
      </ol>
      <Show when={props.ring.length > LISTED}>
        <div class="section-buttons">
          <For
            each={
              [
                [text.feature.earlier, -LISTED],
                [text.feature.later, LISTED],
              ] as const
            }
          >
            {([label, by]) => (
              <button
                type="button"
                class="button"
                disabled={start() + by < 0 || start() + by >= props.ring.length}
                onClick={() => setFirst(start() + by)}
              >
                {label}
              </button>
            )}
          </For>
        </div>
      </Show>
    </details>
  );
}

function Corner(props: {
  number: number;
  corner: LonLat;
  isAlone: boolean;
  canGo: boolean;
  onMove: (to: LonLat) => void;
  onInsert: () => void;
  onRemove: () => void;
}) {
  const change = (typed: string) => {
    const to = cornerOf(typed);
    if (to !== null) props.onMove(to);
    return to !== null;
  };
  const name = () =>
    props.isAlone ? text.feature.placeField : text.feature.cornerField(props.number);
  return (
    <li class="site-corner">
      <CheckedField
        text={cornerText(props.corner)}
        inputmode="text"
        label={name()}
        onChange={change}
      />
      <Show when={!props.isAlone}>
        <button
          type="button"
          class="button"
          aria-label={text.feature.addCorner(props.number)}
          title={text.feature.addCornerHint}
          onClick={() => props.onInsert()}
        >
          +
        </button>
        <button
          type="button"
          class="button"
          aria-label={text.feature.removeCorner(props.number)}
          title={text.feature.removeCornerHint}
          disabled={!props.canGo}
          onClick={() => props.onRemove()}
        >
          ✕
        </button>
      </Show>
    </li>
  );
}
