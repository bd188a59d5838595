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

function AnswerBody(props: { answer: Answer }) {
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
            <ul class="answer-list">
              <For each={list()}>{(result) => <ResultLine result={result} />}</For>
            </ul>
          </Show>
        )}
      </Match>
    </Switch>
  );
}

function ResultLine(props: { result: OrderResult }) {
  const name = () => props.result.vehicle_name || `link ${props.result.link_id ?? "unknown"}`;
  return (
    <li class="answer-line">
      <SeverityMark severity={props.result.accepted ? null : "error"} />
      <span>
        <strong>{name()}</strong>{" "}
        <Show
          when={props.result.accepted}
          fallback={
            <>
              refused ({props.result.rule ?? "no rule given"}): {props.result.reason}
            </>
          }
        >
          accepted, command {props.result.command_id}
        </Show>
      </span>
    </li>
  );
}
