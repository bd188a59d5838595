import { For, Match, Show, Switch } from "solid-js";
import { useConsole } from "../../console";
import type { Answer } from "../../orders/desk";
import type { OrderResult } from "../../protocol";
import { listNames } from "../../words/names";
import { SeverityMark } from "../SeverityMark";

/** What the station said to the last order, vehicle by vehicle, until it is put away. */
export function LastAnswer() {
  const { desk } = useConsole();
  return (
    <Show when={desk.last()}>
      {(answer) => (
        <div class="answer" role="status">
          <div class="answer-text wire-text">
            <strong>{answer().what}</strong>
            <Show when={answer().outcome.kind === "waiting"}>
              {" "}
              to {listNames(answer().labels)}: asking the station
            </Show>
            <AnswerBody answer={answer()} />
          </div>
          <button
            type="button"
            class="button"
            aria-label="Put this answer away"
            onClick={() => desk.dismiss()}
          >
            ✕
          </button>
        </div>
      )}
    </Show>
  );
}

/** The station's answer: what was accepted, what was refused and why, or that nothing was given. */
export function AnswerBody(props: { answer: Answer }) {
  const problem = () => {
    const { outcome } = props.answer;
    return outcome.kind === "failed" ? outcome.problem : null;
  };
  const results = () => {
    const { outcome } = props.answer;
    return outcome.kind === "answered" ? outcome.value : null;
  };
  return (
    <Switch>
      <Match when={problem()}>
        {(text) => (
          <p class="answer-line tone-critical">
            <SeverityMark severity="critical" />
            <span>
              {listNames(props.answer.labels)}: not given. {text()}
            </span>
          </p>
        )}
      </Match>
      <Match when={results()}>
        {(list) => (
          <Show when={list().length > 0} fallback={<p class="answer-line">Nothing was flying.</p>}>
            <AcceptedLine accepted={list().filter((result) => result.accepted)} />
            <ul>
              <For each={list().filter((result) => !result.accepted)}>
                {(result) => <RefusedLine result={result} />}
              </For>
            </ul>
          </Show>
        )}
      </Match>
    </Switch>
  );
}

function nameOf(result: OrderResult): string {
  return result.vehicle_name || `link ${result.link_id ?? "unknown"}`;
}

function AcceptedLine(props: { accepted: readonly OrderResult[] }) {
  const names = () =>
    props.accepted.map((result) => `${nameOf(result)} (command ${result.command_id})`);
  return (
    <Show when={props.accepted.length > 0}>
      <p class="answer-line">
        <span class="tone-good">
          <SeverityMark severity={null} />
        </span>
        <span>
          Accepted: <strong>{listNames(names())}</strong>
        </span>
      </p>
    </Show>
  );
}

function RefusedLine(props: { result: OrderResult }) {
  return (
    <li class="answer-line">
      <span class="tone-error">
        <SeverityMark severity="error" />
      </span>
      <span>
        Refused: <strong>{nameOf(props.result)}</strong> ({props.result.rule ?? "no rule given"}):{" "}
        {props.result.reason}
      </span>
    </li>
  );
}
