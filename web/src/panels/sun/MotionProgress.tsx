import { type JSX, Show } from "solid-js";
import { useStation } from "../../console";
import type { ImagerMotionView } from "../../protocol";
import { text } from "../../text/catalogue";
import { personName } from "../../text/names";
import { formatAge } from "../../text/quantities";
import { withLengthUnit } from "../../text/units";

/** The newest motion of a kind: its vehicle and stage, since when and for whom, and why it ended. */
export function MotionProgress(props: {
  view: ImagerMotionView;
  stage: string;
  testId: string;
  children?: JSX.Element;
}) {
  const { behindS } = useStation();
  return (
    <p class="wire-text" data-testid={props.testId}>
      <strong>{props.view.vehicle_name}</strong> {props.stage}
      {props.children}{" "}
      <span class="muted">
        {text.sun.ordered(
          formatAge(props.view.since_age_s + behindS()),
          personName(props.view.begun_by),
        )}
      </span>
      <Show when={props.view.reason}>
        {(reason) => <span class="muted motion-reason">{withLengthUnit(reason())}</span>}
      </Show>
    </p>
  );
}

export function isOver({ stage }: ImagerMotionView): boolean {
  return stage === "done" || stage === "stopped";
}
