import { createSignal, For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { SurveyResponse } from "../../protocol";
import type { Outcome } from "../../source/stationSource";

const PLANNERS = [
  ["lawnmower_once", "all rows once"],
  ["lawnmower_again", "until all is in sun"],
] as const;

const WHEN_DONE = [
  ["return_home", "they fly home"],
  ["hover", "they hover"],
] as const;

/**
 * A survey of one of the site's regions. Nothing flies by it, so a plain press asks for it. Where there is
 * one already, those that fly matter more: then it is asked for behind a press.
 */
export function NewSurvey(props: {
  isFirst: boolean;
  onAnswer: (outcome: Outcome<SurveyResponse>) => void;
}) {
  const { source, fleet } = useConsole();
  const [isAsking, setAsking] = createSignal(false);
  const regions = () => (fleet.site?.areas ?? []).filter(({ kind }) => kind === "survey");
  const ask = async (form: HTMLFormElement) => {
    const said = new FormData(form);
    setAsking(true);
    const outcome = await source.askSurvey({
      region: String(said.get("region")),
      height_above_takeoff_m: Number(said.get("height")),
      speed_mps: Number(said.get("speed")),
      planner: String(said.get("planner")),
      when_done: said.get("when_done") === "hover" ? "hover" : "return_home",
    });
    setAsking(false);
    props.onAnswer(outcome);
  };
  return (
    <Show
      when={regions().length > 0}
      fallback={<p class="panel-empty">The site has no survey regions.</p>}
    >
      <details class="section survey-new" open={props.isFirst}>
        <summary>New survey</summary>
        <form
          class="survey-form"
          aria-label="New survey"
          onSubmit={(event) => {
            event.preventDefault();
            void ask(event.currentTarget);
          }}
        >
          <label class="survey-wide">
            Region
            <select name="region">
              <For each={regions()}>{({ name }) => <option value={name}>{name}</option>}</For>
            </select>
          </label>
          <label>
            Height above takeoff, m
            <input name="height" type="number" min={10} max={120} step={1} value={50} required />
          </label>
          <label>
            Speed, m/s
            <input name="speed" type="number" min={1} max={15} step={0.5} value={5} required />
          </label>
          <label class="survey-wide">
            Flies
            <select name="planner">
              <For each={PLANNERS}>{([name, words]) => <option value={name}>{words}</option>}</For>
            </select>
          </label>
          <label class="survey-wide">
            When nothing is left to fly
            <select name="when_done">
              <For each={WHEN_DONE}>{([name, words]) => <option value={name}>{words}</option>}</For>
            </select>
          </label>
          <button type="submit" class="button" disabled={isAsking()}>
            Plan rows
          </button>
        </form>
      </details>
    </Show>
  );
}
