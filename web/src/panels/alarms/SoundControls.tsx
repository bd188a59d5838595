import { createSignal, For, Show } from "solid-js";
import { usePage, useStation } from "../../console";
import { causeName } from "../../fleet/alarmGroups";
import { kindOf } from "../../sound/alarmSound";
import { text } from "../../text/catalogue";
import { SeverityMark } from "../SeverityMark";

/** A loudspeaker, crossed out while muted. */
export function SpeakerIcon(props: { isMuted: boolean }) {
  return (
    <svg class="speaker-icon" viewBox="0 0 24 24" width="22" height="22" aria-hidden="true">
      <path d="M4 9v6h4l5 4V5L8 9Z" />
      <Show when={props.isMuted} fallback={<path d="M16 9q2 3 0 6M18.5 6.5q4 5.5 0 11" />}>
        <path d="M16 9l6 6M22 9l-6 6" />
      </Show>
    </svg>
  );
}

/** All sound on or off, a test of it, and the kinds that are muted of their own. */
export function SoundControls() {
  const { isReplay } = useStation();
  const { alarmSound } = usePage();
  const { mutes, notifier } = alarmSound;
  const [permission, setPermission] = createSignal(notifier.permission());
  const askForNotes = async () => {
    await notifier.ask();
    setPermission(notifier.permission());
  };
  const state = () => {
    if (isReplay()) return text.sound.replay;
    if (mutes.isAllMuted()) return text.sound.allMuted;
    if (alarmSound.problem() !== null) return text.sound.problems[alarmSound.problem() ?? "absent"];
    return alarmSound.hasVoice() ? text.sound.full : text.sound.toneOnly;
  };
  return (
    <section class="sound" aria-label={text.sound.name}>
      <p>
        <SpeakerIcon isMuted={mutes.isAllMuted()} /> {state()}
      </p>
      <div class="sound-buttons">
        <button
          type="button"
          class="button"
          aria-pressed={mutes.isAllMuted()}
          onClick={() => mutes.muteAll(!mutes.isAllMuted())}
        >
          {text.sound.muteAll}
        </button>
        <button type="button" class="button" onClick={() => alarmSound.test()}>
          {text.sound.test}
        </button>
        <Show when={permission() === "default"}>
          <button type="button" class="button" onClick={() => void askForNotes()}>
            {text.sound.allowNotes}
          </button>
        </Show>
        <For each={mutes.kinds()}>
          {(kind) => (
            <button type="button" class="button" onClick={() => mutes.mute(kind, false)}>
              {text.sound.unmute(causeName(kind))}
            </button>
          )}
        </For>
      </div>
    </section>
  );
}

/** Mutes one kind of alarm, or makes it sound again. */
export function MuteButton(props: { kind: string }) {
  const { mutes } = usePage().alarmSound;
  const isMuted = () => mutes.kinds().includes(props.kind);
  return (
    <button
      type="button"
      class="button button-quiet"
      aria-pressed={isMuted()}
      aria-label={text.sound.mute(causeName(props.kind))}
      title={isMuted() ? text.sound.isMuted : text.sound.muteHint}
      onClick={() => mutes.mute(props.kind, !isMuted())}
    >
      <SpeakerIcon isMuted={isMuted() || mutes.isAllMuted()} />
    </button>
  );
}

/** Shown while a grave alarm makes no sound: silence must not pass for safety. */
export function SilenceBanner() {
  const { alarmSound } = usePage();
  const { mutes } = alarmSound;
  const titles = () => alarmSound.silenced().map(({ title }) => title.replace(/\.$/, ""));
  const kinds = () => [...new Set(alarmSound.silenced().map(kindOf))];
  const isMuted = () => kinds().some(mutes.isMuted);
  const unmute = () => {
    mutes.muteAll(false);
    for (const kind of kinds()) mutes.mute(kind, false);
  };
  return (
    <Show when={titles().length > 0}>
      <div class="card notice silence" role="alert">
        <SeverityMark severity="critical" size={22} />
        <p class="wire-text">
          <strong>{text.sound.silent}</strong> {titles().join("; ")}.{" "}
          {isMuted() ? "" : text.sound.problems[alarmSound.problem() ?? "absent"]}
        </p>
        <Show when={isMuted()}>
          <button type="button" class="button" onClick={unmute}>
            {text.sound.unmuteAll}
          </button>
        </Show>
      </div>
    </Show>
  );
}
