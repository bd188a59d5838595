import { For, Match, Show, Switch } from "solid-js";
import { useConsole } from "../../console";
import type { OrderAnswer } from "../../orders/orderApi";
import type { OrderResult } from "../../protocol";
import { listNames, ruleTitle } from "../../text/names";
import { SeverityMark } from "../SeverityMark";

/** The station's answer to the last order, per vehicle, until dismissed. */
export function AnswerNotice() {
  const { orderApi } = useConsole();
  return (
    <Show when={orderApi.lastAnswer()}>
      {(answer) => (
        <div class="answer" role="status">
          <div class="answer-text wire-text">
            <strong>{answer().order}</strong>
            <Show when={answer().outcome.kind === "waiting"}>
              {" "}
              to {listNames(answer().labels)}: waiting for the station
            </Show>
            <AnswerResults answer={answer()} />
          </div>
          <button
            type="button"
            class="button"
            aria-label="Dismiss"
            onClick={() => orderApi.dismiss()}
          >
            ✕
          </button>
        </div>
      )}
    </Show>
  );
}

/** The results of an order: accepted, refused with reasons, or failed. */
export function AnswerResults(props: { answer: OrderAnswer }) {
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
              {listNames(props.answer.labels)}: not confirmed. {text()}
            </span>
          </p>
        )}
      </Match>
      <Match when={results()}>
        {(list) => (
          <Show
            when={list().length > 0}
            fallback={<p class="answer-line">No connected vehicle reports that it is flying.</p>}
          >
            <AcceptedLine accepted={list().filter((result) => result.accepted)} />
            <ul>
              <For each={list().filter((result) => result.accepted && result.reason)}>
                {(result) => <RemarkLine result={result} />}
              </For>
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

/** A vehicle's name, with the SIM tag outside it, where no name can imitate the tag. */
function Name(props: { result: OrderResult }) {
  return (
    <>
      <strong>{nameOf(props.result)}</strong>
      <Show when={props.result.is_simulated}>
        {" "}
        <span class="tag tag-simulated">SIM</span>
      </Show>
    </>
  );
}

function AcceptedLine(props: { accepted: readonly OrderResult[] }) {
  return (
    <Show when={props.accepted.length > 0}>
      <p class="answer-line">
        <span class="tone-good">
          <SeverityMark severity={null} />
        </span>
        <span>
          {"Accepted: "}
          <For each={props.accepted}>
            {(result, index) => (
              <>
                {separator(index(), props.accepted.length)}
                <Name result={result} />
              </>
            )}
          </For>
        </span>
      </p>
    </Show>
  );
}

/** Separator before the name at `index` in a list of `count` names. */
function separator(index: number, count: number): string {
  if (index === 0) return "";
  return index === count - 1 ? " and " : ", ";
}

/** A remark on an accepted order, such as what it waits for. */
function RemarkLine(props: { result: OrderResult }) {
  return (
    <li class="answer-line">
      <span>
        <Name result={props.result} />: {props.result.reason}
      </span>
    </li>
  );
}

function RefusedLine(props: { result: OrderResult }) {
  return (
    <li class="answer-line" title={ruleTitle(props.result.rule)}>
      <span class="tone-error">
        <SeverityMark severity="error" />
      </span>
      <span>
        Refused: <Name result={props.result} />: {props.result.reason}
      </span>
    </li>
  );
}
