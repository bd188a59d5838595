import { createSignal, Show } from "solid-js";
import { useConsole } from "../../console";
import { inPairs, pastedToken } from "../../source/login";
import "./login.css";

/** Asks for a token while the station refuses this page for want of one. */
export function LoginDialog() {
  const { source } = useConsole();
  const refused = () => {
    const connection = source.connection();
    return connection.kind === "lost" && connection.needsLogin === true ? connection : null;
  };
  return (
    <Show when={refused()}>
      {(connection) => (
        <div class="login-page">
          <section class="login" role="dialog" aria-modal="true" aria-labelledby="login-title">
            <h2 id="login-title">Log in to Recon</h2>
            <p class="login-reason">{connection().reason}.</p>
            <LoginForm />
            <Fingerprint />
          </section>
        </div>
      )}
    </Show>
  );
}

function LoginForm() {
  const { login } = useConsole();
  const [text, setText] = createSignal("");
  const [isWrong, setWrong] = createSignal(false);
  const submit = (event: Event) => {
    event.preventDefault();
    const token = pastedToken(text());
    setWrong(token === null);
    if (token !== null) login.logIn(token);
  };
  return (
    <form class="login-form" onSubmit={submit}>
      <label for="login-token">Token, or the whole address with it</label>
      <input
        id="login-token"
        type="password"
        autocomplete="off"
        autocapitalize="off"
        spellcheck={false}
        ref={(input) => queueMicrotask(() => input.focus())}
        onInput={(event) => setText(event.currentTarget.value)}
      />
      <Show when={isWrong()}>
        <p class="tone-error" role="alert">
          This is not a token: paste what <code>recon user add</code> printed.
        </p>
      </Show>
      <button type="submit" class="button login-go">
        Log in
      </button>
      <Show when={login.hasToken}>
        <button type="button" class="button" onClick={() => login.logOut()}>
          Forget the token of this tab
        </button>
      </Show>
      <p class="muted">
        An administrator runs <code>recon user add NAME --role ROLE</code> at the station's
        computer; scan the code it shows, or paste the token. The tab forgets it when it is closed.
      </p>
    </form>
  );
}

/** The certificate's fingerprint that came with the QR code, to compare with the browser's. */
function Fingerprint() {
  const { login } = useConsole();
  return (
    <Show when={login.fingerprint}>
      {(digits) => (
        <div class="login-fingerprint">
          <p>
            The code you scanned names this certificate. Compare it with the one your browser shows;
            if they differ, another computer answers here.
          </p>
          <code>{inPairs(digits())}</code>
        </div>
      )}
    </Show>
  );
}
