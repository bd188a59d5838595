import { createResource, onCleanup, Show } from "solid-js";
import type { Outcome, Picture } from "../protocol";
import "./qrCode.css";

/** A QR code that the station draws; nothing while it does not. */
export function QrCode(props: { load: () => Promise<Outcome<Picture>>; alt: string }) {
  let url: string | null = null;
  const [code] = createResource(async () => {
    const outcome = await props.load();
    if (outcome.kind === "failed") return null;
    url = URL.createObjectURL(outcome.value.blob);
    return url;
  });
  onCleanup(() => {
    if (url !== null) URL.revokeObjectURL(url);
  });
  return (
    <Show when={code()}>
      {(address) => <img class="qr-code" src={address()} alt={props.alt} />}
    </Show>
  );
}
