import { For, Show } from "solid-js";
import { useStation } from "../../console";
import { text } from "../../text/catalogue";
import { QrCode } from "../QrCode";
import "./login.css";

/** How other computers open this console: addresses, the certificate's fingerprint, a QR code. */
export function SharedAddress() {
  const { source } = useStation();
  const shared = () => {
    const person = source.person();
    return person !== null && person.fingerprint !== null ? person : null;
  };
  return (
    <Show when={shared()}>
      {(access) => (
        <section class="section" aria-label={text.login.otherComputers}>
          <h3>{text.login.otherComputers}</h3>
          <For each={access().urls}>{(url) => <p class="wire-text">{url}</p>}</For>
          <p class="muted">{text.login.certificate}</p>
          <code class="login-digits">{access().fingerprint}</code>
          <QrCode load={() => source.station.sharedAddressCode()} alt={text.login.addressCode} />
        </section>
      )}
    </Show>
  );
}
