import { createMemo, createResource, createSignal, For, onCleanup, Show } from "solid-js";
import { usePage, useStation } from "../../console";
import type { FlownRegionView, Outcome, PhotoFile, PhotoJobView, Picture } from "../../protocol";
import { valuesOf } from "../../protocol/values";
import { saveAs } from "../../source/saveAs";
import { text } from "../../text/catalogue";
import { clockLine, inPanelWords, mosaicText, stepState } from "../../text/photos";
import { formatArea } from "../../text/survey";
import { Problem } from "../Panel";
import { SeverityMark } from "../SeverityMark";
import { problemOf } from "../survey/SurveyPanel";

const FILES = valuesOf(text.photos.files);
type Step = PhotoJobView["steps"][number];

/** The steps of a job, each with a mark and what it has found. */
export function PhotoSteps(props: { job: PhotoJobView }) {
  const has = (file: PhotoFile) => props.job.files.includes(file);
  return (
    <>
      <ol class="list photo-steps">
        <For each={props.job.steps}>
          {(step) => (
            <li data-testid={`photo-${step.name}`}>
              <p class="photo-step">
                <StepMark step={step} />
                <strong>{text.photos.steps[step.name]}</strong>
                <Show when={step.state !== "done"}>
                  <span class="muted push">{stepState(step, props.job)}</span>
                </Show>
              </p>
              <StepResult step={step.name} job={props.job} />
              <Show when={step.problem}>
                {(problem) => <p class="wire-text">{inPanelWords(problem())}</p>}
              </Show>
            </li>
          )}
        </For>
      </ol>
      <Show when={props.job.warnings.length > 0}>
        <details class="photo-notes">
          <summary>{text.photos.warnings(props.job.warnings.length)}</summary>
          <ul class="list">
            <For each={props.job.warnings}>{(line) => <li class="wire-text">{line}</li>}</For>
          </ul>
        </details>
      </Show>
      <SavedFiles flight={props.job.flight} files={FILES.filter(has)} />
      <p class="muted wire-text">{text.photos.out(props.job.out)}</p>
    </>
  );
}

function StepMark(props: { step: Step }) {
  const isOver = () => props.step.state === "done" || props.step.state === "failed";
  const severity = () => (props.step.state === "done" ? null : "error");
  return (
    <Show
      when={isOver()}
      fallback={<span class={`photo-mark photo-${props.step.state}`} aria-hidden="true" />}
    >
      <span class={severity() === null ? "tone-good" : "tone-error"}>
        <SeverityMark severity={severity()} />
      </span>
    </Show>
  );
}

function StepResult(props: { step: Step["name"]; job: PhotoJobView }) {
  const is = (name: Step["name"]) => props.step === name;
  return (
    <>
      <Show when={is("clock")}>
        <For each={props.job.clocks.map(clockLine)}>
          {([camera, offset]) => (
            <p class="wire-text">
              <span class="muted">{camera}:</span> {offset}
            </p>
          )}
        </For>
      </Show>
      <Show when={is("tags") && props.job.counts}>
        {(counts) => (
          <p>
            {text.photos.inSun(counts().sunlit, counts().photos)}
            <span class="muted">
              {" · "}
              {text.photos.otherLight(counts().mixed, counts().shaded, counts().unknown)}
            </span>
          </p>
        )}
      </Show>
      <Show when={is("gaps") && props.job.gaps}>
        {(gaps) => (
          <Show when={gaps().regions > 0} fallback={<p>{text.photos.noGaps}</p>}>
            <p>{text.photos.gaps(formatArea(gaps().area_m2), gaps().regions)}</p>
            <Show when={props.job.files.includes("fly-again.geojson")}>
              <FlyGaps />
            </Show>
          </Show>
        )}
      </Show>
      <Show when={is("mosaic") && props.job.mosaic}>
        {(mosaic) => <p>{mosaicText(mosaic())}</p>}
      </Show>
      <Show when={is("mosaic") && props.job.files.includes("mosaic.png")}>
        <MosaicPicture />
      </Show>
    </>
  );
}

/** A button for each surveyed region with gaps: plans them on its rows, and opens the panel to start it in. */
function FlyGaps() {
  const { source, lacks } = useStation();
  const { panels } = usePage();
  const [flown] = createResource(() => source.surveys.flownRegions());
  const [answer, setAnswer] = createSignal<{ problem: string | null } | null>(null);
  const [isPlanning, setPlanning] = createSignal(false);
  /** The one flown last of each region comes first. */
  const regions = () => {
    const outcome = flown();
    if (outcome?.kind !== "answered") return [];
    const found = outcome.value.regions.filter(
      ({ gaps_m2, refusal }) => refusal === null && (gaps_m2 ?? 0) > 0,
    );
    return [...new Map(found.reverse().map((each) => [each.region, each])).values()].reverse();
  };
  const plan = async ({ id }: FlownRegionView) => {
    setPlanning(true);
    const asked = { id, since: null, all_again: false, gaps: true };
    const problem = problemOf(await source.surveys.again(asked));
    setPlanning(false);
    setAnswer({ problem });
    if (problem === null) panels.open("survey");
  };
  return (
    <>
      <Show
        when={flown.loading || regions().length > 0}
        fallback={<p class="muted">{text.photos.noRegion}</p>}
      >
        <div class="section-buttons">
          <For each={regions()}>
            {(region) => (
              <button
                type="button"
                class="button"
                disabled={isPlanning() || lacks("operator") !== null}
                title={lacks("operator") ?? text.photos.flyHint}
                onClick={() => void plan(region)}
              >
                {regions().length === 1
                  ? text.photos.flyGaps
                  : text.photos.flyGapsOf(region.region)}
              </button>
            )}
          </For>
        </div>
      </Show>
      <Problem text={answer()?.problem ?? null} />
      <Show when={answer()?.problem === null}>
        <p role="status">{text.photos.planned}</p>
      </Show>
    </>
  );
}

function MosaicPicture() {
  const { source } = useStation();
  const [picture] = createResource(() => source.photos.file("mosaic.png"));
  const url = createMemo(() => {
    const outcome = picture();
    if (outcome?.kind !== "answered") return null;
    const made = URL.createObjectURL(outcome.value.blob);
    onCleanup(() => URL.revokeObjectURL(made));
    return made;
  });
  return (
    <Show when={url()}>
      {(src) => <img class="photo-mosaic" src={src()} alt={text.photos.mosaicPicture} />}
    </Show>
  );
}

/** Buttons that save what the job has made. */
function SavedFiles(props: { flight: string; files: readonly (typeof FILES)[number][] }) {
  const { source } = useStation();
  const [saved, setSaved] = createSignal<Outcome<Picture> | null>(null);
  const save = async (file: PhotoFile) => {
    const outcome = await source.photos.file(file);
    setSaved(outcome);
    if (outcome.kind === "answered") saveAs(outcome.value.blob, `${props.flight}-${file}`);
  };
  const problem = () => {
    const outcome = saved();
    return outcome?.kind === "failed" ? outcome.problem : null;
  };
  return (
    <>
      <div class="section-buttons photo-files">
        <For each={props.files}>
          {(file) => (
            <button
              type="button"
              class="button"
              title={file === "report.html" ? text.photos.reportHint : undefined}
              onClick={() => void save(file)}
            >
              {text.photos.files[file]}
            </button>
          )}
        </For>
      </div>
      <Problem text={problem()} />
    </>
  );
}
