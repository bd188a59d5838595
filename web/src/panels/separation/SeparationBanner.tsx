import { Show } from "solid-js";
import { useConsole } from "../../console";
import { SeverityMark } from "../SeverityMark";
import { SeparationSwitch } from "./SeparationSwitch";
import "./separation.css";

/** Stands for as long as the station would let vehicles fly into each other with no more than an alarm. */
export function SeparationBanner() {
  const { fleet } = useConsole();
  return (
    <Show when={fleet.station?.separation_hold_on === false}>
      <div class="separation-off" role="alert">
        <SeverityMark severity="warning" size={26} />
        <p>
          <strong>Separation holds are OFF.</strong> Vehicles that come too close raise an alarm,
          and nobody stops them.
        </p>
        <SeparationSwitch />
      </div>
    </Show>
  );
}
