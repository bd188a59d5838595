import { Show } from "solid-js";
import { formatLength, lengthUnit } from "../text/units";
import type { Fields, NewSite } from "./newSite";
import "./newSite.css";

const ACCEPTED = ".kml,.kmz,.zip,.gpkg,.geojson,.json";

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
        <h1 id="new-site-title">Where is your field?</h1>
        <p class="muted wire-text">
          Recon makes a site in <code>{folder()}</code>, with simulated drones to rehearse with.
          Boundary, zones and fields are drawn next, on the map.
        </p>
        <Field newSite={props.newSite} name="name" label="Name" />
        <Field
          newSite={props.newSite}
          name="place"
          label="A place in the field: latitude, longitude"
          placeholder="41.9012, -93.6034"
        />
        <div class="new-site-ways">
          <label class="button new-site-file">
            Read it from a file
            <input
              class="hidden-but-read"
              type="file"
              accept={ACCEPTED}
              disabled={isBusy()}
              onChange={(event) => {
                const file = event.currentTarget.files?.[0];
                if (file !== undefined) void props.newSite.readFile(file);
                // The same file may be chosen again after a change.
                event.currentTarget.value = "";
              }}
            />
          </label>
          <button
            type="button"
            class="button"
            disabled={isBusy()}
            onClick={() => void props.newSite.locate()}
          >
            Where this device is
          </button>
        </div>
        <p class="muted">A file is KML, KMZ, Shapefile (zip), GeoPackage or GeoJSON.</p>
        <Field
          newSite={props.newSite}
          name="groundAltitude"
          label={`Ground altitude there, above the WGS84 ellipsoid, ${lengthUnit()}`}
          inputmode="text"
        />
        <p class="muted">
          A rough value is enough to rehearse. It is the height above sea level plus the height of
          the geoid there, which is between {formatLength(-107)} and {formatLength(86)}.
        </p>
        <Field newSite={props.newSite} name="drones" label="Simulated drones" inputmode="numeric" />
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
          Make the site
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
