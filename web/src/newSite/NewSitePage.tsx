import { Show } from "solid-js";
import { FileButton } from "../panels/FileButton";
import { text } from "../text/catalogue";
import { lengthUnit } from "../text/units";
import type { Fields, NewSite } from "./newSite";
import "./newSite.css";

/** Asks where the field is, and makes the site there. */
export function NewSitePage(props: { newSite: NewSite }) {
  const { folder, notice, isBusy } = props.newSite;
  const submit = (event: Event) => {
    event.preventDefault();
    void props.newSite.make();
  };
  return (
    <main class="new-site">
      <form class="new-site-card" onSubmit={submit} aria-labelledby="new-site-title">
        <h1 id="new-site-title">{text.newSite.title}</h1>
        <p class="muted wire-text">{text.newSite.what(<code>{folder()}</code>)}</p>
        <Field newSite={props.newSite} name="name" label={text.newSite.name} />
        <Field
          newSite={props.newSite}
          name="place"
          label={text.newSite.place}
          placeholder="41.9012, -93.6034"
        />
        <div class="new-site-ways">
          <FileButton
            label={text.newSite.readFile}
            disabled={isBusy()}
            onFile={(file) => void props.newSite.readFile(file)}
          />
          <button
            type="button"
            class="button"
            disabled={isBusy()}
            onClick={() => void props.newSite.locate()}
          >
            {text.newSite.locate}
          </button>
        </div>
        <p class="muted">{text.newSite.formats}</p>
        <Field
          newSite={props.newSite}
          name="groundHeight"
          label={text.newSite.height(lengthUnit())}
          inputmode="text"
        />
        <p class="muted">{text.newSite.heightHow}</p>
        <Field
          newSite={props.newSite}
          name="drones"
          label={text.newSite.drones}
          inputmode="numeric"
        />
        <Show when={notice()}>
          {(shown) => (
            <p
              class="wire-text"
              classList={{ "tone-error": shown().kind === "error" }}
              role={shown().kind === "error" ? "alert" : "status"}
            >
              {shown().text}
            </p>
          )}
        </Show>
        <button type="submit" class="button new-site-make" disabled={isBusy()}>
          {text.newSite.make}
        </button>
      </form>
    </main>
  );
}

function Field(props: {
  newSite: NewSite;
  name: keyof Fields;
  label: string;
  placeholder?: string;
  inputmode?: "text" | "numeric";
}) {
  return (
    <label class="new-site-field">
      {props.label}
      <input
        class="page-field"
        type="text"
        autocomplete="off"
        spellcheck={false}
        required
        placeholder={props.placeholder}
        inputmode={props.inputmode}
        value={props.newSite.fields()[props.name]}
        onInput={(event) => props.newSite.change({ [props.name]: event.currentTarget.value })}
      />
    </label>
  );
}
