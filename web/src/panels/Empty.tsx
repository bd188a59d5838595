import { type JSX, Show } from "solid-js";
import { useConsole } from "../console";

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
