import { For } from "solid-js";
import type { FailsafeCellView, FailsafeRowView } from "../../protocol";

/** The site's failsafe matrix: what the station does when something fails, by what a vehicle does. */
export function FailsafeTable(props: { rows: readonly FailsafeRowView[] }) {
  return (
    <details>
      <summary class="check-fine">{summary(props.rows)}</summary>
      <div class="failsafe-scroll">
        <table class="failsafe">
          <thead>
            <tr>
              <th scope="col">When</th>
              <th scope="col">Mission</th>
              <th scope="col">Steered</th>
              <th scope="col">Holding</th>
              <th scope="col">Way home</th>
            </tr>
          </thead>
          <tbody>
            <For each={props.rows}>
              {(row) => (
                <tr>
                  <th scope="row" title={row.begins}>
                    {row.name}
                  </th>
                  <For each={row.cells}>{(cell) => <Cell cell={cell} />}</For>
                </tr>
              )}
            </For>
          </tbody>
        </table>
      </div>
    </details>
  );
}

function Cell(props: { cell: FailsafeCellView }) {
  return (
    <td classList={{ "tone-warning": props.cell.is_weaker }}>
      {props.cell.text}
      {props.cell.default === null ? "" : ` (default: ${props.cell.default})`}
    </td>
  );
}

function summary(rows: readonly FailsafeRowView[]): string {
  const cells = rows.flatMap((row) => row.cells);
  const changed = cells.filter((cell) => cell.default !== null).length;
  const weaker = cells.filter((cell) => cell.is_weaker).length;
  if (changed === 0) return "When something fails: default";
  return `When something fails: ${changed} of ${cells.length} changed, ${weaker} weaker`;
}
