import { createMemo, Show } from "solid-js";
import { usePage, useStation } from "../../console";
import { causeName, isAlarmNow } from "../../fleet/alarmGroups";
import { worstSeverity } from "../../fleet/severity";
import { text } from "../../text/catalogue";
import { capitalised } from "../../text/names";
import { SpeakerIcon } from "../alarms/SoundControls";

/** The number of active alarms, coloured by the worst not acknowledged yet; a press opens the list. */
export function AlarmsButton() {
  const { fleet } = useStation();
  const { panels, alarmSound } = usePage();
  const { mutes } = alarmSound;
  const isMuted = () => mutes.isAllMuted() || mutes.kinds().length > 0;
  const open = createMemo(() => fleet.alarms.filter(isAlarmNow));
  const fresh = () => open().filter(({ is_acknowledged }) => !is_acknowledged);
  const worst = () => worstSeverity(fresh().map(({ severity }) => severity));
  const count = () => text.bar.alarms(open().length);
  const muted = () =>
    mutes.isAllMuted() ? text.bar.allMuted : text.bar.muted(mutes.kinds().map(causeName));
  return (
    <button
      type="button"
      class={`button bar-alarms ${worst() === null ? "" : `tone-ground-${worst()}`}`}
      aria-expanded={panels.isOpen("alarms")}
      aria-label={isMuted() ? `${count()}, ${muted()}` : count()}
      title={isMuted() ? capitalised(muted()) : undefined}
      onClick={() => panels.toggle("alarms")}
    >
      <span aria-hidden="true">▲</span> {open().length}
      <span class="bar-word"> {text.bar.alarmsWord(open().length)}</span>
      <Show when={isMuted()}>
        {" "}
        <SpeakerIcon isMuted={true} />
      </Show>
    </button>
  );
}
