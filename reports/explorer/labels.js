// Labels where there is little room.

/**
 * Return a text of so many letters at most.
 * @param {string} text
 * @param {number} letters
 */
export const short = (text, letters) => (text.length > letters ? `${text.slice(0, Math.max(1, letters - 1))}…` : text);

/**
 * Break a label into two lines of so many letters at most.
 * @param {string} label
 * @param {number} letters
 */
export function wrapped(label, letters) {
  const lines = [""];
  for (const word of label.split(" ")) {
    const line = lines[lines.length - 1];
    if (!line || line.length + 1 + word.length <= letters) lines[lines.length - 1] = line ? `${line} ${word}` : word;
    else lines.push(word);
  }
  const all = lines.length > 2 ? [lines[0], lines.slice(1).join(" ")] : lines;
  return all.map((line) => short(line, letters));
}
