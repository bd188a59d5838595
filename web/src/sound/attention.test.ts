import { createRoot, createSignal } from "solid-js";
import { afterEach, describe, expect, it, vi } from "vitest";
import { createNotifier, keepScreenOn, titleOf } from "./attention";

const ALARM = { severity: "error", text: "Drone 1: battery low", interrupts: false } as const;

/** A page with the browser's notes, and what was shown. */
function pageWith(permission: NotificationPermission, hidden: boolean) {
  const shown: string[] = [];
  class Note {
    static permission = permission;
    static requestPermission = async () => {
      Note.permission = "granted";
      return Note.permission;
    };
    constructor(_title: string, { body }: { body: string }) {
      shown.push(body);
    }
  }
  const page = { Notification: Note, document: { hidden }, focus: () => {} };
  return { shown, page: page as unknown as Window & typeof globalThis };
}

describe("a note of the browser", () => {
  it("is shown only when it was allowed and the page is not in front", () => {
    const shownWith = (permission: NotificationPermission, hidden: boolean) => {
      const { page, shown } = pageWith(permission, hidden);
      createNotifier(page).notify(ALARM);
      return shown;
    };
    expect(shownWith("granted", true)).toEqual(["Drone 1: battery low"]);
    expect(shownWith("granted", false)).toEqual([]);
    expect(shownWith("default", true)).toEqual([]);
    expect(shownWith("denied", true)).toEqual([]);
  });

  it("is allowed by the person, and absent where the browser has none", async () => {
    const notifier = createNotifier(pageWith("default", true).page);
    expect(notifier.permission()).toBe("default");
    await notifier.ask();
    expect(notifier.permission()).toBe("granted");
    const bare = { document: { hidden: true } } as unknown as Window & typeof globalThis;
    expect(createNotifier(bare).permission()).toBe("absent");
    createNotifier(bare).notify(ALARM);
  });
});

it("the title counts alarms", () => {
  expect([titleOf(0), titleOf(1), titleOf(3)]).toEqual([
    "Recon",
    "1 ALARM · Recon",
    "3 ALARMS · Recon",
  ]);
});

describe("the screen", () => {
  afterEach(() => vi.restoreAllMocks());

  it("is kept on while needed, again after the page was hidden, and let go", async () => {
    const release = vi.fn(async () => {});
    const locks = { request: vi.fn(async () => ({ release })) };
    const [isNeeded, need] = createSignal(false);
    const dispose = createRoot((dispose) => {
      keepScreenOn(document, locks, isNeeded);
      return dispose;
    });
    expect(locks.request).not.toHaveBeenCalled();
    need(true);
    document.dispatchEvent(new Event("visibilitychange"));
    expect(locks.request).toHaveBeenCalledTimes(2);
    need(false);
    await Promise.resolve();
    await Promise.resolve();
    expect(release).toHaveBeenCalled();
    dispose();
    need(true);
    expect(locks.request).toHaveBeenCalledTimes(2);
  });
});
