import { For, Show } from "solid-js";
import { useStation } from "../../console";
import { text } from "../../text/catalogue";
import { QrCode } from "../QrCode";

/** How a companion app on a phone finds this station: its addresses, the first as a QR code too. */
export function AppAddress() {
  const { fleet, source } = useStation();
  return (
    <Show when={fleet.station?.app_url ? fleet.station.link_addresses : null}>
      {(addresses) => (
        <section class="section" aria-label={text.links.connect}>
          <h3>{text.links.connect}</h3>
          <For each={addresses()}>{(address) => <p class="wire-text">{address}</p>}</For>
          <p class="muted">{addresses().length > 1 ? text.links.typeOneOf : text.links.typeIt}</p>
          <QrCode
            load={() => source.station.appAddressCode()}
            alt={text.links.qrCode(addresses()[0] ?? "")}
          />
        </section>
      )}
    </Show>
  );
}
