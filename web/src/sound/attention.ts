import { createEffect, onCleanup } from "solid-js";
import { text } from "../text/catalogue";
import type { Announcement } from "./announcements";

/** Whether a browser shows notes of a page that is not in front. */
export type NotePermission = "granted" | "denied" | "default" | "absent";

/** Notes of the browser for alarms while the page is not in front. */
export interface Notifier {
  permission(): NotePermission;
  /** Asks the person; only on a press. */
  ask(): Promise<void>;
  /** Shows an alarm, if the person allowed it and the page is not in front. */
  notify(announcement: Announcement): void;
}

/** One alarm after another takes the same note's place. */
const TAG = "recon-alarm";

/** The browser's notes. */
export function createNotifier(page: Window & typeof globalThis): Notifier {
  const permission = (): NotePermission =>
    (page.Notification as typeof Notification | undefined)?.permission ?? "absent";
  return {
    permission,
    ask: async () => {
      if (permission() === "default") await page.Notification.requestPermission();
    },
    notify: ({ text: body }) => {
      if (permission() !== "granted" || !page.document.hidden) return;
      try {
        const note = new page.Notification(text.page.product, { body, tag: TAG });
        note.onclick = () => page.focus();
      } catch {
        // Some phones allow notes to service workers only.
      }
    },
  };
}

/** The page's title: a tab that is not in front still tells how many alarms nobody has acknowledged. */
export function titleOf(alarms: number): string {
  return alarms === 0 ? text.page.product : text.page.alarmsTitle(alarms);
}

type LockingPage = Pick<Document, "hidden" | "addEventListener" | "removeEventListener">;
type Locks = { request(type: "screen"): Promise<{ release(): Promise<void> }> };

/** Keeps the screen on while `isNeeded`, where the browser can; it takes the lock away from a hidden page. */
export function keepScreenOn(
  page: LockingPage,
  locks: Locks | undefined,
  isNeeded: () => boolean,
): void {
  if (locks === undefined) return;
  let held: Promise<{ release(): Promise<void> } | null> | null = null;
  const take = () => {
    if (isNeeded() && !page.hidden) held = locks.request("screen").catch(() => null);
  };
  const release = () => {
    void held?.then((lock) => lock?.release()).catch(() => undefined);
    held = null;
  };
  createEffect(() => (isNeeded() ? take() : release()));
  page.addEventListener("visibilitychange", take);
  onCleanup(() => {
    page.removeEventListener("visibilitychange", take);
    release();
  });
}
