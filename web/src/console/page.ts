import { type Accessor, createSignal } from "solid-js";
import type { Kept } from "../map/baseMaps";
import { createLargeCamera, type LargeCamera } from "../panels/cameras/largeCamera";
import type { OpenPanels } from "../panels/openPanels";
import { type AlarmSound, createAlarmSound } from "../sound/alarmSound";
import type { Notifier } from "../sound/attention";
import type { Mutes } from "../sound/mutes";
import type { Speaker } from "../sound/speaker";
import type { Instant } from "../source/clock";
import type { ThemeSwitch } from "../theme/theme";
import type { StationPart } from "./station";

/** The login of this page. */
export interface Login {
  readonly hasToken: boolean;
  /** SHA-256 of the certificate that the page's QR code named; null without one. */
  readonly fingerprint: string | null;
  logIn(token: string): void;
  logOut(): void;
}

/** What the browser gives to a page. */
export interface Browser {
  readonly theme: ThemeSwitch;
  readonly panels: OpenPanels;
  readonly mutes: Mutes;
  readonly speaker: Speaker;
  readonly notifier: Notifier;
  readonly login: Login;
  readonly kept: Kept;
}

/** How this page looks and sounds, and who uses it. */
export interface PagePart {
  readonly theme: ThemeSwitch;
  readonly panels: OpenPanels;
  readonly largeCamera: LargeCamera;
  readonly alarmSound: AlarmSound;
  /** What this browser keeps. */
  readonly kept: Kept;
  readonly login: Login;
  /** Whether the page is locked against stray touches. */
  readonly lock: { readonly isOn: Accessor<boolean>; set(isOn: boolean): void };
}

export function createPagePart(
  { source, isReplay }: StationPart,
  now: Accessor<Instant>,
  { theme, panels, mutes, speaker, notifier, login, kept }: Browser,
): PagePart {
  const [isLocked, setLocked] = createSignal(false);
  return {
    theme,
    panels,
    largeCamera: createLargeCamera(),
    alarmSound: createAlarmSound(source, isReplay, now, mutes, speaker, notifier),
    kept,
    login,
    // A replay has no orders to guard.
    lock: { isOn: () => isLocked() && !isReplay(), set: setLocked },
  };
}
