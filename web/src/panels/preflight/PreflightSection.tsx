import {
  type Accessor,
  createMemo,
  createSignal,
  For,
  Match,
  onCleanup,
  Show,
  Switch,
} from "solid-js";
import { useStation } from "../../console";
import type { CheckView, Outcome, PreflightView, Severity } from "../../protocol";
import { text } from "../../text/catalogue";
import { personName } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { withLengthUnit } from "../../text/units";
import { SeverityMark } from "../SeverityMark";
import { FailsafeTable } from "./FailsafeTable";
import { Override } from "./Override";
import "./preflight.css";
import type { Clock } from "../../source/clock";
import type { VehicleRequests } from "../../source/vehicleRequests";

/** The preflight checklist of a vehicle, with instructions for failed items. */
export function PreflightSection(props: { serial: string; name: string }) {
  const { source, clock } = useStation();
  // The section is recreated per vehicle (`keyed`), so the serial never changes.
  const preflight = createPreflight(source.vehicles, clock, (() => props.serial)());
  const shown = createMemo<PreflightView | null>((before) => {
    const answer = preflight.answer();
    return answer?.kind === "answered" ? answer.value : before;
  }, null);
  const problem = () => {
    const answer = preflight.answer();
    return answer?.kind === "failed" ? answer.problem : null;
  };
  return (
    <section class="section" aria-label={text.preflight.name}>
      <Show
        when={shown()}
        fallback={<p class="muted">{text.preflight.state(problem() ?? text.preflight.loading)}</p>}
      >
        {(list) => (
          <div classList={{ "is-old-list": problem() !== null }}>
            <Show when={problem()}>
              {(why) => <p class="tone-error">{text.preflight.notUpdated(why())}</p>}
            </Show>
            <Checklist list={list()} />
            <Show when={!list().is_passed}>
              <OverrideState
                list={list()}
                name={props.name}
                onAccepted={() => void preflight.refresh()}
              />
            </Show>
            <FailsafeTable rows={list().failsafe} />
          </div>
        )}
      </Show>
    </section>
  );
}

function OverrideState(props: { list: PreflightView; name: string; onAccepted: () => void }) {
  return (
    <Show
      when={props.list.override}
      fallback={
        <Override
          serial={props.list.serial}
          name={props.name}
          onAccepted={() => props.onAccepted()}
        />
      }
    >
      {(override) => (
        <p class="check tone-warning">
          <SeverityMark severity="warning" />
          <span class="wire-text">
            {text.preflight.overriddenBy(
              <strong>{text.preflight.overridden}</strong>,
              personName(override().by),
              formatAge(override().age_s),
              override().reason,
            )}
          </span>
        </p>
      )}
    </Show>
  );
}

function Checklist(props: { list: PreflightView }) {
  const notPassed = () => props.list.points.filter((point) => point.state !== "ok");
  const passed = () => props.list.points.filter((point) => point.state === "ok");
  return (
    <>
      <p class="check">
        <span class={props.list.is_passed ? "tone-good" : "tone-error"}>
          <SeverityMark severity={props.list.is_passed ? null : "error"} />
        </span>
        <strong>{summary(props.list)}</strong>
      </p>
      <ul>
        <For each={notPassed()}>{(point) => <ChecklistItem point={point} />}</For>
      </ul>
      <Show when={passed().length > 0}>
        <details>
          <summary class="check-fine">{text.preflight.itemsOk(passed().length)}</summary>
          <ul>
            <For each={passed()}>{(point) => <ChecklistItem point={point} />}</For>
          </ul>
        </details>
      </Show>
    </>
  );
}

function summary(list: PreflightView): string {
  if (list.is_passed) return text.preflight.passed;
  const count = list.points.filter((point) => point.holds_back).length;
  return text.preflight.blocked(count);
}

const SEVERITIES: Readonly<Record<CheckView["state"], Severity | null>> = {
  ok: null,
  attention: "warning",
  unknown: "info",
  fails: "error",
};

function ChecklistItem(props: { point: CheckView }) {
  const severity = () => SEVERITIES[props.point.state];
  return (
    <li class="check">
      <span class={`tone-${severity() ?? "good"}`}>
        <SeverityMark severity={severity()} />
      </span>
      <span class="wire-text">
        <strong>{props.point.name}</strong>: {withLengthUnit(props.point.text)}
        <Switch>
          <Match when={props.point.to_do !== ""}>
            <span class="check-to-do">→ {props.point.to_do}</span>
          </Match>
        </Switch>
      </span>
    </li>
  );
}

/** Refresh interval; the station evaluates the checklist per request. */
const REFRESH_MS = 2000;

/** A vehicle's checklist, refreshed while it is displayed. */
export interface Preflight {
  /** The newest answer; null before the first. */
  readonly answer: Accessor<Outcome<PreflightView> | null>;
  refresh(): Promise<void>;
}

export function createPreflight(
  vehicles: Pick<VehicleRequests, "preflight">,
  clock: Clock,
  serial: string,
): Preflight {
  const [answer, setAnswer] = createSignal<Outcome<PreflightView> | null>(null);
  let newest = 0;
  let isDisposed = false;
  let cancel = () => {};
  const refresh = async () => {
    newest += 1;
    const ownNumber = newest;
    const outcome = await vehicles.preflight(serial);
    if (isDisposed || ownNumber !== newest) return;
    setAnswer(outcome);
    cancel();
    cancel = clock.after(REFRESH_MS, () => void refresh());
  };
  void refresh();
  onCleanup(() => {
    isDisposed = true;
    cancel();
  });
  return { answer, refresh };
}
