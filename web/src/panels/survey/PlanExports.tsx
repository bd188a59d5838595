import { createResource, createSignal, For, Show } from "solid-js";
import { useOrders, useStation } from "../../console";
import { targetsKey } from "../../orders/targets";
import type { PlanAircraftView, PlanFormatView, SurveyView } from "../../protocol";
import { saveAs } from "../../source/saveAs";
import type { NamedAircraft } from "../../source/surveyRequests";
import { text } from "../../text/catalogue";
import { Problem } from "../Panel";

/** The flights of a planned survey as files that other programs fly. */
export function PlanExports(props: { survey: SurveyView }) {
  const [isOpen, setOpen] = createSignal(false);
  return (
    <div class="survey-exports">
      <button
        type="button"
        class="button button-quiet"
        aria-expanded={isOpen()}
        onClick={() => setOpen(!isOpen())}
      >
        {text.exports.name}
      </button>
      <Show when={isOpen()}>
        <Formats survey={props.survey} />
      </Show>
    </div>
  );
}

function Formats(props: { survey: SurveyView }) {
  const { source } = useStation();
  const { targets } = useOrders();
  const [chosen, setChosen] = createSignal<NamedAircraft | null>(null);
  const [problem, setProblem] = createSignal<string | null>(null);
  const serials = () => targets().serials;
  const key = () => `${props.survey.id} ${targetsKey(targets())} ${labelOf(chosen())}`;
  // By key, as the selection is a new object with every state.
  const [outcome] = createResource(key, () =>
    source.surveys.exports(props.survey.id, serials(), chosen()),
  );
  const answer = () => (outcome.latest?.kind === "answered" ? outcome.latest.value : null);
  const failure = () => (outcome.latest?.kind === "failed" ? outcome.latest.problem : null);
  const choices = () => (answer()?.aircraft ?? []).flatMap(choicesOf);
  const save = async (format: PlanFormatView) => {
    const id = props.survey.id;
    const got = await source.surveys.planFile(id, format.kind, serials(), chosen());
    setProblem(got.kind === "failed" ? got.problem : null);
    if (got.kind !== "answered") return;
    saveAs(got.value.blob, `survey-${id}.${format.kind}${format.files > 1 ? ".zip" : ""}`);
  };
  return (
    <div class="survey-formats" data-testid={`exports-${props.survey.id}`}>
      <p class="muted">{text.exports.unwatched}</p>
      <Problem text={failure() ?? problem()} />
      <label>
        {text.exports.aircraft}
        <select
          value={labelOf(chosen())}
          onChange={(event) => {
            const label = event.currentTarget.value;
            setChosen(choices().find((each) => labelOf(each) === label) ?? null);
          }}
        >
          <option value="">{text.exports.choose}</option>
          <For each={choices().map(labelOf)}>
            {(label) => <option value={label}>{label}</option>}
          </For>
        </select>
      </label>
      <For each={answer()?.formats}>{(format) => <Format format={format} save={save} />}</For>
    </div>
  );
}

function Format(props: { format: PlanFormatView; save: (format: PlanFormatView) => void }) {
  return (
    <div class="survey-format">
      <button
        type="button"
        class="button"
        disabled={props.format.refusal !== null}
        onClick={() => props.save(props.format)}
      >
        {text.exports.save(props.format.title, props.format.kind)}
      </button>
      <Show when={props.format.refusal}>{(why) => <p class="muted wire-text">{why()}</p>}</Show>
      <Show when={props.format.by_hand.length > 0}>
        <details>
          <summary>{text.exports.byHand(props.format.by_hand.length)}</summary>
          <ul>
            <For each={props.format.by_hand}>{(each) => <li class="wire-text">{each}</li>}</For>
          </ul>
        </details>
      </Show>
    </div>
  );
}

function choicesOf({ name, payloads }: PlanAircraftView): NamedAircraft[] {
  if (payloads.length === 0) return [{ aircraft: name, payload: null }];
  return payloads.map((payload) => ({ aircraft: name, payload }));
}

function labelOf(chosen: NamedAircraft | null): string {
  if (chosen === null) return "";
  return chosen.payload === null ? chosen.aircraft : `${chosen.aircraft}, ${chosen.payload}`;
}
