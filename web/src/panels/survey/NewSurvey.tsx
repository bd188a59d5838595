import { createMemo, createResource, createSignal, For, Show } from "solid-js";
import { useConsole } from "../../console";
import type { Outcome, SurveyResponse } from "../../protocol";
import { valuesOf } from "../../protocol/values";
import { text } from "../../text/catalogue";
import { vehicleLabel } from "../../text/names";
import { createLengthField, inLengthUnit, lengthUnit } from "../../text/units";

/** The station's own planners, each under the name that a request has. */
const PLANNERS = valuesOf(text.newSurvey.planners);

const WHEN_DONE = valuesOf(text.newSurvey.thenDo);

/** Heights that can be planned, above takeoff or above ground, and the one offered. */
const [LOWEST_M, HIGHEST_M, USUAL_HEIGHT_M] = [10, 120, 50];

/**
 * Form to plan a survey of a site region. Planning moves nothing, so a plain press suffices. Collapsed once
 * there is a survey, since running surveys matter more.
 */
export function NewSurvey(props: {
  isFirst: boolean;
  onResult: (outcome: Outcome<SurveyResponse>) => void;
}) {
  const { source, fleet, lacks } = useConsole();
  const height = createLengthField(USUAL_HEIGHT_M);
  const [isPlanning, setPlanning] = createSignal(false);
  const [cameras] = createResource(async () => {
    const outcome = await source.surveys.cameras();
    return outcome.kind === "answered" ? outcome.value : [];
  });
  /** The camera that all drones which could fly have, by the site's table. */
  const usual = () => {
    const own = new Set(
      fleet.vehicles.filter(({ is_imager }) => !is_imager).map(({ camera }) => camera),
    );
    const [camera, ...others] = own;
    return others.length === 0 ? (camera ?? "") : "";
  };
  const isGroundKnown = () => fleet.site?.terrain === "model";
  const imagers = () => fleet.vehicles.filter(({ is_imager }) => is_imager);
  /** Without an imaging drone no shade is known, and rows flown once are all that can be done. */
  const usualPlanner = createMemo(() => (imagers().length > 0 ? "sunlit_first" : "lawnmower_once"));
  const regions = () => (fleet.site?.areas ?? []).filter(({ kind }) => kind === "survey");
  const plan = async (form: HTMLFormElement) => {
    const height_m = height.metres();
    if (height_m === null) return;
    const data = new FormData(form);
    setPlanning(true);
    const model = String(data.get("camera") ?? "");
    const outcome = await source.surveys.plan({
      region: String(data.get("region")),
      ...(data.get("above") === "ground"
        ? { height_above_ground_m: height_m }
        : { height_above_takeoff_m: height_m }),
      speed_mps: Number(data.get("speed")),
      planner: String(data.get("planner")),
      camera: { model: model === "" ? null : model, interval_s: Number(data.get("interval")) },
      side_step_allowed: data.get("side_step") !== null,
      upwind_allowed: data.get("upwind") !== null,
      ...reliefOf(String(data.get("battery") ?? "warn")),
      when_done: data.get("when_done") === "hover" ? "hover" : "return_home",
    });
    setPlanning(false);
    props.onResult(outcome);
  };
  return (
    <Show
      when={regions().length > 0}
      fallback={<p class="panel-empty">{text.newSurvey.noRegions}</p>}
    >
      <details class="section survey-new" open={props.isFirst}>
        <summary>{text.newSurvey.title}</summary>
        <form
          class="survey-form"
          aria-label={text.newSurvey.title}
          onSubmit={(event) => {
            event.preventDefault();
            void plan(event.currentTarget);
          }}
        >
          <label class="survey-wide">
            {text.newSurvey.region}
            <select name="region">
              <For each={regions()}>{({ name }) => <option value={name}>{name}</option>}</For>
            </select>
          </label>
          <label>
            {text.newSurvey.height(lengthUnit())}
            <input
              type="number"
              min={Math.ceil(inLengthUnit(LOWEST_M))}
              max={Math.floor(inLengthUnit(HIGHEST_M))}
              step={1}
              value={height.text()}
              onInput={(event) => height.type(event.currentTarget.value)}
              required
            />
          </label>
          <label>
            {text.newSurvey.above}
            <select name="above">
              <option value="takeoff">{text.newSurvey.references.takeoff}</option>
              <option value="ground" disabled={!isGroundKnown()}>
                {text.newSurvey.references[isGroundKnown() ? "ground" : "noGround"]}
              </option>
            </select>
          </label>
          <label>
            {text.newSurvey.speed}
            <input name="speed" type="number" min={1} max={15} step={0.5} value={5} required />
          </label>
          <label>
            {text.newSurvey.interval}
            <input name="interval" type="number" min={0.5} max={60} step={0.1} value={2} required />
          </label>
          <label class="survey-wide">
            {text.newSurvey.camera}
            <select name="camera">
              <option value="">{text.newSurvey.otherCamera}</option>
              <For each={cameras()}>
                {({ name, title }) => (
                  <option value={name} selected={name === usual()}>
                    {title}
                  </option>
                )}
              </For>
            </select>
          </label>
          <label class="survey-wide">
            {text.newSurvey.rows}
            <select name="planner" value={usualPlanner()}>
              <For each={PLANNERS}>
                {(name) => <option value={name}>{text.newSurvey.planners[name]}</option>}
              </For>
            </select>
          </label>
          <label class="survey-wide">
            {text.newSurvey.whenDone}
            <select name="when_done">
              <For each={WHEN_DONE}>
                {(name) => <option value={name}>{text.newSurvey.thenDo[name]}</option>}
              </For>
            </select>
          </label>
          <label class="survey-wide survey-check">
            <input name="side_step" type="checkbox" />
            {text.newSurvey.sideStep}
          </label>
          <label class="survey-wide survey-check">
            <input name="upwind" type="checkbox" />
            {text.newSurvey.upwind}
          </label>
          <Show when={imagers().length > 0}>
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
          <button
            type="submit"
            class="button"
            disabled={isPlanning() || lacks("operator") !== null}
            title={lacks("operator") ?? undefined}
          >
            {text.newSurvey.plan}
          </button>
        </form>
      </details>
    </Show>
  );
}

/** What a survey may do when its imaging drone's battery ends: warn, return it home, or relieve it. */
function reliefOf(battery: string) {
  const spare_serial = battery === "warn" || battery === "home" ? null : battery;
  return { relief_allowed: battery !== "warn", spare_serial };
}
