/** What the station reads as shapes; it recognises a file by its content. */
const SHAPES = ".kml,.kmz,.zip,.gpkg,.geojson,.json,.gpx,.xml,.plan";

/** A button that asks for a file with shapes. */
export function FileButton(props: {
  label: string;
  disabled: boolean;
  onFile: (file: File) => void;
}) {
  return (
    <label class="button file-button">
      {props.label}
      <input
        class="hidden-but-read"
        type="file"
        accept={SHAPES}
        disabled={props.disabled}
        onChange={(event) => {
          const file = event.currentTarget.files?.[0];
          if (file !== undefined) props.onFile(file);
          // The same file may be chosen again after a change.
          event.currentTarget.value = "";
        }}
      />
    </label>
  );
}
