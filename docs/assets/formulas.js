// Formulas: KaTeX on what the Markdown extension marks as one, `\(...\)` in a line, `\[...\]` on lines of its own.
for (const place of document.querySelectorAll(".arithmatex")) {
  const text = place.textContent.trim();
  katex.render(text.slice(2, -2), place, { displayMode: text.startsWith("\\["), throwOnError: true });
}
