import { createMemo, createResource, createSignal, For, Show } from "solid-js";
import { usePage, useStation } from "../../console";
import type { NewSurvey as NewSurveyRequest, Outcome, SurveyResponse } from "../../protocol";
import { valuesOf } from "../../protocol/values";
import { text } from "../../text/catalogue";
import { vehicleLabel } from "../../text/names";
import { inLengthUnit, lengthUnit } from "../../text/units";
import { DraftEstimate } from "./DraftEstimate";
import { isRehearsal, Rehearse } from "./Rehearse";
import { createSurveyFigures, HIGHEST_M, LOWEST_M, type SurveyFigures } from "./surveyFigures";
import { FASTEST_MPS } from "./surveyNumbers";

/** The station's own planners, each under the name that a request has. */
const PLANNERS: readonly string[] = valuesOf(text.newSurvey.planners);
/** Their labels; planners of installed packages have their name alone. */
const PLANNER_LABELS: Readonly<Record<string, string>> = text.newSurvey.planners;
/** The planner of a site without an imaging drone: no shade is known there. */
const ANY_LIGHT = "lawnmower_once";
/** Where the rows of a region lie that was flown before. */
const LINES = valuesOf(text.flown.lineChoices);
const WHEN_DONE = valuesOf(text.newSurvey.thenDo);

/**
 * Form to plan a survey of a site region. Planning moves nothing, so a plain press suffices. Collapsed once
 * there is a survey, since running surveys matter more.
 */
export function NewSurvey(props: {
  isFirst: boolean;
  /** Names of the regions that were flown before. */
  flown: readonly string[];
  onResult: (outcome: Outcome<SurveyResponse>) => void;
}) {
  const { fleet } = useStation();
  const { panels } = usePage();
  // What is to be pressed first stands alone.
  const isFirstForm = () => props.isFirst && !isRehearsal(fleet);
  // A form that a person has opened or closed stays so: drones that come and go fold nothing away.
  const [chosen, choose] = createSignal<boolean | null>(null);
  const isOpen = () => chosen() ?? isFirstForm();
  const regions = () => (fleet.site?.areas ?? []).filter(({ kind }) => kind === "survey");
  return (
    <Show
      when={regions().length > 0}
      fallback={
        <>
          <p class="panel-empty">{text.newSurvey.noRegions}</p>
          <button type="button" class="button" onClick={() => panels.open("site")}>
            {text.newSurvey.draw}
          </button>
        </>
      }
    >
      <Show when={props.isFirst && isRehearsal(fleet)}>
        <Rehearse region={regions()[0]?.name ?? ""} onResult={props.onResult} />
      </Show>
      <details
        class="section survey-new"
        open={isOpen()}
        onToggle={({ currentTarget: { open } }) => open !== isOpen() && choose(open)}
      >
        <summary>{text.newSurvey.title}</summary>
        <Form
          regions={regions().map(({ name }) => name)}
          flown={props.flown}
          isOpen={isOpen()}
          onResult={props.onResult}
        />
      </details>
    </Show>
  );
}

function Form(props: {
  regions: readonly string[];
  flown: readonly string[];
  isOpen: boolean;
  onResult: (outcome: Outcome<SurveyResponse>) => void;
}) {
  const { source, fleet, lacks } = useStation();
  const { kept } = usePage();
  const [isPlanning, setPlanning] = createSignal(false);
  const [changes, setChanges] = createSignal(0);
  let form!: HTMLFormElement;
  const [cameras] = createResource(async () => {
    const outcome = await source.surveys.cameras();
    return outcome.kind === "answered" ? outcome.value : [];
  });
  const own = () =>
    new Set(fleet.vehicles.filter(({ is_imager }) => !is_imager).map(({ camera }) => camera));
  const figures = createSurveyFigures({
    cameras: () => cameras() ?? [],
    usualCamera: () => (own().size === 1 ? ([...own()][0] ?? "") : ""),
    fastest_mps: () => fleet.site?.limits.max_speed_mps ?? FASTEST_MPS,
    kept,
  });
  const request = (): NewSurveyRequest | null => {
    const asked = figures.asked();
    return asked === null ? null : { ...asked, ...choicesOf(new FormData(form)) };
  };
  const draft = createMemo(() => {
    changes();
    const isAsked = props.isOpen && lacks("operator") === null && cameras.state === "ready";
    // The numbers are read here too: the form's own fields are no signals.
    return isAsked && figures.asked() !== null ? request() : null;
  });
  const plan = async () => {
    const survey = request();
    if (survey === null) return;
    setPlanning(true);
    const outcome = await source.surveys.plan(survey);
    setPlanning(false);
    props.onResult(outcome);
  };
  return (
    <form
      ref={form}
      class="survey-form"
      aria-label={text.newSurvey.title}
      onInput={() => setChanges(changes() + 1)}
      onSubmit={(event) => {
        event.preventDefault();
        void plan();
      }}
    >
      <label class="survey-wide">
        {text.newSurvey.region}
        <select name="region">
          <For each={props.regions}>{(name) => <option value={name}>{name}</option>}</For>
        </select>
      </label>
      <label class="survey-wide">
        {text.newSurvey.camera}
        <select name="camera" onChange={(event) => figures.chooseCamera(event.currentTarget.value)}>
          <option value="">{text.newSurvey.otherCamera}</option>
          <For each={cameras()}>
            {({ name, title }) => (
              <option value={name} selected={name === figures.camera()?.name}>
                {title}
              </option>
            )}
          </For>
        </select>
      </label>
      <Numbers figures={figures} />
      <DraftEstimate survey={draft()} />
      <Choices isAnyFlown={props.flown.length > 0} />
      <button
        type="submit"
        class="button"
        disabled={isPlanning() || lacks("operator") !== null}
        title={lacks("operator") ?? undefined}
      >
        {text.newSurvey.plan}
      </button>
    </form>
  );
}

/** Pixel and overlap first; what follows from them below, where it can be changed too. */
function Numbers(props: { figures: SurveyFigures }) {
  const { fleet } = useStation();
  const figures = props.figures;
  const isGroundKnown = () => fleet.site?.terrain === "model";
  return (
    <>
      <NumberField
        label={text.newSurvey.pixel}
        value={figures.pixel()}
        onType={figures.typePixel}
        range={[0.01, 100, 0.01]}
        isFixed={figures.pixel() === ""}
        placeholder={text.newSurvey.unknown}
      />
      <NumberField
        label={text.newSurvey.bearing}
        value={figures.bearing[0]()}
        onType={figures.bearing[1]}
        range={[0, 360, 1]}
        placeholder={text.newSurvey.best}
      />
      <NumberField
        label={text.newSurvey.front}
        value={figures.front[0]()}
        onType={figures.front[1]}
        range={[0, 95, 1]}
      />
      <NumberField
        label={text.newSurvey.side}
        value={figures.sideways[0]()}
        onType={figures.sideways[1]}
        range={[0, 95, 1]}
      />
      <NumberField
        label={text.newSurvey.height(lengthUnit())}
        value={figures.height.text()}
        onType={figures.height.type}
        range={[Math.ceil(inLengthUnit(LOWEST_M)), Math.floor(inLengthUnit(HIGHEST_M)), 1]}
      />
      <label>
        {text.newSurvey.above}
        <select
          name="above"
          onChange={(event) => figures.setAboveGround(event.currentTarget.value === "ground")}
        >
          <option value="takeoff">{text.newSurvey.references.takeoff}</option>
          <option value="ground" disabled={!isGroundKnown()}>
            {text.newSurvey.references[isGroundKnown() ? "ground" : "noGround"]}
          </option>
        </select>
      </label>
      <NumberField
        label={text.newSurvey.speed}
        value={String(figures.speed_mps())}
        onType={figures.typeSpeed}
        range={[1, FASTEST_MPS, 0.1]}
      />
      <Show
        when={figures.timer_s().length > 0}
        fallback={
          <NumberField
            label={text.newSurvey.interval}
            value={String(figures.interval_s())}
            onType={figures.typeInterval}
            range={[0.5, 60, 0.1]}
          />
        }
      >
        <label>
          {text.newSurvey.interval}
          <select
            name="interval"
            onChange={(event) => figures.typeInterval(event.currentTarget.value)}
          >
            <For each={figures.timer_s()}>
              {(each) => (
                <option value={each} selected={each === figures.interval_s()}>
                  {each}
                </option>
              )}
            </For>
          </select>
        </label>
      </Show>
    </>
  );
}

function NumberField(props: {
  label: string;
  value: string;
  onType: (text: string) => void;
  /** Least, most, step. */
  range: readonly [number, number, number];
  placeholder?: string;
  isFixed?: boolean;
}) {
  // While it is typed into, a field keeps what was typed.
  const [typed, setTyped] = createSignal<string | null>(null);
  return (
    <label>
      {props.label}
      <input
        type="number"
        min={props.range[0]}
        max={props.range[1]}
        step={props.range[2]}
        value={typed() ?? props.value}
        placeholder={props.placeholder}
        disabled={props.isFixed === true}
        required={props.placeholder === undefined}
        onInput={(event) => {
          setTyped(event.currentTarget.value);
          props.onType(event.currentTarget.value);
        }}
        onBlur={() => setTyped(null)}
      />
    </label>
  );
}

/** One of a few values, each with its words. */
function Choice<Name extends string>(props: {
  label: string;
  name: string;
  values: readonly Name[];
  shown: Readonly<Record<Name, string>>;
}) {
  return (
    <label class="survey-wide">
      {props.label}
      <select name={props.name}>
        <For each={props.values}>
          {(value) => <option value={value}>{props.shown[value] ?? value}</option>}
        </For>
      </select>
    </label>
  );
}

/** What else a survey does; what the site cannot do is not offered. */
function Choices(props: { isAnyFlown: boolean }) {
  const { fleet } = useStation();
  const imagers = () => fleet.vehicles.filter(({ is_imager }) => is_imager);
  return (
    <>
      <Show when={imagers().length > 0}>
        <Choice
          label={text.newSurvey.rows}
          name="planner"
          values={[...PLANNERS, ...(fleet.site?.outside_planners ?? [])]}
          shown={PLANNER_LABELS}
        />
      </Show>
      <Show when={props.isAnyFlown}>
        <Choice
          label={text.flown.lines}
          name="lines"
          values={LINES}
          shown={text.flown.lineChoices}
        />
      </Show>
      <Choice
        label={text.newSurvey.whenDone}
        name="when_done"
        values={WHEN_DONE}
        shown={text.newSurvey.thenDo}
      />
      <Show when={imagers().length > 0}>
        <label class="survey-wide survey-check">
          <input name="side_step" type="checkbox" />
          {text.newSurvey.sideStep}
        </label>
        <label class="survey-wide survey-check">
          <input name="upwind" type="checkbox" />
          {text.newSurvey.upwind}
        </label>
        <label class="survey-wide">
          {text.newSurvey.battery}
          <select name="battery">
            <option value="warn">{text.newSurvey.batteryEnds.warn}</option>
            <option value="home">{text.newSurvey.batteryEnds.home}</option>
            <For each={imagers().length > 1 ? imagers() : []}>
              {(vehicle) => (
                <option value={vehicle.serial ?? "home"}>
                  {text.newSurvey.spare(vehicleLabel(vehicle))}
                </option>
              )}
            </For>
          </select>
        </label>
      </Show>
    </>
  );
}

/** What a request has of the form's choices. */
function choicesOf(data: FormData) {
  const battery = String(data.get("battery") ?? "warn");
  return {
    region: String(data.get("region")),
    planner: String(data.get("planner") ?? ANY_LIGHT),
    rows: LINES.find((name) => name === data.get("lines")) ?? ("auto" as const),
    side_step_allowed: data.get("side_step") !== null,
    upwind_allowed: data.get("upwind") !== null,
    // What it may do when its imaging drone's battery ends: warn, return it home, or relieve it.
    relief_allowed: battery !== "warn",
    spare_serial: battery === "warn" || battery === "home" ? null : battery,
    when_done: data.get("when_done") === "hover" ? ("hover" as const) : ("return_home" as const),
  };
}
