import { For, Match, Show, Switch } from "solid-js";
import { useConsole } from "../../console";
import type { Answer } from "../../orders/orderApi";
import type { OrderResult } from "../../protocol";
import { listNames, plainWords } from "../../text/names";
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
          <Show
            when={list().length > 0}
            fallback={<p class="answer-line">Nothing connected says that it flies.</p>}
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

/** A vehicle's name, with the mark of a simulated one outside it, where no name can imitate it. */
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
                {joint(index(), props.accepted.length)}
                <Name result={result} /> (command {result.command_id})
              </>
            )}
          </For>
        </span>
      </p>
    </Show>
  );
}

/** What stands before one of so many names in a sentence. */
function joint(index: number, count: number): string {
  if (index === 0) return "";
  return index === count - 1 ? " and " : ", ";
}

/** What the station adds to an order that it accepted, such as what it waits for. */
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
    <li class="answer-line">
      <span class="tone-error">
        <SeverityMark severity="error" />
      </span>
      <span>
        Refused: <Name result={props.result} /> ({plainWords(props.result.rule ?? "no rule given")}
        ): {props.result.reason}
      </span>
    </li>
  );
}
