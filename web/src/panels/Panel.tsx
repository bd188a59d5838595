import { createUniqueId, type JSX, Show } from "solid-js";
import "./panel.css";

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
