import type { StationState } from "../protocol";
import type { Socket } from "../source/stream";

/** A socket whose remote end is controlled by the test. */
export class FakeSocket implements Socket {
  onopen: Socket["onopen"] = null;
  onmessage: Socket["onmessage"] = null;
  onclose: Socket["onclose"] = null;
  isClosed = false;
  readonly sent: string[] = [];

  constructor(
    readonly url = "",
    readonly protocols: readonly string[] = [],
  ) {}

  send(text: string): void {
    this.sent.push(text);
  }

  close(): void {
    this.isClosed = true;
  }

  accept(): void {
    this.onopen?.(new Event("open"));
  }

  deliver(state: StationState): void {
    this.deliverText(JSON.stringify(state));
  }

  deliverText(text: string): void {
    this.onmessage?.(new MessageEvent("message", { data: text }));
  }

  fail(code = 1006, reason = ""): void {
    this.onclose?.(new CloseEvent("close", { code, reason }));
  }
}
