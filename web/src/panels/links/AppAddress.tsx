import { For, Show } from "solid-js";
import { useConsole } from "../../console";
import { QrCode } from "../QrCode";

/** How a companion app on a phone finds this station: its addresses, the first as a QR code too. */
export function AppAddress() {
  const { fleet, source } = useConsole();
  return (
    <Show when={fleet.station?.app_url ? fleet.station.link_addresses : null}>
      {(addresses) => (
        <section class="section" aria-label="Connect a companion app">
          <h3>Connect a companion app</h3>
          <For each={addresses()}>{(address) => <p class="wire-text">{address}</p>}</For>
          <p class="muted">
            {addresses().length > 1
              ? "Type the address that the phone reaches, or scan the first one."
              : "Type this address in the app, or scan the code with it."}
          </p>
          <QrCode load={() => source.appAddressCode()} alt={`QR code of ${addresses()[0]}`} />
        </section>
      )}
    </Show>
  );
}
