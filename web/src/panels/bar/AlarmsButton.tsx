import { createMemo } from "solid-js";
import { useConsole } from "../../console";
import { groupAlarms } from "../../fleet/alarmGroups";
import { worstSeverity } from "../../fleet/severity";

/** The number of alarms that ask for something, coloured by the worst not acknowledged yet; a press opens the list. */
export function AlarmsButton() {
  const { fleet, panels } = useConsole();
  const open = createMemo(() => groupAlarms(fleet.alarms).filter((group) => group.needsLook));
  const fresh = () => open().filter(({ isAcknowledged }) => !isAcknowledged);
  const worst = () => worstSeverity(fresh().map(({ severity }) => severity));
  const text = () => `${open().length} ${open().length === 1 ? "alarm" : "alarms"}`;
  return (
    <button
      type="button"
      class={`button bar-alarms ${worst() === null ? "" : `tone-ground-${worst()}`}`}
      aria-expanded={panels.isOpen("alarms")}
      aria-label={text()}
      onClick={() => panels.toggle("alarms")}
    >
      <span aria-hidden="true">▲</span> {open().length}
      <span class="bar-word"> {open().length === 1 ? "alarm" : "alarms"}</span>
    </button>
  );
}
