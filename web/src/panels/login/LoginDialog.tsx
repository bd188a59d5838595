import { createSignal, Show } from "solid-js";
import { usePage, useStation } from "../../console";
import { inPairs, pastedToken } from "../../source/login";
import { text } from "../../text/catalogue";
import "./login.css";

/** Commands at the station's computer. */
const ADD_USER = "recon user add";
const ADD_A_USER = "recon user add NAME --role ROLE";

/** Asks for a token while the station refuses this page for want of one. */
export function LoginDialog() {
  const { source } = useStation();
  const refused = () => {
    const connection = source.connection();
    return connection.kind === "lost" && connection.needsLogin === true ? connection : null;
  };
  return (
    <Show when={refused()}>
      {(connection) => (
        <div class="login-page">
          <section class="login" role="dialog" aria-modal="true" aria-labelledby="login-title">
            <h2 id="login-title">{text.login.title}</h2>
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
  const { login } = usePage();
  const [typed, setTyped] = createSignal("");
  const [isWrong, setWrong] = createSignal(false);
  const submit = (event: Event) => {
    event.preventDefault();
    const token = pastedToken(typed());
    setWrong(token === null);
    if (token !== null) login.logIn(token);
  };
  return (
    <form class="login-form" onSubmit={submit}>
      <label for="login-token">{text.login.token}</label>
      <input
        id="login-token"
        class="page-field"
        type="password"
        autocomplete="off"
        autocapitalize="off"
        spellcheck={false}
        ref={(input) => queueMicrotask(() => input.focus())}
        onInput={(event) => setTyped(event.currentTarget.value)}
      />
      <Show when={isWrong()}>
        <p class="tone-error" role="alert">
          {text.login.notAToken(<code>{ADD_USER}</code>)}
        </p>
      </Show>
      <button type="submit" class="button login-go">
        {text.login.logIn}
      </button>
      <Show when={login.hasToken}>
        <button type="button" class="button" onClick={() => login.logOut()}>
          {text.login.forget}
        </button>
      </Show>
      <p class="muted">{text.login.howTo(<code>{ADD_A_USER}</code>)}</p>
    </form>
  );
}

/** The certificate's fingerprint that came with the QR code, to compare with the browser's. */
function Fingerprint() {
  const { login } = usePage();
  return (
    <Show when={login.fingerprint}>
      {(digits) => (
        <div class="login-fingerprint">
          <p>{text.login.fingerprint}</p>
          <code>{inPairs(digits())}</code>
        </div>
      )}
    </Show>
  );
}
