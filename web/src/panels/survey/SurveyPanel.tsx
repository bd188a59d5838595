import { createSignal, For, Show } from "solid-js";
import { useConsole } from "../../console";
import { targetsKey } from "../../orders/targets";
import type { SurveyingView, SurveyResponse, SurveyView } from "../../protocol";
import type { Outcome } from "../../source/stationSource";
import { listNames } from "../../text/names";
import { formatArea, PHASES, sharePercent } from "../../text/survey";
import { BRIEF_MS, GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Panel, Problem } from "../Panel";
import { NewSurvey } from "./NewSurvey";
import "./survey.css";

/** Surveys: planned here, started with the selected vehicles, paused, aborted; and their figures. */
export function SurveyPanel() {
  const { fleet } = useConsole();
  const [problem, setProblem] = createSignal<string | null>(null);
  const said = (outcome: Outcome<SurveyResponse>) => setProblem(problemOf(outcome));
  return (
    <Panel title="Surveys" count={fleet.surveys.length}>
      <For each={fleet.surveys}>{(survey) => <One survey={survey} onAnswer={said} />}</For>
      <Problem text={problem()} />
      <NewSurvey isFirst={fleet.surveys.length === 0} onAnswer={said} />
    </Panel>
  );
}

/** Why a word on a survey came to nothing; null when it was taken. */
export function problemOf(outcome: Outcome<SurveyResponse>): string | null {
  if (outcome.kind === "failed") return outcome.problem;
  return outcome.value.accepted ? null : (outcome.value.reason ?? "refused without a reason");
}

interface Part {
  survey: SurveyView;
  onAnswer: (outcome: Outcome<SurveyResponse>) => void;
}

function One(props: Part) {
  const is = (...phases: SurveyView["phase"][]) => phases.includes(props.survey.phase);
  /** Of a survey that is done, those still on their way home. */
  const busy = () =>
    props.survey.vehicles.filter(({ waits_for }) => !is("done", "aborted") || waits_for !== null);
  return (
    <section class="section" data-testid={`survey-${props.survey.id}`}>
      <p class="wire-text">
        <strong>
          {props.survey.id} {props.survey.name}
        </strong>{" "}
        {PHASES[props.survey.phase]}
        <span class="muted survey-reason">{props.survey.reason}</span>
      </p>
      <Figures survey={props.survey} />
      <For each={busy()}>
        {(vehicle) => <Surveying vehicle={vehicle} isDone={props.survey.phase === "done"} />}
      </For>
      <Show when={is("created", "paused", "running")}>
        <Start survey={props.survey} onAnswer={props.onAnswer} />
      </Show>
      <div class="section-buttons">
        <Show when={is("running")}>
          <Stop survey={props.survey} onAnswer={props.onAnswer} word="pause" />
        </Show>
        <Show when={is("created", "running", "paused")}>
          <Stop survey={props.survey} onAnswer={props.onAnswer} word="abort" />
        </Show>
        <Show when={is("done") && busy().length > 0}>
          <Stop survey={props.survey} onAnswer={props.onAnswer} word="hold" />
        </Show>
      </div>
    </section>
  );
}

function Figures(props: { survey: SurveyView }) {
  return (
    <Show when={props.survey.figures}>
      {(figures) => {
        const percent = (area_m2: number) => sharePercent(area_m2, figures().region_m2);
        const text = () =>
          `in sun ${percent(figures().in_sun_m2)} %, in shade ${percent(figures().in_shade_m2)} %, ` +
          `not yet ${formatArea(figures().not_yet_m2)} of ${formatArea(figures().region_m2)}`;
        return (
          <>
            <div class="survey-bar" role="img" aria-label={text()}>
              <span class="is-sun" style={{ width: `${percent(figures().in_sun_m2)}%` }} />
              <span class="is-shade" style={{ width: `${percent(figures().in_shade_m2)}%` }} />
            </div>
            <p>{text()}</p>
            <Show when={figures().sun_unknown_m2 > 0}>
              <p class="muted">
                in light that nobody knows: {formatArea(figures().sun_unknown_m2)}
              </p>
            </Show>
          </>
        );
      }}
    </Show>
  );
}

function Surveying(props: { vehicle: SurveyingView; isDone: boolean }) {
  const waits = () => (props.isDone ? "is on its way home" : "flies no row now");
  const does = () => (props.vehicle.is_flying_rows ? "flies rows" : waits());
  return (
    <p class="wire-text">
      <strong>{props.vehicle.vehicle_name}</strong> {does()}
      <Show when={props.vehicle.waits_for ?? props.vehicle.refused}>
        {(why) => <span class="muted survey-reason">{why()}</span>}
      </Show>
    </p>
  );
}

/** Held for as long as whatever sets aircraft in motion; whom it names is on it. */
function Start(props: Part) {
  const { source, targets } = useConsole();
  const [mayTakeOff, setMayTakeOff] = createSignal(false);
  const isAgain = () => props.survey.phase === "running";
  const label = () => (isAgain() ? "Let selected join" : "Start with selected");
  const start = async () => {
    const { serials } = targets();
    props.onAnswer(await source.startSurvey(props.survey.id, serials, mayTakeOff()));
    setMayTakeOff(false);
  };
  const subject = () =>
    targets().serials.length === 0 ? "" : `${targetsKey(targets())} ${mayTakeOff()}`;
  return (
    <>
      <label class="survey-takeoff">
        <input
          type="checkbox"
          checked={mayTakeOff()}
          onChange={(event) => setMayTakeOff(event.currentTarget.checked)}
        />
        they may take off, once
      </label>
      <GuardButton
        label={label()}
        name={`${label()}: ${listNames(targets().labels)}, survey ${props.survey.name}`}
        hold_ms={GUARD_MS}
        subject={subject()}
        onConfirm={() => void start()}
      />
    </>
  );
}

const STOPS = { pause: "Pause", abort: "Abort", hold: "Hold those going home" } as const;

/** A survey that is done stays so: then the word to abort holds its vehicles on their way home. */
function Stop(props: Part & { word: keyof typeof STOPS }) {
  const { source } = useConsole();
  const word = () => (props.word === "hold" ? "abort" : props.word);
  const stop = async () => props.onAnswer(await source.stopSurvey(props.survey.id, word()));
  const label = () => STOPS[props.word];
  return (
    <GuardButton
      label={label()}
      name={`${label()} survey ${props.survey.name}`}
      class={props.word === "abort" ? "guard-grave" : ""}
      // A pause holds, which is safe; what is aborted never flies again.
      hold_ms={props.word === "abort" ? GUARD_MS : BRIEF_MS}
      subject={`${props.survey.id}`}
      onConfirm={() => void stop()}
    />
  );
}
