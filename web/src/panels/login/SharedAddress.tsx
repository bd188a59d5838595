import { For, Show } from "solid-js";
import { useConsole } from "../../console";
import { QrCode } from "../QrCode";
import "./login.css";

/** How other computers open this console: addresses, the certificate's fingerprint, a QR code. */
export function SharedAddress() {
  const { source } = useConsole();
  const shared = () => {
    const person = source.person();
    return person !== null && person.fingerprint !== null ? person : null;
  };
  return (
    <Show when={shared()}>
      {(access) => (
        <section class="section" aria-label="Console for other computers">
          <h3>Console for other computers</h3>
          <For each={access().urls}>{(url) => <p class="wire-text">{url}</p>}</For>
          <p class="muted">Certificate SHA-256</p>
          <code class="login-digits">{access().fingerprint}</code>
          <QrCode load={() => source.sharedAddressCode()} alt="The first address as a QR code" />
        </section>
      )}
    </Show>
  );
}
