import { Show } from "solid-js";
import type { Notice } from "../../site/savedDraft";
import { Problem } from "../Panel";

/** What became of the last request, beside what it was about. */
export function NoticeLine(props: { notice: Omit<Notice, "about"> | null }) {
  return (
    <Show when={props.notice}>
      {(notice) => (
        <Show
          when={notice().isProblem}
          fallback={
            <p role="status" class="wire-text">
              {notice().text}
            </p>
          }
        >
          <Problem text={notice().text} />
        </Show>
      )}
    </Show>
  );
}
