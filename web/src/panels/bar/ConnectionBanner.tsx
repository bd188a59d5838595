import { Show } from "solid-js";
import { useConsole } from "../../console";
import { formatAge } from "../../text/quantities";

/** Stands as long as the stream is lost, and says how old everything on the page is. */
export function LostBanner() {
  const { source, fleet, behindS } = useConsole();
  const lost = () => {
    const connection = source.connection();
    return connection.kind === "lost" ? connection : null;
  };
  return (
    <Show when={lost()}>
      {(connection) => (
        <div class="banner" role="alert">
          <strong>No contact with the station.</strong>{" "}
          <Show when={fleet.hasState} fallback="Nothing was received yet.">
            Everything below is <span aria-hidden="true">{formatAge(behindS())}</span> old.
          </Show>{" "}
          {connection().reason} Trying again (attempt {connection().attempt}). Watch the aircraft
          and use the remote controllers.
        </div>
      )}
    </Show>
  );
}
