import { For, Show } from "solid-js";
import { useMapModes } from "../../console";
import { LEAST_POINTS } from "../../orders/missionDraft";
import { text } from "../../text/catalogue";
import { vehicleLabel } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { formatLength, lengthUnit } from "../../text/units";
import { GUARD_MS, GuardButton } from "../guard/GuardButton";
import { CheckResult } from "./CheckResult";
import "./fly.css";
import "./mission.css";

/** A mission drawn on the map: its points and heights, the safety gate's result, and the button to confirm. */
export function MissionCard() {
  const { missionDraft: mission } = useMapModes();
  const name = () => {
    const vehicle = mission.vehicle();
    return vehicle === null ? "" : vehicleLabel(vehicle);
  };
  const onKeyDown = (event: KeyboardEvent) => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    mission.clear();
  };
  return (
    <Show when={mission.isOn()}>
      <section class="card fly" aria-label={text.mission.name(name())} onKeyDown={onKeyDown}>
        <header class="fly-head">
          <h2 class="wire-text">{text.mission.name(name())}</h2>
          <button
            type="button"
            class="button"
            aria-label={text.mission.leave}
            onClick={() => mission.leave()}
          >
            ✕
          </button>
        </header>
        <Points />
        <Whole />
        <div class="mission-end">
          <CheckResult
            check={mission.check()}
            lack={
              mission.points().length < LEAST_POINTS ? text.mission.more : text.mission.notNumbers
            }
          />
          <GuardButton
            label={mission.isTakeoff() ? text.mission.takeOffAndFly : text.mission.go}
            of={name()}
            needs="pilot"
            hold_ms={GUARD_MS}
            subject={mission.subject()}
            onConfirm={() => mission.confirm()}
          />
        </div>
      </section>
    </Show>
  );
}

/** What is of the whole mission: its length, speed and end. */
function Whole() {
  const { missionDraft: mission } = useMapModes();
  return (
    <>
      <Show when={mission.figures()}>
        {(figures) => (
          <p class="fly-course">
            <strong>
              {text.mission.figures(
                formatLength(figures().distance_m),
                formatAge(Math.ceil(figures().time_s)),
              )}
            </strong>
          </p>
        )}
      </Show>
      <div class="fly-fields">
        <label>
          {text.fly.speed}
          <input
            class="field"
            type="text"
            inputmode="decimal"
            value={mission.speed()}
            onInput={(event) => mission.setSpeed(event.currentTarget.value)}
          />
        </label>
        <label class="mission-land">
          <input
            type="checkbox"
            checked={mission.landsAtEnd()}
            onChange={(event) => mission.setLandsAtEnd(event.currentTarget.checked)}
          />
          {text.mission.land}
        </label>
      </div>
    </>
  );
}

function Points() {
  const { missionDraft: mission, aimAtCentre } = useMapModes();
  const ids = () => mission.points().map(({ id }) => id);
  return (
    <>
      <p>{mission.points().length === 0 ? text.mission.first : text.mission.next}</p>
      <ol class="mission-points">
        <For each={ids()}>{(id, index) => <PointButton id={id} number={index() + 1} />}</For>
      </ol>
      {/* By id: what was typed for one point is not shown for the next. */}
      <Show when={mission.selected()} keyed>
        {(id) => <SelectedPoint number={ids().indexOf(id) + 1} id={id} />}
      </Show>
      <div class="section-buttons">
        <button type="button" class="button" onClick={() => aimAtCentre()}>
          {text.mission.atCentre}
        </button>
        <button
          type="button"
          class="button"
          disabled={mission.points().length === 0}
          onClick={() => mission.discard()}
        >
          {text.mission.discard}
        </button>
      </div>
    </>
  );
}

function PointButton(props: { id: number; number: number }) {
  const { missionDraft: mission } = useMapModes();
  const isSelected = () => mission.selected() === props.id;
  return (
    <li>
      <button
        type="button"
        class="button"
        classList={{ "is-refused": mission.refusedPoint() === props.number }}
        aria-pressed={isSelected()}
        aria-label={text.mission.point(props.number)}
        title={text.mission.pointHint}
        onClick={() => mission.select(isSelected() ? null : props.id)}
      >
        {props.number}
      </button>
    </li>
  );
}

function SelectedPoint(props: { id: number; number: number }) {
  const { missionDraft: mission } = useMapModes();
  const height = () => mission.points().find(({ id }) => id === props.id)?.height;
  return (
    <div class="fly-fields">
      <label>
        {text.mission.heightOf(props.number, lengthUnit())}
        <input
          class="field"
          type="text"
          inputmode="decimal"
          value={height()?.text() ?? ""}
          onInput={(event) => height()?.type(event.currentTarget.value)}
        />
      </label>
      <button
        type="button"
        class="button"
        aria-label={text.mission.remove(props.number)}
        onClick={() => mission.remove(props.id)}
      >
        {text.mission.removeShort}
      </button>
    </div>
  );
}
