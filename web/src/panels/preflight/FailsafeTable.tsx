import { For } from "solid-js";
import type { FailsafeCellView, FailsafeRowView } from "../../protocol";
import { text } from "../../text/catalogue";

/** The site's failsafe matrix: what the station does when something fails, by what a vehicle does. */
export function FailsafeTable(props: { rows: readonly FailsafeRowView[] }) {
  return (
    <details>
      <summary class="check-fine">{summary(props.rows)}</summary>
      <div class="failsafe-scroll">
        <table class="failsafe">
          <thead>
            <tr>
              <th scope="col">{text.failsafe.when}</th>
              <th scope="col">{text.failsafe.mission}</th>
              <th scope="col">{text.failsafe.steered}</th>
              <th scope="col">{text.failsafe.holding}</th>
              <th scope="col">{text.failsafe.routeHome}</th>
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
      {props.cell.default === null
        ? props.cell.text
        : text.failsafe.cell(props.cell.text, props.cell.default)}
    </td>
  );
}

function summary(rows: readonly FailsafeRowView[]): string {
  const cells = rows.flatMap((row) => row.cells);
  const changed = cells.filter((cell) => cell.default !== null).length;
  const weaker = cells.filter((cell) => cell.is_weaker).length;
  if (changed === 0) return text.failsafe.byDefault;
  return text.failsafe.changed(changed, cells.length, weaker);
}
