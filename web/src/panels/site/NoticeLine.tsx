import { Show } from "solid-js";
import { useConsole } from "../../console";
import type { Notice } from "../../site/savedDraft";
import { Problem } from "../Panel";

/** What became of the last request, beside what it was about. */
export function NoticeLine(props: { about: Notice["about"] }) {
  const { siteDraft } = useConsole();
  const mine = () => {
    const notice = siteDraft.notice();
    return notice?.about === props.about ? notice : null;
  };
  return (
    <Show when={mine()}>
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
