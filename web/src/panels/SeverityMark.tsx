import { Match, Switch } from "solid-js";
import type { Severity } from "../protocol";
import { text } from "../text/catalogue";

/** A severity as a shape: octagon, diamond, triangle, disc; a tick for none. */
export function SeverityMark(props: { severity: Severity | null; size?: number }) {
  const size = () => props.size ?? 22;
  const name = () =>
    props.severity === null ? text.severity.ok : text.severity.names[props.severity];
  return (
    <svg
      class="mark"
      width={size()}
      height={size()}
      viewBox="0 0 24 24"
      role="img"
      aria-label={name()}
      fill="currentColor"
    >
      <Switch fallback={<TickMark />}>
        <Match when={props.severity === "critical"}>
          <path d="M8 2h8l6 6v8l-6 6H8l-6-6V8Z" />
          <path class="mark-sign" d="M8 8l8 8M16 8l-8 8" />
        </Match>
        <Match when={props.severity === "error"}>
          <path d="M12 1 23 12 12 23 1 12Z" />
          <path class="mark-sign" d="M12 6v7M12 16.6v.8" />
        </Match>
        <Match when={props.severity === "warning"}>
          <path d="M12 2 23 21.5H1Z" />
          <path class="mark-sign" d="M12 9v6M12 17.8v.6" />
        </Match>
        <Match when={props.severity === "info"}>
          <circle cx="12" cy="12" r="10.5" />
          <path class="mark-sign" d="M12 11v6M12 7v.6" />
        </Match>
      </Switch>
    </svg>
  );
}

function TickMark() {
  return (
    <>
      <circle cx="12" cy="12" r="10.5" />
      <path class="mark-sign" d="M7 12.5l3.4 3.4L17.4 8.6" />
    </>
  );
}
