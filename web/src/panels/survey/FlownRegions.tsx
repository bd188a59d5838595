import { createSignal, For, Show } from "solid-js";
import { useStation } from "../../console";
import type { FlownRegionsView, FlownRegionView, Outcome, SurveyResponse } from "../../protocol";
import { text } from "../../text/catalogue";
import {
  dayText,
  flownText,
  isUnfinished,
  type LeftOut,
  left_m2,
  leftText,
} from "../../text/flown";
import { formatDay } from "../../text/replay";
import { surveyHeight } from "../../text/survey";
import { withLengthUnit } from "../../text/units";

/** Regions that were flown, on any day: how much is left of each, and a button that plans it. */
export function FlownRegions(props: {
  known: FlownRegionsView;
  onResult: (outcome: Outcome<SurveyResponse>) => void;
}) {
  const { fleet } = useStation();
  /** A region whose survey is not over is resumed there. */
  const alive = () =>
    fleet.surveys.filter(({ phase }) => ["created", "running", "paused"].includes(phase));
  const regions = () =>
    props.known.regions.filter(
      ({ region, days }) => days.length > 0 && !alive().some((survey) => survey.region === region),
    );
  const isAnyUnfinished = () => regions().some(isUnfinished);
  return (
    <Show when={regions().length > 0}>
      <details class="section survey-new" open={isAnyUnfinished() && alive().length === 0}>
        <summary>{isAnyUnfinished() ? text.flown.title : text.flown.titleNone}</summary>
        <For each={regions()}>
          {(region) => (
            <Region region={region} today={props.known.today} onResult={props.onResult} />
          )}
        </For>
      </details>
    </Show>
  );
}

function Region(props: {
  region: FlownRegionView;
  today: string;
  onResult: (outcome: Outcome<SurveyResponse>) => void;
}) {
  const { source, lacks } = useStation();
  const [leftOut, setLeftOut] = createSignal<LeftOut>(
    isUnfinished(props.region) ? "begun" : "none",
  );
  const [isPlanning, setPlanning] = createSignal(false);
  const plan = async () => {
    const chosen = leftOut();
    setPlanning(true);
    const outcome = await source.surveys.again({
      id: props.region.id,
      since: typeof chosen === "object" ? chosen.since : null,
      all_again: chosen === "none",
      gaps: false,
    });
    setPlanning(false);
    props.onResult(outcome);
  };
  const isRest = () => leftOut() !== "none";
  const isNothingLeft = () => left_m2(props.region, leftOut()) < 1;
  const label = () => (isRest() ? text.flown.resumeOf : text.flown.againOf)(props.region.region);
  const facts = () => [
    flownText(props.region, props.today),
    surveyHeight(props.region),
    ...(props.region.is_simulated ? [text.flown.simulated] : []),
  ];
  return (
    <div class="survey-form flown-region" data-testid={`flown-${props.region.id}`}>
      <p class="survey-head survey-wide wire-text">
        <strong>{props.region.region}</strong>
        <span class="muted">{leftText(props.region, leftOut())}</span>
      </p>
      <p class="survey-wide muted wire-text">{facts().join(" · ")}</p>
      <For each={[props.region.refusal ?? props.region.changes].flat()}>
        {(change) => <p class="survey-wide survey-warning wire-text">{withLengthUnit(change)}</p>}
      </For>
      <Show when={props.region.refusal === null}>
        <label class="survey-wide">
          {text.flown.leaveOut}
          <select onChange={(event) => setLeftOut(asLeftOut(event.currentTarget.value))}>
            <For each={choices(props.region, props.today)}>
              {([value, words]) => (
                <option value={value} selected={value === optionOf(leftOut())}>
                  {words}
                </option>
              )}
            </For>
          </select>
        </label>
        <button
          type="button"
          class="button"
          disabled={isPlanning() || isNothingLeft() || lacks("operator") !== null}
          title={lacks("operator") ?? text.flown.sameRows}
          aria-label={label()}
          onClick={() => void plan()}
        >
          {isRest() ? text.flown.resume : text.flown.again}
        </button>
      </Show>
    </div>
  );
}

/** What may be left out, as value and words: since it was begun, each flown day, nothing. */
function choices(region: FlownRegionView, today: string): (readonly [string, string])[] {
  const begun = formatDay(1000 * region.begun_unix_s);
  const others = region.days.filter(({ day }) => dayText(day, "") !== begun);
  const days = others.map(({ day }) => {
    const words = day === today ? text.flown.sinceToday : text.flown.sinceDay(dayText(day, today));
    return [day, words] as const;
  });
  return [["begun", text.flown.sinceBegun(begun)], ...days, ["none", text.flown.nothing]];
}

function asLeftOut(value: string): LeftOut {
  return value === "begun" || value === "none" ? value : { since: value };
}

function optionOf(leftOut: LeftOut): string {
  return typeof leftOut === "object" ? leftOut.since : leftOut;
}
