import { createResource, createSignal, For, Show } from "solid-js";
import { useOrders, usePage, useStation } from "../../console";
import { targetsKey } from "../../orders/targets";
import type { Outcome, SurveyingView, SurveyResponse, SurveyView } from "../../protocol";
import { text } from "../../text/catalogue";
import {
  formatArea,
  sharePercent,
  stoppedText,
  surveyHeight,
  surveyStatus,
  timeLeft,
} from "../../text/survey";
import { withLengthUnit } from "../../text/units";
import { BRIEF_MS, GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Panel, Problem } from "../Panel";
import { FlownRegions } from "./FlownRegions";
import { NewSurvey } from "./NewSurvey";
import { SurveyLight } from "./SurveyLight";
import { SurveyPreview } from "./SurveyPreview";
import { Coverage, type DecisionLine, Decisions } from "./SurveySummary";
import "./survey.css";

/** Surveys: plan, start with the selected vehicles, pause, abort; and their coverage. */
export function SurveyPanel() {
  const { fleet, source, isReplay } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  /** What flies, or may go on, comes before what is planned or over. */
  const surveys = () => {
    const rank = ({ phase }: SurveyView) => (phase === "running" ? 0 : phase === "paused" ? 1 : 2);
    return [...fleet.surveys].sort((a, b) => rank(a) - rank(b));
  };
  // Read again when a survey begins or ends: that changes what is left.
  const phases = () => `${fleet.surveys.map(({ id, phase }) => `${id} ${phase}`)}`;
  const [flown] = createResource(
    () => !isReplay() && phases(),
    () => source.surveys.flownRegions(),
  );
  const known = () => {
    const latest = flown.latest;
    return latest?.kind === "answered" ? latest.value : null;
  };
  const showProblem = (outcome: Outcome<SurveyResponse>) => setProblem(problemOf(outcome));
  return (
    <Panel title={text.panels.titles.survey} name="survey">
      <For each={surveys()}>
        {(survey) => <SurveySection survey={survey} onResult={showProblem} />}
      </For>
      <Problem text={problem()} />
      <Show when={!isReplay()}>
        <Show when={known()}>
          {(found) => <FlownRegions known={found()} onResult={showProblem} />}
        </Show>
        <NewSurvey
          isFirst={fleet.surveys.length === 0}
          flown={(known()?.regions ?? []).map(({ region }) => region)}
          onResult={showProblem}
        />
      </Show>
    </Panel>
  );
}

/** Why a survey request failed; null if it was accepted. */
export function problemOf(outcome: Outcome<SurveyResponse>): string | null {
  if (outcome.kind === "failed") return outcome.problem;
  return outcome.value.accepted
    ? null
    : withLengthUnit(outcome.value.reason ?? text.surveys.noReason);
}

interface SurveyProps {
  survey: SurveyView;
  onResult: (outcome: Outcome<SurveyResponse>) => void;
}

function SurveySection(props: SurveyProps) {
  const { panels } = usePage();
  const is = (...phases: SurveyView["phase"][]) => phases.includes(props.survey.phase);
  /** Vehicles to list; of a finished survey only those still returning home. */
  const active = () =>
    props.survey.vehicles.filter(
      ({ not_flying_reason }) => !is("done", "aborted") || not_flying_reason !== null,
    );
  /** Nothing where it only repeats the status; a round's number means nothing to an operator. */
  const reason = () => {
    const status = surveyStatus(props.survey);
    const shown = props.survey.reason.replace(`${status}: `, "");
    const isRepeated = is("created") || shown.toLowerCase() === status.toLowerCase();
    return isRepeated || /^round \d+$/.test(shown) ? "" : shown;
  };
  const { source } = useStation();
  const line = (vehicle: SurveyingView) =>
    lineOf(vehicle, is("done"), source.person()?.name ?? null);
  return (
    <section class="section" data-testid={`survey-${props.survey.id}`}>
      <p class="survey-head wire-text">
        <strong>{props.survey.name}</strong>
        <span class="muted">{timeLeft(props.survey)}</span>
      </p>
      <p class="wire-text">
        {surveyStatus(props.survey)}
        <Show when={reason()}>{(why) => <span class="muted">: {withLengthUnit(why())}</span>}</Show>
      </p>
      <p class="muted wire-text">
        {[surveyHeight(props.survey), withLengthUnit(props.survey.rows_note)]
          .filter((line) => line !== "")
          .join(" · ")}
      </p>
      <Coverage survey={props.survey} />
      <Show when={is("running", "paused") && notShown(props.survey)}>
        {(line) => <p class="muted wire-text">{line()}</p>}
      </Show>
      <Show when={props.survey.light}>{(light) => <SurveyLight light={light()} />}</Show>
      <Decisions lines={active().map(line)} />
      <Show when={is("created")}>
        <SurveyPreview survey={props.survey} />
      </Show>
      <Show when={is("created", "paused", "running")}>
        <Start survey={props.survey} onResult={props.onResult} />
      </Show>
      <div class="section-buttons">
        <Show when={is("running")}>
          <Stop survey={props.survey} onResult={props.onResult} word="pause" />
        </Show>
        <Show when={is("created", "running", "paused")}>
          <Stop survey={props.survey} onResult={props.onResult} word="abort" />
        </Show>
        <Show when={is("done", "aborted")}>
          <button type="button" class="button" onClick={() => panels.open("photos")}>
            {text.photos.open}
          </button>
        </Show>
        <Show when={is("done") && active().length > 0}>
          <Stop survey={props.survey} onResult={props.onResult} word="hold" />
        </Show>
      </div>
    </section>
  );
}

/** How much of the region shade maps do not show; null while that is less than one per cent. */
function notShown({ figures }: SurveyView): string | null {
  if (figures === null) return null;
  const percent = sharePercent(figures.not_shown_m2, figures.region_m2);
  return percent > 0 ? text.surveys.notShown(formatArea(figures.not_shown_m2), percent) : null;
}

/** A drone and what it does for the survey, with the reason; `person` reads it. */
function lineOf(vehicle: SurveyingView, isDone: boolean, person: string | null): DecisionLine {
  if (vehicle.waits_for !== null && vehicle.not_flying_reason === null)
    return [vehicle.vehicle_name, text.surveys.waitsFor(vehicle.waits_for), vehicle.refused];
  const idle = isDone ? text.surveys.returnsHome : text.surveys.noRows;
  const activity = vehicle.is_flying_rows ? text.surveys.fliesRows : idle;
  const why = vehicle.not_flying_reason ?? vehicle.refused ?? vehicle.decision;
  if (why === null) return [vehicle.vehicle_name, activity];
  const stopped = stoppedText(why, person);
  if (stopped !== null) return [vehicle.vehicle_name, stopped];
  // A decision begins with what is flown; a reason stands beside it.
  return [vehicle.vehicle_name, why === vehicle.decision ? why : `${activity}: ${why}`];
}

const START_LABELS: Partial<Record<SurveyView["phase"], string>> = {
  running: text.surveys.add,
  paused: text.surveys.resume,
};

/** Starts a survey with the selected vehicles, or adds them to it. */
function Start(props: SurveyProps) {
  const { source } = useStation();
  const { targets } = useOrders();
  const [allowTakeoff, setAllowTakeoff] = createSignal(false);
  const label = () => START_LABELS[props.survey.phase] ?? text.surveys.start;
  const start = async () => {
    const { serials } = targets();
    props.onResult(await source.surveys.start(props.survey.id, serials, allowTakeoff()));
    setAllowTakeoff(false);
  };
  const subject = () =>
    targets().serials.length === 0 ? "" : `${targetsKey(targets())} ${allowTakeoff()}`;
  return (
    <>
      <label class="survey-takeoff">
        <input
          type="checkbox"
          checked={allowTakeoff()}
          onChange={(event) => setAllowTakeoff(event.currentTarget.checked)}
        />
        {text.surveys.allowTakeoff}
      </label>
      <GuardButton
        label={label()}
        of={[...targets().labels, text.surveys.name(props.survey.name)].join(", ")}
        hold_ms={GUARD_MS}
        subject={subject()}
        onConfirm={() => void start()}
      />
    </>
  );
}

/** Pauses or aborts; aborting a finished survey holds its vehicles returning home. */
function Stop(props: SurveyProps & { word: keyof typeof text.surveys.stops }) {
  const { source } = useStation();
  const word = () => (props.word === "hold" ? "abort" : props.word);
  const stop = async () => props.onResult(await source.surveys.stop(props.survey.id, word()));
  const label = () => text.surveys.stops[props.word];
  return (
    <GuardButton
      label={label()}
      of={text.surveys.name(props.survey.name)}
      needs="pilot"
      class={props.word === "abort" ? "guard-grave" : ""}
      // A pause is safe and reversible; an abort is final.
      hold_ms={props.word === "abort" ? GUARD_MS : BRIEF_MS}
      subject={`${props.survey.id}`}
      onConfirm={() => void stop()}
    />
  );
}
