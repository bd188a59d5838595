import { createSignal, For, Show } from "solid-js";
import { useStation } from "../../console";
import type { ImagerReliefView, SurveyLightView } from "../../protocol";
import { text } from "../../text/catalogue";
import { responseProblem, vehicleLabel } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { formatMinuteOfDay } from "../../text/replay";
import { formatArea } from "../../text/survey";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { Problem, Warning } from "../Panel";
import { isOver, MotionProgress } from "../sun/MotionProgress";

/** Until when a running survey has light, what it flies without, and the orders that bring light. */
export function SurveyLight(props: { light: SurveyLightView }) {
  const { behindS, fleet, source } = useStation();
  const [problem, setProblem] = createSignal<string | null>(null);
  /** The local time in some seconds, by the station's clock. */
  const timeIn = (seconds: number) =>
    formatMinuteOfDay((source.state()?.time_ns ?? 0) / 1e6 + seconds * 1000);
  const isAtWork = (serial: string | null) =>
    props.light.imagers.some((each) => each.serial === serial);
  const spares = () =>
    fleet.vehicles.filter(({ is_imager, serial }) => is_imager && !isAtWork(serial));
  const isUnderWay = () =>
    [fleet.sideStep, fleet.moveUpwind, fleet.imagerRelief].some(
      (motion) => motion !== null && !isOver(motion),
    );
  const relieve = async (serial: string, spare: string, takeoff: boolean) =>
    setProblem(responseProblem(await source.orders.relieve(serial, spare, takeoff)));
  const subject = (...parts: string[]) => (isUnderWay() ? "" : parts.join(" "));
  return (
    <div class="survey-light" data-testid="survey-light">
      {/* In a demonstration an imaging drone does not run down, and its return moves all the time. */}
      <Show when={fleet.station?.repeats_surveys !== true}>
        <For each={props.light.imagers}>
          {(imager) => <p class="wire-text">{leavesText(imager, props.light, timeIn)}</p>}
        </For>
        <Warning text={warning(props.light, behindS())} />
      </Show>
      <div class="section-buttons">
        <For each={props.light.imagers}>
          {(imager) => (
            <For each={spares()}>
              {(spare) => (
                <GuardButton
                  label={text.relief.relieve(vehicleLabel(spare))}
                  of={text.relief.relieveOf(vehicleLabel(spare), imager.vehicle_name)}
                  hold_ms={GUARD_MS}
                  subject={subject(imager.serial, spare.serial ?? "")}
                  onConfirm={() =>
                    void relieve(imager.serial, spare.serial ?? "", spare.is_flying.value !== true)
                  }
                />
              )}
            </For>
          )}
        </For>
        <For each={props.light.absent.filter((each) => each.is_on_ground)}>
          {(imager) => (
            <GuardButton
              label={text.relief.sendBack(imager.vehicle_name)}
              of={text.relief.sendBackOf(imager.vehicle_name)}
              hold_ms={GUARD_MS}
              subject={subject(imager.serial)}
              onConfirm={() => void relieve(imager.serial, imager.serial, true)}
            />
          )}
        </For>
      </div>
      <Problem text={problem()} />
      <Show when={fleet.imagerRelief}>
        {(view) => <MotionProgress view={view()} stage={stageText(view())} testId="relief" />}
      </Show>
    </div>
  );
}

/** When one imaging drone must return, beside the end of the survey where that is later. */
function leavesText(
  { vehicle_name, return_due_in_s, unknown }: SurveyLightView["imagers"][number],
  { needs_s }: SurveyLightView,
  timeIn: (seconds: number) => string,
): string {
  if (return_due_in_s === null) return text.relief.notKnown(vehicle_name, unknown ?? "");
  if (return_due_in_s <= 0) return text.relief.leavesNow(vehicle_name);
  return needs_s === null || needs_s <= return_due_in_s
    ? text.relief.leaves(vehicle_name, timeIn(return_due_in_s))
    : text.relief.leavesBefore(vehicle_name, timeIn(return_due_in_s), timeIn(needs_s));
}

/** What is flown without light now, or from when on; null while nothing is. */
function warning(light: SurveyLightView, behindS: number): string | null {
  if (light.without_age_s !== null)
    return text.relief.without(
      formatAge(light.without_age_s + behindS),
      formatArea(light.without_m2 ?? 0),
    );
  if (light.unknown_in_s === null) return null;
  return light.unknown_for_s === null
    ? text.relief.unknown
    : text.relief.unknownFor(Math.max(1, Math.round(light.unknown_for_s / 60)));
}

/** A stage as shown after the vehicle's name. */
function stageText({ stage, serial, relieved, relieved_name }: ImagerReliefView): string {
  return serial === relieved
    ? (text.relief.itsOwn[stage] ?? stage)
    : (text.relief.stages[stage]?.(relieved_name) ?? stage);
}
