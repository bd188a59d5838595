import { Show } from "solid-js";
import { SeverityMark } from "./SeverityMark";

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
