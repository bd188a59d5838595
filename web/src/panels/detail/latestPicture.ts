import type { Outcome, Picture } from "../../protocol";

export interface PictureKey {
  readonly serial: string;
  readonly frameId: number;
}

/** Creates and revokes object URLs. */
export interface PictureAddresses {
  create(blob: Blob): string;
  revoke(url: string): void;
}

/** A displayed picture and its frame number, if known. */
export interface ShownPicture {
  readonly url: string;
  readonly frameId: number | null;
}

/** Dependencies of a `LatestPicture`. */
export interface LatestPictureOptions {
  fetch(key: PictureKey): Promise<Outcome<Picture>>;
  readonly addresses: PictureAddresses;
  show(picture: ShownPicture | null): void;
  /** Runs an action after the retry delay; returns a function that cancels it. */
  later(action: () => void): () => void;
}

/**
 * Loads the newest requested picture: one request at a time, skipping superseded ones and retrying failed
 * ones later. Never shows one vehicle's picture for another.
 */
export class LatestPicture {
  private requested: PictureKey | null = null;
  private pending: PictureKey | null = null;
  private shownUrl: string | null = null;
  private isClosed = false;
  private cancelRetry: () => void = () => {};

  constructor(private readonly options: LatestPictureOptions) {}

  /** Requests a frame's picture; null shows none. */
  request(key: PictureKey | null): void {
    if (this.requested?.serial !== key?.serial) this.replace(null);
    this.requested = key;
    if (this.pending === null) void this.fetchRequested();
  }

  close(): void {
    this.isClosed = true;
    this.cancelRetry();
    this.replace(null);
  }

  private async fetchRequested(): Promise<void> {
    const key = this.requested;
    this.cancelRetry();
    if (key === null) return;
    this.pending = key;
    const outcome = await this.options.fetch(key);
    this.pending = null;
    if (this.isClosed) return;
    const isRequestedVehicle = this.requested?.serial === key.serial;
    if (outcome.kind === "answered" && isRequestedVehicle) this.replace(outcome.value);
    if (this.requested !== key) void this.fetchRequested();
    else if (outcome.kind === "failed") this.retryLater();
  }

  private retryLater(): void {
    this.cancelRetry = this.options.later(() => void this.fetchRequested());
  }

  private replace(picture: Picture | null): void {
    if (picture === null && this.shownUrl === null) return;
    if (this.shownUrl !== null) this.options.addresses.revoke(this.shownUrl);
    this.shownUrl = picture === null ? null : this.options.addresses.create(picture.blob);
    this.options.show(
      picture === null || this.shownUrl === null
        ? null
        : { url: this.shownUrl, frameId: picture.frameId },
    );
  }
}
