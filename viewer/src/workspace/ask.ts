// Ask: a question with a few answers, in a dialog of the browser: it holds the keys' focus, and Escape leaves it.

import { action, make } from "./dom";

/** The answer that was chosen; null: none. */
export function choiceOf(question: string, choices: [answer: string, text: string][]): Promise<string | null> {
  return new Promise((resolve) => {
    const dialog = make("dialog", "ask");
    const heading = make("h2", "", question);
    heading.id = "ask-heading";
    dialog.setAttribute("aria-labelledby", heading.id);
    let said: string | null = null;
    const buttons = choices.map(([answer, text]) => action(text, () => {
      said = answer;
      dialog.close();
    }));
    dialog.append(heading, make("div", "answers", ...buttons), action("Leave it as it is", () => dialog.close()));
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(said);
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}
