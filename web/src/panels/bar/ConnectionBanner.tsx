import { Show } from "solid-js";
import { useConsole } from "../../console";
import { formatAge } from "../../text/quantities";

/** Shown while the connection is lost, with the age of the displayed data. */
export function ConnectionBanner() {
  const { source, fleet, behindS, isReplay } = useConsole();
  const lost = () => {
    const connection = source.connection();
    return connection.kind === "lost" ? connection : null;
  };
  return (
    <Show when={lost()}>
      {(connection) => (
        <div class="card notice banner" role="alert">
          <strong>No connection to the station.</strong>{" "}
          <Show when={fleet.hasState} fallback="No data received yet.">
            All data below is <span aria-hidden="true">{formatAge(behindS())}</span> old.
          </Show>{" "}
          {connection().reason}
          <Show when={connection().needsLogin !== true} fallback=". Log in again.">
            ; reconnecting (attempt {connection().attempt}).
          </Show>{" "}
          {isReplay()
            ? "This is a replay: start recon replay again."
            : "Watch the aircraft and use the remote controllers."}
        </div>
      )}
    </Show>
  );
}
