import { createSignal, For, type JSX, Show } from "solid-js";
import { FileButton } from "../panels/FileButton";
import { areaHa, ringsOf } from "../site/siteFeatures";
import { text } from "../text/catalogue";
import { formatQuantity } from "../text/quantities";
import {
  chooseLengthUnit,
  formatLength,
  LENGTH_UNITS,
  type LengthUnit,
  lengthUnit,
} from "../text/units";
import { FieldPicture } from "./FieldPicture";
import type { FieldShape, Fields, NewSite } from "./newSite";
import "./newSite.css";

/** Least, most and step of the sliders. */
const MARGIN_M = [20, 150, 5] as const;
const COVER_PERCENT = [0, 100, 5] as const;

/** Asks where the field is, and makes the site there. */
export function NewSitePage(props: { newSite: NewSite }) {
  const { folder, fields, shapes, layers, notice, busyWith } = props.newSite;
  const [isOver, setOver] = createSignal(false);
  let height: HTMLInputElement | undefined;
  const isBusy = () => busyWith() !== null;
  const submit = (event: Event) => {
    event.preventDefault();
    void props.newSite.make();
  };
  const read = async (file: File) => {
    await props.newSite.readFile(file);
    // The one thing that a file does not say.
    height?.focus();
  };
  return (
    <main
      class="new-site"
      classList={{ "is-over": isOver() }}
      onDragOver={(event) => {
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={() => setOver(false)}
      onDrop={(event) => {
        event.preventDefault();
        setOver(false);
        const file = event.dataTransfer?.files[0];
        if (file !== undefined && !isBusy()) void read(file);
      }}
    >
      <form class="new-site-card" onSubmit={submit} aria-labelledby="new-site-title">
        <h1 id="new-site-title">{text.newSite.title}</h1>
        <p class="muted wire-text">{text.newSite.what(<code>{folder()}</code>)}</p>
        <div class="new-site-column">
          <div class="new-site-ways">
            <FileButton
              label={text.newSite.readFile}
              disabled={isBusy()}
              onFile={(file) => void read(file)}
            />
            <button
              type="button"
              class="button"
              disabled={isBusy()}
              onClick={() => void props.newSite.locate()}
            >
              {text.newSite.locate}
            </button>
          </div>
          <Show
            when={shapes().length > 0}
            fallback={
              <>
                <p class="muted">{text.newSite.formats}</p>
                <TextField
                  newSite={props.newSite}
                  name="place"
                  label={text.newSite.place}
                  placeholder="41.9012, -93.6034"
                />
              </>
            }
          >
            <Shapes newSite={props.newSite} />
          </Show>
          <Show when={layers().length > 0}>
            <FieldPicture layers={layers()} />
            <Slider
              label={text.newSite.margin}
              shown={formatLength(fields().margin_m)}
              range={MARGIN_M}
              value={fields().margin_m}
              onChange={(margin_m) => props.newSite.change({ margin_m })}
            />
          </Show>
        </div>
        <div class="new-site-column">
          <div class="new-site-row new-site-height">
            <TextField
              newSite={props.newSite}
              name="groundHeight"
              label={text.newSite.height}
              ref={(element) => {
                height = element;
              }}
            />
            <label class="new-site-field">
              {text.newSite.unit}
              <select
                class="page-field"
                onChange={(event) => chooseLengthUnit(event.currentTarget.value as LengthUnit)}
              >
                <For each={Object.keys(LENGTH_UNITS) as LengthUnit[]}>
                  {(unit) => (
                    <option value={unit} selected={unit === lengthUnit()}>
                      {LENGTH_UNITS[unit]}
                    </option>
                  )}
                </For>
              </select>
            </label>
          </div>
          <p class="muted">{text.newSite.heightHow}</p>
          <Slider
            label={text.newSite.cover}
            shown={formatQuantity(fields().cover_percent, "%", 0)}
            range={COVER_PERCENT}
            value={fields().cover_percent}
            onChange={(cover_percent) => props.newSite.change({ cover_percent })}
          />
          <div class="new-site-row">
            <TextField newSite={props.newSite} name="wind" label={text.newSite.wind} />
            <TextField newSite={props.newSite} name="windFrom" label={text.newSite.windFrom} />
          </div>
          <div class="new-site-row">
            <TextField newSite={props.newSite} name="name" label={text.newSite.name} />
            <TextField newSite={props.newSite} name="drones" label={text.newSite.drones} />
          </div>
          <Show when={busyWith()}>
            {(what) => (
              <label class="new-site-field wire-text" role="status">
                {what()}
                <progress />
              </label>
            )}
          </Show>
          <Show when={notice()}>
            {(shown) => (
              <p
                class="wire-text"
                classList={{ "tone-error": shown().kind === "error" }}
                role={shown().kind === "error" ? "alert" : "status"}
              >
                {shown().text}
              </p>
            )}
          </Show>
          <button type="submit" class="button new-site-make" disabled={isBusy()}>
            {text.newSite.make}
          </button>
        </div>
      </form>
    </main>
  );
}

/** The polygons of a file: which of them are surveyed. */
function Shapes(props: { newSite: NewSite }) {
  const { shapes, choose, forget } = props.newSite;
  const label = ({ name, geometry }: FieldShape, index: number) => {
    const area = formatQuantity(areaHa({ rings: ringsOf(geometry) }), "ha");
    return text.newSite.shape(name || text.newSite.unnamed(index + 1), area);
  };
  return (
    <fieldset class="new-site-shapes">
      <legend>{text.newSite.shapes(shapes().length)}</legend>
      <div class="new-site-choices">
        <For each={shapes()}>
          {(shape, index) => (
            <label class="wire-text">
              <input
                type="checkbox"
                checked={shape.isChosen}
                onChange={(event) => choose(index(), event.currentTarget.checked)}
              />
              {label(shape, index())}
            </label>
          )}
        </For>
      </div>
      <button type="button" class="button button-quiet" onClick={forget}>
        {text.newSite.forget}
      </button>
    </fieldset>
  );
}

function Slider(props: {
  label: string;
  shown: string;
  range: readonly [number, number, number];
  value: number;
  onChange: (value: number) => void;
}): JSX.Element {
  return (
    <label class="new-site-field">
      <span class="new-site-slider">
        {props.label} <output>{props.shown}</output>
      </span>
      <input
        type="range"
        min={props.range[0]}
        max={props.range[1]}
        step={props.range[2]}
        value={props.value}
        onInput={(event) => props.onChange(Number(event.currentTarget.value))}
      />
    </label>
  );
}

/** The fields that are typed. */
type TextName = {
  [Name in keyof Fields]: Fields[Name] extends string ? Name : never;
}[keyof Fields];

function TextField(props: {
  newSite: NewSite;
  name: TextName;
  label: string;
  placeholder?: string;
  ref?: (element: HTMLInputElement) => void;
}) {
  return (
    <label class="new-site-field">
      {props.label}
      <input
        ref={(element) => props.ref?.(element)}
        class="page-field"
        type="text"
        autocomplete="off"
        spellcheck={false}
        required
        placeholder={props.placeholder}
        value={props.newSite.fields()[props.name]}
        onInput={(event) => props.newSite.change({ [props.name]: event.currentTarget.value })}
      />
    </label>
  );
}
