import { createUniqueId, type JSX, Show } from "solid-js";
import "./panel.css";
import { useConsole } from "../console";
import { SeverityMark } from "./SeverityMark";

/** A titled section of the page's sides. */
export function Panel(props: {
  title: string;
  /** How many things are listed; left out when counting means nothing. */
  count?: number;
  actions?: JSX.Element;
  children: JSX.Element;
}) {
  const title = createUniqueId();
  return (
    <section class="panel" aria-labelledby={title}>
      <header class="panel-head">
        <h2 id={title}>{props.title}</h2>
        <Show when={props.count !== undefined}>
          <span class="panel-count">{props.count}</span>
        </Show>
        <div class="bar-space" />
        {props.actions}
      </header>
      {props.children}
    </section>
  );
}

/** What stands in an empty list. Before the first news nothing is known, not even that there is nothing. */
export function Empty(props: { children: JSX.Element }) {
  const { fleet } = useConsole();
  return (
    <p class="panel-empty">
      <Show when={fleet.hasState} fallback="Not known: the station has not been heard yet.">
        {props.children}
      </Show>
    </p>
  );
}

/** Why something was not done, where it was asked for; nothing while there is nothing to say. */
export function Problem(props: { text: string | null }) {
  return (
    <Show when={props.text}>
      {(text) => (
        <p class="problem wire-text" role="status">
          <span class="tone-error">
            <SeverityMark severity="error" />
          </span>
          <span>{text()}</span>
        </p>
      )}
    </Show>
  );
}
