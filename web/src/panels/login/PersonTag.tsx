import { Show } from "solid-js";
import { useConsole } from "../../console";

/** The person that the station takes this page's requests for, and log out. */
export function PersonTag() {
  const { source, login } = useConsole();
  return (
    <Show when={source.person()}>
      {(person) => (
        <p class="person">
          <span class="wire-text">
            <strong>{person().name}</strong> {person().role}
          </span>
          <Show when={person().is_logged_in}>
            <button type="button" class="button" onClick={() => login.logOut()}>
              Log out
            </button>
          </Show>
        </p>
      )}
    </Show>
  );
}
