import { Show } from "solid-js";
import { usePage, useStation } from "../../console";
import { text } from "../../text/catalogue";

/** The person that the station takes this page's requests for, and log out. */
export function PersonTag() {
  const { source } = useStation();
  const { login } = usePage();
  return (
    <Show when={source.person()}>
      {(person) => (
        <p class="person">
          <span class="wire-text">
            <strong>{person().name}</strong> {text.roles[person().role]}
          </span>
          <Show when={person().is_logged_in}>
            <button type="button" class="button" onClick={() => login.logOut()}>
              {text.login.logOut}
            </button>
          </Show>
        </p>
      )}
    </Show>
  );
}
