import { createSignal, Index, Show } from "solid-js";
import { usePage, useStation } from "../../console";
import type { SurveyView } from "../../protocol";
import { text } from "../../text/catalogue";
import { formatArea, sharePercent, shownSurvey, surveyStatus, timeLeft } from "../../text/survey";
import { withLengthUnit } from "../../text/units";
import "./survey.css";

/** The shown survey in three lines, for a screen without room for its panel; a press opens the panel. */
export function SurveySummary() {
  const { fleet } = useStation();
  const { panels } = usePage();
  return (
    <Show when={shownSurvey(fleet.surveys)}>
      {(survey) => (
        <button
          type="button"
          class="card survey-summary"
          title={text.surveys.open}
          onClick={() => panels.open("survey")}
        >
          <span class="survey-head">
            <strong>{text.surveys.title}</strong>
            <span class="muted">{timeLeft(survey()) ?? surveyStatus(survey())}</span>
          </span>
          <Coverage survey={survey()} />
        </button>
      )}
    </Show>
  );
}

/** How much is in sun and what is left, in per cent and hectares. */
export function Coverage(props: { survey: SurveyView }) {
  return (
    <Show when={props.survey.figures}>
      {(figures) => {
        const percent = (area_m2: number) => sharePercent(area_m2, figures().region_m2);
        const parts = () =>
          [
            [text.surveys.inShade, percent(figures().in_shade_m2)],
            [text.surveys.lightUnknown, percent(figures().sun_unknown_m2)],
            [text.surveys.toFly, percent(figures().not_yet_m2)],
          ] as const;
        const others = () =>
          parts()
            .filter(([, share]) => share > 0)
            .map(([shareText, share]) => ` · ${shareText(share)}`)
            .join("");
        return (
          <>
            <span class="survey-bar" aria-hidden="true">
              <span class="is-sun" style={{ width: `${percent(figures().in_sun_m2)}%` }} />
              <span class="is-shade" style={{ width: `${percent(figures().in_shade_m2)}%` }} />
              <span class="is-unknown" style={{ width: `${percent(figures().sun_unknown_m2)}%` }} />
            </span>
            <span class="survey-figures">
              <strong>{text.surveys.inSun(percent(figures().in_sun_m2))}</strong>
              <span class="muted">
                {others()} · {formatArea(figures().region_m2)}
              </span>
            </span>
          </>
        );
      }}
    </Show>
  );
}

/** A drone, what it does, and a long reason for it that is shown on demand. */
export type DecisionLine = readonly [name: string, what: string, why?: string | null];

/** Why each drone does what it does; the first few, the others on demand. */
export function Decisions(props: { lines: readonly DecisionLine[] }) {
  const [isOpen, setOpen] = createSignal(false);
  const shown = () => (isOpen() ? props.lines : props.lines.slice(0, DECISIONS_SHOWN));
  return (
    <Show when={props.lines.length > 0}>
      <ul class="survey-decisions wire-text">
        {/* By place, so that an opened reason stays open while figures in it change. */}
        <Index each={shown()}>
          {(line) => (
            <li>
              <strong>{line()[0]}</strong> <span class="muted">{withLengthUnit(line()[1])}</span>
              <Show when={line()[2]}>
                {(why) => (
                  <details class="survey-why">
                    <summary>{text.surveys.why}</summary>
                    {withLengthUnit(why())}
                  </details>
                )}
              </Show>
            </li>
          )}
        </Index>
      </ul>
      <Show when={props.lines.length > DECISIONS_SHOWN}>
        <button type="button" class="button button-quiet" onClick={() => setOpen(!isOpen())}>
          {isOpen() ? text.surveys.fewer : text.surveys.allDrones(props.lines.length)}
        </button>
      </Show>
    </Show>
  );
}

const DECISIONS_SHOWN = 4;
