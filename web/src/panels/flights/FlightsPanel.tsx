import { createMemo, createResource, createSignal, For, onCleanup, onMount, Show } from "solid-js";
import { useStation } from "../../console";
import type { FlightFiguresView, FlightView, Outcome, Picture } from "../../protocol";
import { valuesOf } from "../../protocol/values";
import { saveAs } from "../../source/saveAs";
import { text } from "../../text/catalogue";
import { flightTime } from "../../text/flights";
import { formatAge, formatBytes, formatFraction } from "../../text/quantities";
import { formatArea } from "../../text/survey";
import { Empty, Panel, Problem } from "../Panel";
import "./flights.css";

const FILES = valuesOf(text.flights.files);

/** A browser holds a file in memory before it saves it. */
const LARGEST_RECORD_BYTES = 500e6;

/** The flight records in the station's folder: coverage of each, and its files. */
export function FlightsPanel() {
  const { source } = useStation();
  /** Null before the first answer. */
  const [flights, setFlights] = createSignal<readonly FlightView[] | null>(null);
  const [problem, setProblem] = createSignal<string | null>(null);
  const [chosen, setChosen] = createSignal<string | null>(null);
  const list = async () => {
    const outcome = await source.flights.list();
    setProblem(outcome.kind === "failed" ? outcome.problem : null);
    if (outcome.kind === "answered") setFlights(outcome.value);
  };
  onMount(() => void list());
  const flight = () => flights()?.find(({ name }) => name === chosen());
  return (
    <Panel
      title={text.panels.titles.flights}
      name="flights"
      actions={
        <button
          type="button"
          class="button button-quiet"
          aria-label={text.flights.refresh}
          title={text.flights.refreshHint}
          onClick={() => void list()}
        >
          ↻
        </button>
      }
    >
      <Problem text={problem()} />
      <Show
        when={flights()?.length}
        fallback={
          <Show when={problem() === null}>
            <Empty>{flights() === null ? text.flights.loading : text.flights.none}</Empty>
          </Show>
        }
      >
        <ul class="list flights-list">
          <For each={flights()}>
            {(each) => (
              <li>
                <button
                  type="button"
                  class="button button-quiet flights-pick"
                  aria-pressed={each.name === chosen()}
                  title={each.name}
                  onClick={() => setChosen(each.name === chosen() ? null : each.name)}
                >
                  <span>{flightTime(each.name)}</span>
                  <span class="muted push">
                    {each.is_recording ? text.flights.recording : formatBytes(each.size_bytes)}
                  </span>
                </button>
              </li>
            )}
          </For>
        </ul>
        <Show when={flight()?.name} keyed>
          {(name) => <Flight name={name} whyNoRecord={whyNoRecord(flight())} />}
        </Show>
      </Show>
    </Panel>
  );
}

/** Why the record itself cannot be downloaded; null: it can. */
function whyNoRecord(flight: FlightView | undefined): string | null {
  if (flight?.is_recording) return text.flights.stillRecorded;
  if ((flight?.size_bytes ?? 0) <= LARGEST_RECORD_BYTES) return null;
  return text.flights.tooLarge;
}

/** Figures and coverage of one flight, and what can be downloaded. */
function Flight(props: { name: string; whyNoRecord: string | null }) {
  const { source } = useStation();
  const [found] = createResource(() => source.flights.figures(props.name));
  const figures = () => answerOf(found());
  const [picture] = createResource(
    () => (figures()?.region_m2 ?? null) !== null,
    () => source.flights.file(props.name, "coverage.png"),
  );
  const coverage = createMemo(() => {
    const blob = answerOf(picture())?.blob;
    if (blob === undefined) return null;
    const url = URL.createObjectURL(blob);
    onCleanup(() => URL.revokeObjectURL(url));
    return url;
  });
  const [saved, setSaved] = createSignal<Outcome<Picture> | null>(null);
  const [isSaving, setSaving] = createSignal(false);
  const save = async (asked: Promise<Outcome<Picture>>, as: string) => {
    setSaving(true);
    const outcome = await asked;
    setSaving(false);
    setSaved(outcome);
    if (outcome.kind === "answered") saveAs(outcome.value.blob, as);
  };
  const isReading = () => found.loading || isSaving();
  return (
    <div class="section" data-testid="flight">
      <Show when={isReading()}>
        <p class="muted" role="status">
          {text.flights.reading}
        </p>
      </Show>
      <Problem text={problemOf(found())} />
      <Problem text={problemOf(saved())} />
      <Show when={coverage()}>
        {(url) => (
          <figure class="flights-coverage">
            <img src={url()} alt={text.flights.coverage} />
            <figcaption>
              <span class="flights-well">{text.flights.well}</span>
              <span class="flights-sunlit">{text.flights.sunlit}</span>
              <span class="flights-shade">{text.flights.shade}</span>
              <span class="flights-gap">{text.flights.gap}</span>
            </figcaption>
          </figure>
        )}
      </Show>
      <Show when={figures()}>{(found) => <Figures figures={found()} />}</Show>
      <div class="section-buttons flights-files">
        <For each={FILES}>
          {(file) => (
            <button
              type="button"
              class="button"
              disabled={isReading()}
              onClick={() =>
                void save(source.flights.file(props.name, file), `${props.name}-${file}`)
              }
            >
              {text.flights.files[file]}
            </button>
          )}
        </For>
        <button
          type="button"
          class="button"
          disabled={isReading() || props.whyNoRecord !== null}
          title={text.flights.recordHint}
          onClick={() => void save(source.flights.record(props.name), `${props.name}.mcap`)}
        >
          {text.flights.record}
        </button>
      </div>
      <Show when={props.whyNoRecord}>{(reason) => <p class="muted">{reason()}</p>}</Show>
    </div>
  );
}

function answerOf<T>(outcome: Outcome<T> | null | undefined): T | null {
  return outcome?.kind === "answered" ? outcome.value : null;
}

function problemOf(outcome: Outcome<unknown> | null | undefined): string | null {
  return outcome?.kind === "failed" ? outcome.problem : null;
}

/** Hour and minute of a time in UTC. */
function clockTime(utc: string): string {
  return utc.slice(11, 16);
}

function Figures(props: { figures: FlightFiguresView }) {
  const rows = () => {
    const { figures } = props;
    const region = figures.region_m2;
    return [
      [text.flights.site, figures.site || text.flights.unnamed],
      [
        text.flights.time,
        text.flights.fromTo(clockTime(figures.begin_utc), clockTime(figures.end_utc)),
      ],
      [text.flights.vehicles, figures.vehicles.join(", ")],
      [text.flights.airborne, formatAge(figures.airborne_s)],
      [text.flights.region, region === null ? text.flights.noSurvey : formatArea(region)],
      [text.flights.photographed, formatFraction(figures.photographed_share)],
      [text.flights.inSun, formatFraction(figures.sunlit_share)],
      [text.flights.wellInSun, formatFraction(figures.well_sunlit_share)],
      [text.flights.meanSun, formatFraction(figures.mean_sun_share)],
      [text.flights.alarms, String(figures.alarms)],
    ] as const;
  };
  return (
    <>
      <Show when={props.figures.trouble}>
        {(trouble) => <p class="tone-warning wire-text">{text.flights.endsEarly(trouble())}</p>}
      </Show>
      <dl class="flights-figures">
        <For each={rows()}>
          {([label, value]) => (
            <div>
              <dt class="muted">{label}</dt>
              <dd class="wire-text">{value}</dd>
            </div>
          )}
        </For>
      </dl>
      <p class="muted">{text.flights.estimated}</p>
    </>
  );
}
