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
import { useConsole } from "../../console";
import type { CheckView, PreflightView, Severity } from "../../protocol";
import { formatAge } from "../../text/quantities";
import { SeverityMark } from "../SeverityMark";
import { Override } from "./Override";
import "./preflight.css";
import type { Clock } from "../../source/clock";
import type { Outcome, StationSource } from "../../source/stationSource";

/** What must be in order before a mission, point by point, and what to do where it is not. */
export function PreflightSection(props: { serial: string; name: string }) {
  const { source, clock } = useConsole();
  // The section is made anew for another vehicle (`keyed`), so this never changes.
  const preflight = createPreflight(source, clock, (() => props.serial)());
  const shown = createMemo<PreflightView | null>((before) => {
    const answer = preflight.answer();
    return answer?.kind === "answered" ? answer.value : before;
  }, null);
  const problem = () => {
    const answer = preflight.answer();
    return answer?.kind === "failed" ? answer.problem : null;
  };
  return (
    <section class="section" aria-label="Preflight checklist">
      <Show when={shown()} fallback={<p class="muted">Preflight: {problem() ?? "asking"}</p>}>
        {(list) => (
          <div classList={{ "is-old-list": problem() !== null }}>
            <Show when={problem()}>
              {(why) => <p class="tone-error">This list is old: {why()}</p>}
            </Show>
            <Checklist list={list()} />
            <Show when={!list().is_passed}>
              <OverrideState list={list()} name={props.name} onTaken={() => void preflight.ask()} />
            </Show>
          </div>
        )}
      </Show>
    </section>
  );
}

function OverrideState(props: { list: PreflightView; name: string; onTaken: () => void }) {
  return (
    <Show
      when={props.list.override}
      fallback={
        <Override serial={props.list.serial} name={props.name} onTaken={() => props.onTaken()} />
      }
    >
      {(override) => (
        <p class="check tone-warning">
          <SeverityMark severity="warning" />
          <span class="wire-text">
            <strong>Overridden</strong> by {override().by}, {formatAge(override().age_s)} ago:{" "}
            {override().reason}. It ends with the landing.
          </span>
        </p>
      )}
    </Show>
  );
}

function Checklist(props: { list: PreflightView }) {
  const open = () => props.list.points.filter((point) => point.state !== "ok");
  const fine = () => props.list.points.filter((point) => point.state === "ok");
  return (
    <>
      <p class="check">
        <span class={props.list.is_passed ? "tone-good" : "tone-error"}>
          <SeverityMark severity={props.list.is_passed ? null : "error"} />
        </span>
        <strong>{summary(props.list)}</strong>
      </p>
      <ul>
        <For each={open()}>{(point) => <Point point={point} />}</For>
      </ul>
      <Show when={fine().length > 0}>
        <details>
          <summary class="check-fine">{fine().length} in order</summary>
          <ul>
            <For each={fine()}>{(point) => <Point point={point} />}</For>
          </ul>
        </details>
      </Show>
    </>
  );
}

function summary(list: PreflightView): string {
  if (list.is_passed) return "Preflight: passed";
  const count = list.points.filter((point) => point.holds_back).length;
  return `Preflight: ${count} ${count === 1 ? "point holds" : "points hold"} missions back`;
}

const SEVERITIES: Readonly<Record<CheckView["state"], Severity | null>> = {
  ok: null,
  attention: "warning",
  unknown: "info",
  fails: "error",
};

const STATES: Readonly<Record<CheckView["state"], string>> = {
  ok: "in order",
  attention: "attention",
  unknown: "not known",
  fails: "fails",
};

function Point(props: { point: CheckView }) {
  const severity = () => SEVERITIES[props.point.state];
  return (
    <li class="check">
      <span class={`tone-${severity() ?? "good"}`}>
        <SeverityMark severity={severity()} />
      </span>
      <span class="wire-text">
        <strong>{props.point.name}</strong>, {STATES[props.point.state]}: {props.point.text}
        <Switch>
          <Match when={props.point.to_do !== ""}>
            <span class="check-to-do">→ {props.point.to_do}</span>
          </Match>
        </Switch>
      </span>
    </li>
  );
}

/** The checklist is worked out anew by the station each time it is asked. */
const ASK_EVERY_MS = 2000;

/** A vehicle's checklist, kept fresh for as long as it is looked at. */
export interface Preflight {
  /** The newest answer; null before the first. */
  readonly answer: Accessor<Outcome<PreflightView> | null>;
  ask(): Promise<void>;
}

export function createPreflight(
  source: Pick<StationSource, "preflight">,
  clock: Clock,
  serial: string,
): Preflight {
  const [answer, setAnswer] = createSignal<Outcome<PreflightView> | null>(null);
  let newest = 0;
  let isGone = false;
  let cancel = () => {};
  const ask = async () => {
    newest += 1;
    const own = newest;
    const outcome = await source.preflight(serial);
    if (isGone || own !== newest) return;
    setAnswer(outcome);
    cancel();
    cancel = clock.after(ASK_EVERY_MS, () => void ask());
  };
  void ask();
  onCleanup(() => {
    isGone = true;
    cancel();
  });
  return { answer, ask };
}
