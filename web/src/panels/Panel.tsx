import { createUniqueId, type JSX, Show } from "solid-js";
import { text } from "../text/catalogue";
import "./panel.css";
import { usePage, useStation } from "../console";
import type { PanelName } from "./openPanels";
import { SeverityMark } from "./SeverityMark";

/** A titled card over the map. */
export function Panel(props: {
  title: string;
  /** The panel that the cross closes; without it there is no cross. */
  name?: PanelName;
  /** Number of listed items; omitted where a count is meaningless. */
  count?: number;
  actions?: JSX.Element;
  class?: string;
  children: JSX.Element;
}) {
  const { panels } = usePage();
  const title = createUniqueId();
  return (
    <section class={`card panel ${props.class ?? ""}`} aria-labelledby={title}>
      <header class="panel-head">
        <h2 id={title}>{props.title}</h2>
        <Show when={props.count !== undefined}>
          <span class="panel-count">{props.count}</span>
        </Show>
        <div class="bar-space" />
        {props.actions}
        <Show when={props.name}>
          {(name) => (
            <button
              type="button"
              class="button button-quiet"
              aria-label={text.panels.close(props.title)}
              onClick={() => panels.close(name())}
            >
              ✕
            </button>
          )}
        </Show>
      </header>
      {props.children}
    </section>
  );
}

/** Text of an empty list; before the first state the list is unknown, not empty. */
export function Empty(props: { children: JSX.Element }) {
  const { fleet } = useStation();
  return (
    <p class="panel-empty">
      <Show when={fleet.hasState} fallback={text.panels.noData}>
        {props.children}
      </Show>
    </p>
  );
}

/** Why a request failed, shown beside its control; nothing without a problem. */
export function Problem(props: { text: string | null }) {
  return (
    <Show when={props.text}>
      {(problem) => (
        <p class="problem wire-text" role="status">
          <span class="tone-error">
            <SeverityMark severity="error" />
          </span>
          <span>{problem()}</span>
        </p>
      )}
    </Show>
  );
}

/** What needs attention while it holds; nothing without a text. */
export function Warning(props: { text: string | null }) {
  return (
    <Show when={props.text}>
      {(why) => (
        <p class="problem wire-text">
          <span class="tone-warning">
            <SeverityMark severity="warning" />
          </span>
          <span>{why()}</span>
        </p>
      )}
    </Show>
  );
}
