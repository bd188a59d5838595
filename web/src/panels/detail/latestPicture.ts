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

/** A picture that can be shown, and which frame it really is, if the station said so. */
export interface ShownPicture {
  readonly url: string;
  readonly frameId: number | null;
}

/** What a `LatestPicture` does with its surroundings. */
export interface PictureSurroundings {
  fetch(key: PictureKey): Promise<Outcome<Picture>>;
  readonly addresses: PictureAddresses;
  show(picture: ShownPicture | null): void;
  /** Does something after a while; returns what calls it off. */
  later(action: () => void): () => void;
}

/**
 * Keeps the newest picture wanted: fetches one at a time, passes over those that were overtaken, asks
 * again later for one that did not come, and never shows one vehicle's picture for another.
 */
export class LatestPicture {
  private wanted: PictureKey | null = null;
  private asked: PictureKey | null = null;
  private shownUrl: string | null = null;
  private isClosed = false;
  private callOff: () => void = () => {};

  constructor(private readonly around: PictureSurroundings) {}

  /** To be called once for every new frame; null when there is none to be shown. */
  want(key: PictureKey | null): void {
    if (this.wanted?.serial !== key?.serial) this.replace(null);
    this.wanted = key;
    if (this.asked === null) void this.fetchWanted();
  }

  close(): void {
    this.isClosed = true;
    this.callOff();
    this.replace(null);
  }

  private async fetchWanted(): Promise<void> {
    const key = this.wanted;
    this.callOff();
    if (key === null) return;
    this.asked = key;
    const outcome = await this.around.fetch(key);
    this.asked = null;
    if (this.isClosed) return;
    const isOfWanted = this.wanted?.serial === key.serial;
    if (outcome.kind === "answered" && isOfWanted) this.replace(outcome.value);
    if (this.wanted !== key) void this.fetchWanted();
    else if (outcome.kind === "failed") this.retryLater();
  }

  private retryLater(): void {
    this.callOff = this.around.later(() => void this.fetchWanted());
  }

  private replace(picture: Picture | null): void {
    if (picture === null && this.shownUrl === null) return;
    if (this.shownUrl !== null) this.around.addresses.revoke(this.shownUrl);
    this.shownUrl = picture === null ? null : this.around.addresses.create(picture.blob);
    this.around.show(
      picture === null || this.shownUrl === null
        ? null
        : { url: this.shownUrl, frameId: picture.frameId },
    );
  }
}
