import { useConsole } from "../../console";

/** Makes everything that flies hold its position: one press, no question, in reach at any time. */
export function AllStop() {
  const { desk } = useConsole();
  return (
    <button
      type="button"
      class="all-stop"
      aria-label="All stop: every flying vehicle holds its position"
      aria-keyshortcuts="Shift+S"
      title="Every flying vehicle holds its position. Motors stay on. (Shift+S)"
      onClick={() => void desk.allStop()}
    >
      <strong>ALL STOP</strong>
      <span>hold position</span>
    </button>
  );
}
