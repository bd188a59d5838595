import { Show } from "solid-js";
import { useStation } from "../../console";
import { text } from "../../text/catalogue";
import { formatAge } from "../../text/quantities";

/** Shown while the connection is lost, with the age of the displayed data. */
export function ConnectionBanner() {
  const { source, fleet, behindS, isReplay } = useStation();
  const lost = () => {
    const connection = source.connection();
    return connection.kind === "lost" ? connection : null;
  };
  return (
    <Show when={lost()}>
      {(connection) => (
        <div class="card notice banner" role="alert">
          <strong>{text.connection.lost}</strong>{" "}
          <Show when={fleet.hasState} fallback={text.connection.noData}>
            {text.connection.dataIsOld(<span aria-hidden="true">{formatAge(behindS())}</span>)}
          </Show>{" "}
          {connection().needsLogin === true
            ? text.connection.loginAgain(connection().reason)
            : text.connection.reconnecting(connection().reason, connection().attempt)}{" "}
          {isReplay() ? text.connection.startReplay : text.connection.watchAircraft}
        </div>
      )}
    </Show>
  );
}
