import { createEffect, createMemo, createSignal, For, Show } from "solid-js";
import { useMapModes, useStation } from "../../console";
import { Legend } from "../../map/LayersButton";
import type { ForecastView } from "../../protocol";
import { text } from "../../text/catalogue";
import { formatAge, formatFraction } from "../../text/quantities";
import "./time.css";

/** The light on the field over the next minutes, as a scale: a press shows the forecast for that time. */
export function TimeScale() {
  const { fleet } = useStation();
  const known = () => {
    const forecast = fleet.shade?.forecast;
    return forecast ? knownPart(forecast) : null;
  };
  return <Show when={known()}>{(forecast) => <Scale forecast={forecast()} />}</Show>;
}

function Scale(props: { forecast: ForecastView }) {
  const { overlay } = useMapModes();
  const [isFolded, setFolded] = createSignal(false);
  const leads = () => props.forecast.lead_s;
  // What is shown stays on the scale when less is known than before.
  createEffect(() => {
    if (!leads().includes(overlay.lead_s())) overlay.setLead(leads().at(-1) ?? 0);
  });
  const index = () => Math.max(0, leads().indexOf(overlay.lead_s()));
  const lead_s = () => leads()[index()] ?? 0;
  const when = () =>
    lead_s() === 0 ? text.forecast.sunNow : text.forecast.sunIn(leadText(lead_s()));
  const share = () => formatFraction(props.forecast.sun_share[index()] ?? null);
  const right = () => nearestRight(props.forecast, lead_s());
  const fill = createMemo(() => gradient(props.forecast));
  return (
    <section class="card time" aria-label={text.forecast.name}>
      <p class="time-head">
        <span>
          <strong>{when()}</strong>
          <span class="muted"> · {text.forecast.ofField(share())}</span>
          <Show when={right()}>
            {(found) => (
              <span class="muted time-right" title={text.forecast.rightHint}>
                {" "}
                · {text.forecast.right(formatFraction(found()))}
              </span>
            )}
          </Show>
        </span>
        <Legend kind="forecast" />
        <button
          type="button"
          class="button button-quiet"
          aria-expanded={!isFolded()}
          aria-label={isFolded() ? text.forecast.show : text.forecast.fold}
          onClick={() => setFolded(!isFolded())}
        >
          {isFolded() ? "▴" : "▾"}
        </button>
      </p>
      <Show when={!isFolded()}>
        <input
          class="time-scale"
          type="range"
          min={0}
          max={leads().length - 1}
          step={1}
          value={index()}
          style={{ "--fill": fill() }}
          aria-label={text.forecast.time}
          aria-valuetext={when()}
          onInput={(event) => {
            overlay.setLead(leads()[Number(event.currentTarget.value)] ?? 0);
            overlay.show("forecast");
          }}
        />
        <p class="time-ticks muted" aria-hidden="true">
          <For each={ticksOf(leads())}>
            {({ lead, at, isCoarse }) => (
              <span
                classList={{ fine: !isCoarse }}
                style={{ left: `${100 * at}%`, transform: `translateX(${-100 * at}%)` }}
              >
                {lead === 0 ? text.forecast.now : leadText(lead)}
              </span>
            )}
          </For>
        </p>
      </Show>
    </section>
  );
}

/** Less of the field than this known is as good as nothing. */
const LEAST_KNOWN = 0.05;

/** So much is shown even where nothing is known: a scale has two ends. */
const LEAST_S = 60;

/** A forecast up to the last lead at which some of the field is known. */
export function knownPart(forecast: ForecastView): ForecastView {
  const last = forecast.predicted_share.findLastIndex((share) => share >= LEAST_KNOWN);
  const near = forecast.lead_s.filter((lead) => lead <= LEAST_S).length;
  const count = Math.max(near, last + 1);
  return {
    ...forecast,
    lead_s: forecast.lead_s.slice(0, count),
    sun_share: forecast.sun_share.slice(0, count),
    predicted_share: forecast.predicted_share.slice(0, count),
  };
}

/** A lead as `45 s` or `2 min`; leads are whole seconds. */
function leadText(lead_s: number): string {
  return lead_s >= 60 && lead_s % 60 === 0 ? `${lead_s / 60} min` : formatAge(lead_s);
}

/** The share of cells that forecasts of this flight had right, at the nearest lead compared so far. */
export function nearestRight(forecast: ForecastView, lead_s: number): number | null {
  const [nearest] = [...forecast.right].sort(
    (a, b) => Math.abs(a.lead_s - lead_s) - Math.abs(b.lead_s - lead_s),
  );
  return lead_s === 0 || nearest === undefined ? null : nearest.right_share;
}

/**
 * Between the colours of sun and of shade, by how much of the field will be in sun. Solid where the clouds to come are
 * seen, fading to the hatch of the unknown where they are not.
 */
export function gradient({ lead_s, predicted_share, sun_share }: ForecastView): string {
  const last = Math.max(1, lead_s.length - 1);
  const stops = predicted_share.map((share, index) => {
    const light = `color-mix(in srgb, var(--sun) ${percent(sun_share[index] ?? 0)}%, var(--shade))`;
    return `color-mix(in srgb, ${light} ${percent(share)}%, transparent) ${(100 * index) / last}%`;
  });
  return `linear-gradient(to right, ${stops.join(", ")})`;
}

function percent(share: number): number {
  return Math.round(100 * Math.min(1, Math.max(0, share)));
}

/** Between labels, as a share of the scale: what a wide one has room for, and what a narrow one has. */
const LEAST_GAP = 0.08;
const COARSE_GAP = 0.19;

interface Tick {
  readonly lead: number;
  /** Place from 0 to 1. */
  readonly at: number;
  /** Whether it has room on a narrow scale, too. */
  readonly isCoarse: boolean;
}

/** Leads with a label, as even as the scale allows. */
export function ticksOf(leads: readonly number[]): readonly Tick[] {
  const coarse = spaced(leads, COARSE_GAP);
  return spaced(leads, LEAST_GAP).map((tick) => ({
    ...tick,
    isCoarse: coarse.some(({ lead }) => lead === tick.lead),
  }));
}

function spaced(leads: readonly number[], gap: number): { lead: number; at: number }[] {
  const last = Math.max(1, leads.length - 1);
  const ticks: { lead: number; at: number }[] = [];
  for (const [index, lead] of leads.entries()) {
    const at = index / last;
    const isEven = lead % 60 === 0 || lead === 30;
    const before = ticks.at(-1)?.at ?? -1;
    if (isEven && at - before >= gap && (1 - at >= gap || at === 1)) ticks.push({ lead, at });
  }
  return ticks;
}
