// What scrolls or folds has a name and can be reached by keys.
// A button at each block of code that copies it: of a console the commands without their "$", of an interpreter
// the lines behind ">>>" and "...".
function copied(text) {
  const lines = text.replace(/\n$/, "").split("\n");
  for (const prompts of [["$ "], [">>> ", "... "]]) {
    if (lines.some((line) => line.startsWith(prompts[0]))) {
      return lines
        .filter((line) => prompts.some((prompt) => line.startsWith(prompt)))
        .map((line) => line.slice(prompts[0].length).replace(prompts[0] === "$ " ? /\s{2,}#.*$/ : /$^/, ""))
        .join("\n");
    }
  }
  return lines.join("\n");
}

// A link to a section of a page that was split: on to the page where it is now.
function follow() {
  const moved = document.getElementById(decodeURIComponent(location.hash.slice(1)))?.dataset.moved;
  if (moved) location.replace(moved);
}
addEventListener("hashchange", follow);

document.addEventListener("DOMContentLoaded", () => {
  follow();
  for (const summary of document.querySelectorAll(".toctree-toggle")) {
    const name = summary.closest("li")?.querySelector("a")?.textContent.trim() ?? "";
    summary.closest("summary")?.setAttribute("aria-label", `pages of ${name}`); // which the theme leaves empty
  }
  for (const formula of document.querySelectorAll("span.math")) {
    if (formula.scrollWidth > formula.clientWidth) formula.tabIndex = 0; // it scrolls, by keys too
  }
  for (const block of document.querySelectorAll("div.highlight")) {
    if (block.closest(".highlight-text, .output")) continue;
    const pre = block.querySelector("pre");
    if (!pre || !navigator.clipboard) continue;
    const button = Object.assign(document.createElement("button"), { className: "copy", type: "button", textContent: "copy" });
    button.setAttribute("aria-label", "copy this code");
    button.addEventListener("click", async () => {
      await navigator.clipboard.writeText(copied(pre.textContent));
      button.textContent = "copied";
      setTimeout(() => (button.textContent = "copy"), 1500);
    });
    block.append(button);
  }
});
