import { createResource, createSignal, For, onCleanup, onMount, Show } from "solid-js";
import { usePage, useStation } from "../../console";
import type { Outcome, PhotoJobView, PhotoRequest, PhotosView } from "../../protocol";
import { text } from "../../text/catalogue";
import { flightTime } from "../../text/flights";
import { Panel, Problem } from "../Panel";
import { PhotoSteps } from "./PhotoSteps";
import "./photos.css";

/** How often a running job is asked for. */
const EVERY_MS = 1_000;
const STORED_AS = "recon.photoFolders";

/** The photos of a flight: tags, gaps, mosaic and report, made by the station of a folder on its computer. */
export function PhotosPanel() {
  const { source, clock } = useStation();
  const [job, setJob] = createSignal<PhotoJobView | null>(null);
  const [problem, setProblem] = createSignal<string | null>(null);
  let stopAsking = () => {};
  let isClosed = false;
  const ask = async (asked: Promise<Outcome<PhotosView>>) => {
    const outcome = await asked;
    if (isClosed) return;
    setProblem(outcome.kind === "failed" ? outcome.problem : null);
    if (outcome.kind === "answered") setJob(outcome.value.job);
    stopAsking();
    if (isRunning()) stopAsking = clock.after(EVERY_MS, () => void ask(source.photos.view()));
  };
  const isRunning = () => job()?.state === "running";
  onMount(() => void ask(source.photos.view()));
  onCleanup(() => {
    isClosed = true;
    stopAsking();
  });
  return (
    <Panel title={text.panels.titles.photos} name="photos">
      <Show when={!isRunning()}>
        <PhotoForm
          isFirst={job() === null}
          isOpen={job()?.state !== "done"}
          onStart={(request) => ask(source.photos.start(request))}
        />
      </Show>
      <Problem text={problem()} />
      <Show when={job()}>
        {(shown) => (
          <section class="section" aria-label={text.photos.results(flightTime(shown().flight))}>
            <p class="wire-text">
              <strong>{text.photos.results(flightTime(shown().flight))}</strong>{" "}
              <span class="muted">{shown().folders.join(", ")}</span>
            </p>
            <PhotoSteps job={shown()} />
            <Show when={isRunning()}>
              <p class="muted">{text.photos.running}</p>
              <button type="button" class="button" onClick={() => void ask(source.photos.cancel())}>
                {text.photos.cancel}
              </button>
            </Show>
          </section>
        )}
      </Show>
    </Panel>
  );
}

/** Asks for a flight and the folders of its photos. */
function PhotoForm(props: {
  isFirst: boolean;
  isOpen: boolean;
  onStart: (request: PhotoRequest) => Promise<void>;
}) {
  const { source, lacks } = useStation();
  const { kept } = usePage();
  const [folders, setFolders] = createSignal(kept.getItem(STORED_AS) ?? "");
  const [dropped, setDropped] = createSignal<string | null>(null);
  const [isOver, setOver] = createSignal(false);
  const [isStarting, setStarting] = createSignal(false);
  const [flights] = createResource(() => source.flights.list());
  let form!: HTMLFormElement;
  const known = () => {
    const outcome = flights();
    return outcome?.kind === "answered" ? outcome.value : [];
  };
  const inTheAir = () => known().filter(({ name }) => !name.startsWith("ground-"));
  const lines = () =>
    folders()
      .split("\n")
      .flatMap((line) => line.trim() || []);
  const drop = (data: DataTransfer | null) => {
    const path = pathOf(data);
    if (path !== "") setFolders([...lines(), path].join("\n"));
    else setDropped(data?.files[0]?.name ?? null);
  };
  const start = async () => {
    kept.setItem(STORED_AS, folders());
    setStarting(true);
    await props.onStart({ ...numbersOf(new FormData(form)), folders: lines() });
    setStarting(false);
  };
  return (
    <form
      ref={form}
      class="section photo-form"
      classList={{ "is-over": isOver() }}
      onDragOver={(event) => {
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={() => setOver(false)}
      onDrop={(event) => {
        event.preventDefault();
        setOver(false);
        drop(event.dataTransfer);
      }}
      onSubmit={(event) => {
        event.preventDefault();
        void start();
      }}
    >
      <details open={props.isOpen}>
        <summary>{text.photos.title}</summary>
        <div class="photo-fields">
          <p class="muted">{text.photos.where}</p>
          <Show
            when={flights.loading || inTheAir().length > 0}
            fallback={<p>{text.photos.noFlights}</p>}
          >
            <label>
              {text.photos.flight}
              <select class="field" name="flight">
                <For each={inTheAir()}>
                  {({ name }) => <option value={name}>{flightTime(name)}</option>}
                </For>
              </select>
            </label>
            <label>
              {text.photos.folders}
              <textarea
                class="field"
                rows={2}
                spellcheck={false}
                placeholder={text.photos.example}
                value={folders()}
                onInput={(event) => setFolders(event.currentTarget.value)}
              />
            </label>
            <Show when={dropped()}>
              {(name) => (
                <p class="wire-text" role="status">
                  {text.photos.dropped(name())}
                </p>
              )}
            </Show>
            <details>
              <summary>{text.photos.camera}</summary>
              <div class="photo-camera">
                <label title={text.photos.clockHint}>
                  {text.photos.clockOffset}
                  <input class="field" name="clock_offset_s" type="number" step="any" />
                </label>
                <label title={text.photos.fieldHint}>
                  {text.photos.field}
                  <input
                    class="field"
                    name="field_deg"
                    type="number"
                    min="10"
                    max="120"
                    step="any"
                  />
                </label>
              </div>
            </details>
            <button
              type="submit"
              class="button"
              disabled={isStarting() || lines().length === 0 || lacks("operator") !== null}
              title={lacks("operator") ?? undefined}
            >
              {props.isFirst ? text.photos.start : text.photos.again}
            </button>
          </Show>
        </div>
      </details>
    </form>
  );
}

/** The flight and what is stated of its camera. */
function numbersOf(form: FormData): Omit<PhotoRequest, "folders"> {
  const number = (name: string) => {
    const typed = `${form.get(name) ?? ""}`.trim();
    return typed === "" ? null : Number(typed);
  };
  return {
    flight: `${form.get("flight") ?? ""}`,
    clock_offset_s: number("clock_offset_s"),
    field_deg: number("field_deg"),
  };
}

/** The path of something dropped, which only some browsers state; empty without one. */
function pathOf(data: DataTransfer | null): string {
  const [uri = ""] = (data?.getData("text/uri-list") ?? "").split(/\r?\n/);
  return uri.startsWith("file:///") ? decodeURIComponent(new URL(uri).pathname) : "";
}
