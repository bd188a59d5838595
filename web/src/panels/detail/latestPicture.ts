import type { Outcome, Picture } from "../../source/stationSource";

export interface PictureKey {
  readonly serial: string;
  readonly frameId: number;
}

/** Makes addresses of pictures and lets them go again. */
export interface PictureAddresses {
  create(blob: Blob): string;
  revoke(url: string): void;
}

/**
 * Keeps the newest picture wanted: fetches one at a time, passes over those that were overtaken, and
 * never shows one vehicle's picture for another.
 */
export class LatestPicture {
  private wanted: PictureKey | null = null;
  private asked: PictureKey | null = null;
  private shown: string | null = null;
  private isClosed = false;

  constructor(
    private readonly fetchPicture: (key: PictureKey) => Promise<Outcome<Picture>>,
    private readonly addresses: PictureAddresses,
    private readonly show: (url: string | null) => void,
  ) {}

  want(key: PictureKey): void {
    if (this.wanted !== null && this.wanted.serial !== key.serial) this.replace(null);
    this.wanted = key;
    if (this.asked === null) void this.fetchWanted();
  }

  close(): void {
    this.isClosed = true;
    this.replace(null);
  }

  private async fetchWanted(): Promise<void> {
    const key = this.wanted;
    if (key === null) return;
    this.asked = key;
    const outcome = await this.fetchPicture(key);
    this.asked = null;
    if (this.isClosed) return;
    if (outcome.kind === "answered" && this.wanted?.serial === key.serial) {
      this.replace(this.addresses.create(outcome.value.blob));
    }
    const hasNewer = this.wanted?.serial !== key.serial || this.wanted.frameId !== key.frameId;
    if (hasNewer) void this.fetchWanted();
  }

  private replace(url: string | null): void {
    if (this.shown !== null) this.addresses.revoke(this.shown);
    this.shown = url;
    this.show(url);
  }
}
