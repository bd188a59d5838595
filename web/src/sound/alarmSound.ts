import { type Accessor, createEffect, createMemo, on } from "solid-js";
import { type AlarmGroup, groupAlarms } from "../fleet/alarmGroups";
import type { AlarmView } from "../protocol";
import type { Instant } from "../source/clock";
import type { StationSource } from "../source/stationSource";
import { text } from "../text/catalogue";
import { announce, SILENT } from "./announcements";
import type { Notifier } from "./attention";
import type { Mutes } from "./mutes";
import type { SoundProblem, Speaker } from "./speaker";

/** The sound of the alarms of this page. */
export interface AlarmSound {
  readonly mutes: Mutes;
  readonly hasVoice: Accessor<boolean>;
  /** Why what is not muted makes no sound; null while sound works. */
  readonly problem: Accessor<SoundProblem | null>;
  /** Causes that sound, or would if they were not muted. */
  readonly causes: Accessor<readonly AlarmGroup[]>;
  /** Causes that must not be silent unnoticed, and are: critical ones, collisions and stops that may be lost. */
  readonly silenced: Accessor<readonly AlarmGroup[]>;
  /** A tone and a sentence, to check loudness and voice. */
  test(): void;
  readonly notifier: Notifier;
}

/** Kinds whose silence is always shown. */
const GRAVE = ["separation", "stop_waits"];

/** A page without a station hears of no alarm: that is one itself. */
const CONNECTION_LOST: AlarmView = {
  id: 0,
  rule: "connection",
  severity: "critical",
  text: text.alarms.noConnection,
  vehicle_name: "",
  serial: null,
  link_id: null,
  raised_age_s: 0,
  is_active: true,
  is_acknowledged: false,
};

/** Announces the alarms of `source` as time goes on; a replay is silent. */
export function createAlarmSound(
  source: StationSource,
  isReplay: Accessor<boolean>,
  now: Accessor<Instant>,
  mutes: Mutes,
  speaker: Speaker,
  notifier: Notifier,
): AlarmSound {
  const causes = createMemo(() => {
    if (isReplay()) return [];
    const connection = source.connection();
    const isLost = connection.kind === "lost" && connection.needsLogin !== true;
    const alarms = isLost ? [CONNECTION_LOST] : (source.state()?.alarms ?? []);
    return groupAlarms(alarms).filter(isAudible);
  });
  const audible = createMemo(() => causes().filter((group) => !mutes.isMuted(kindOf(group))));
  const silenced = createMemo(() => {
    const isGrave = (group: AlarmGroup) =>
      group.severity === "critical" || GRAVE.includes(kindOf(group));
    return causes().filter(
      (group) => isGrave(group) && (mutes.isMuted(kindOf(group)) || speaker.problem() !== null),
    );
  });
  let announcer = SILENT;
  // What was announced while sound was blocked is announced again.
  createEffect(on(speaker.problem, () => (announcer = SILENT), { defer: true }));
  createEffect(() => {
    const [next, announcement] = announce(
      announcer,
      audible(),
      speaker.isSpeaking(),
      now().monotonicMs,
    );
    announcer = next;
    if (announcement === null) return;
    speaker.announce(announcement);
    notifier.notify(announcement);
  });
  return {
    mutes,
    hasVoice: speaker.hasVoice,
    problem: speaker.problem,
    causes,
    silenced,
    notifier,
    test: () =>
      speaker.announce({ severity: "warning", text: text.sound.testSentence, interrupts: false }),
  };
}

/** The kind by which a cause is muted. */
export function kindOf(group: Pick<AlarmGroup, "alarms">): string {
  return group.alarms[0]?.rule ?? "";
}

function isAudible(group: AlarmGroup): boolean {
  return group.isActive && !group.isAcknowledged && group.severity !== "info";
}
